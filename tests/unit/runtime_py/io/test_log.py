"""Logs: what is written can be read, and what cannot be read says so."""

from __future__ import annotations

import io

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime.device import Frame
from odsmith_runtime.io.log import EXTENDED, LogLineError, format_frame, format_line, parse_line, read_log

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


@pytest.mark.parametrize("line", ["", "   ", "(1.000000) can0 601##1AABB", "(1.000000) can0 20000004#0000000000000000"])
def test_what_is_no_frame_of_a_node_is_passed_over(line: str) -> None:
    assert parse_line(line) is None


@pytest.mark.parametrize("line", ["hello", "801#00", "601#0", "601#001122334455667788", "(x) can0 601#", "601#R9", "#"])
def test_other_lines_are_errors(line: str) -> None:
    with pytest.raises(LogLineError):
        parse_line(line)


def test_an_error_names_file_and_line() -> None:
    with pytest.raises(LogLineError, match=r"^run\.log:3: "):
        list(read_log(["601#", "", "?"], "run.log"))


def test_a_remote_frame_has_no_data() -> None:
    assert format_frame(Frame(0x705, remote=True, length=1)) == "705#R1"
