"""Logs: what is written can be read, and what cannot be read says so."""

from __future__ import annotations

import io

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime.device import Frame
from odsmith_runtime.io.log import EXTENDED, Logged, LogLineError, format_frame, format_line, parse_line, read_log

identifiers = st.integers(0, 0x7FF) | st.integers(0, 0x1FFFFFFF).map(lambda number: number | EXTENDED)
frames = st.builds(lambda identifier, data: Frame(identifier, data), identifiers, st.binary(max_size=8)) | st.builds(
    lambda identifier, length: Frame(identifier, remote=True, length=length), identifiers, st.integers(0, 8)
)


@given(st.integers(0, 10**15), frames, st.sampled_from(["", "R", "T"]))
def test_lines_are_read_as_they_were_written(microseconds: int, frame: Frame, way: str) -> None:
    logged = parse_line(format_line(microseconds, frame, "vcan1", way))
    assert logged is not None
    assert logged[1:] == (frame, "vcan1", way)
    assert logged.time == pytest.approx(microseconds / 1e6, abs=1e-6)


@given(st.binary(max_size=8), st.sampled_from("RT"))
def test_python_can_reads_them(data: bytes, way: str) -> None:
    line = format_line(1_500_000, Frame(0x601, data), way=way)
    (message,) = can.CanutilsLogReader(io.StringIO(line + "\n"))
    assert (message.arbitration_id, bytes(message.data), message.is_rx) == (0x601, data, way == "R")
    assert message.timestamp == 1.5


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("601#4000", Frame(0x601, b"\x40\0")),
        ("(1.000000) can0 701#R", Frame(0x701, remote=True)),
        ("  701#R1  ", Frame(0x701, remote=True, length=1)),
        ("080#", Frame(0x080)),
        ("00000601#11.22", Frame(0x601 | EXTENDED, b"\x11\x22")),
    ],
)
def test_short_forms(line: str, expected: Frame) -> None:
    logged = parse_line(line)
    assert logged is not None
    assert logged.frame == expected


@pytest.mark.parametrize(
    ("line", "time", "frame"),
    [
        ("  can0  601   [8]  40 41 60 00 00 00 00 00", None, Frame(0x601, bytes.fromhex("4041600000000000"))),
        (" (1436509052.249713)  can0  080   [0] ", 1436509052.249713, Frame(0x080)),
        (" (000.000123)  vcan1  701   [1]  05", 0.000123, Frame(0x701, b"\5")),
        (" (1436509052.249713000)  can0  701   [1]  05", 1436509052.249713, Frame(0x701, b"\5")),
        ("  can0  701   [1]  remote request", None, Frame(0x701, remote=True, length=1)),
        ("  can0  00000601   [1]  11", None, Frame(0x601 | EXTENDED, b"\x11")),
        ("  can0  TX - -  000   [2]  01 7F", None, Frame(0, b"\x01\x7f")),
        ("  can0  601   [4]  40 41 42 43   '@ABC'", None, Frame(0x601, b"@ABC")),
        ("  can0  123   [2]  12 34   '.''", None, Frame(0x123, b"\x12\x34")),
    ],
)
def test_lines_of_candump_without_l(line: str, time: float | None, frame: Frame) -> None:
    logged = parse_line(line + "\n")
    assert logged is not None
    assert (logged.time, logged.frame, logged.way) == (time, frame, "")
    assert logged.bus in ("can0", "vcan1")


def test_a_line_may_have_date_and_time() -> None:
    times = []
    for second in ("32.249713", "33.250713", "34.251713000"):
        logged = parse_line(f" (2015-07-10 06:57:{second})  can0  080   [0]")
        assert logged is not None
        assert logged.time is not None
        times.append(logged.time)
    assert [times[1] - times[0], times[2] - times[1]] == [pytest.approx(1.001)] * 2


@given(frames)
def test_both_kinds_say_the_same(frame: Frame) -> None:
    number = frame.id & 0x1FFFFFFF
    identifier = f"{number:08X}" if frame.id & EXTENDED else f"{number:03X}"
    content = "remote request" if frame.remote else frame.data.hex(" ").upper()
    logged = parse_line(f"  can0  {identifier}   [{frame.dlc}]  {content}")
    assert logged == Logged(None, frame, "can0")


@pytest.mark.parametrize(
    "line",
    [
        "  can0  601  [08]  40 41 42 43 44 45 46 47",  # CAN FD
        "  can0  601  [12]  40 41 42 43 44 45 46 47 48 49 4A 4B",
        "  can0  20000004   [8]  00 08 00 00 00 00 00 00   ERRORFRAME",
    ],
)
def test_what_no_node_sees_is_passed_over_without_l_too(line: str) -> None:
    assert parse_line(line) is None


@pytest.mark.parametrize("line", ["", "   ", "(1.000000) can0 601##1AABB", "(1.000000) can0 20000004#0000000000000000"])
def test_what_is_no_frame_of_a_node_is_passed_over(line: str) -> None:
    assert parse_line(line) is None


@pytest.mark.parametrize(
    "line",
    [
        "hello",
        "801#00",
        "601#0",
        "601#001122334455667788",
        "(x) can0 601#",
        "601#R9",
        "#",
        "can0 601 [2] 11",
        "can0 601 [1] 11 22",
        "can0 801 [1] 11",
        "(2015-13-10 06:57:32.249713) can0 080 [0]",
    ],
)
def test_other_lines_are_errors(line: str) -> None:
    with pytest.raises(LogLineError):
        parse_line(line)


def test_an_error_names_file_and_line() -> None:
    with pytest.raises(LogLineError, match=r"^run\.log:3: "):
        list(read_log(["601#", "", "?"], "run.log"))


def test_a_remote_frame_has_no_data() -> None:
    assert format_frame(Frame(0x705, remote=True, length=1)) == "705#R1"
