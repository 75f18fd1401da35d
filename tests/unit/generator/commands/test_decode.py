"""`odsmith decode` of logs."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest
from tests.unit.generator.commands.conftest import Run

LINES = "(1.000000) can0 701#00\n(1.500000) can0 601#4081600000000000\n\n(2.000000) can0 581#8081600031000906\n"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "run.log"
    path.write_text(LINES)
    return path


def test_a_log_in_words(run: Run, log: Path) -> None:
    status, out, err = run("decode", log, "--device", "tmcm6212")
    assert (status, err) == (0, "")
    assert out.splitlines()[:3] == [
        "1.000000  701#00                node 1   boot-up   it is there, and pre-operational",
        "1.500000  601#4081600000000000  node 1   SDO       read profile_velocity of axis 0 (6081h)",
        "2.000000  581#8081600031000906  node 1   SDO       refused: profile_velocity of axis 0 (6081h): "
        "Value too high (06090031h)",
    ]
    assert "why: " in out


def test_candump_without_l(run: Run, log: Path) -> None:
    """What scrolls by in a terminal, with a line of the other kind among it."""
    plain = [
        "  can0  701   [1]  00",
        " (1.500000)  can0  601   [8]  40 81 60 00 00 00 00 00",
        "(2.000000) can0 581#8081600031000906",
    ]
    log.write_text("\n".join(plain))
    status, out, err = run("decode", log, "--device", "tmcm6212")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0].split()[:4] == ["701#00", "node", "1", "boot-up"]
    assert lines[1] == ("1.500000  601#4081600000000000  node 1   SDO       read profile_velocity of axis 0 (6081h)")
    assert "Value too high" in lines[2]


def test_a_pipe_in_json(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LINES.encode())))
    status, out, _ = run("decode", "-", "--device", "tmcm6212", "--json")
    messages = [json.loads(line) for line in out.splitlines()]
    assert status == 0
    assert [(message["time"], message["service"]) for message in messages] == [
        *((1.0, "boot-up"), (1.5, "SDO"), (2.0, "SDO")),
    ]
    assert messages[1]["facts"] == {
        "kind": "read",
        "index": 0x6081,
        "sub": 0,
        "object": "profile_velocity",
        "axis": 0,
    }


def test_wrong_lines_are_named_and_passed_over(run: Run, log: Path) -> None:
    log.write_bytes(b"\xff\x00\x1b[31m\n" + LINES.encode())
    status, out, err = run("decode", log, "--device", "tmcm6212")
    assert status == 1
    assert err == f"{log}:1: this is no line of candump\n"
    assert out.count("\n") >= 3


def test_all_models_of_the_project(run: Run, log: Path) -> None:
    log.write_text("601#4040880000000000\n601#4040600000000000\n")
    status, out, _ = run("decode", log)
    assert (status, out.count("controlword of axis")) == (0, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no_such.log"], "no_such.log: No such file"),
        (["x.log", "--interface", "virtual"], "a log and a bus at once"),
        (["x.log", "--device", "nonsense"], "there is no device `nonsense`"),
        (["--connect", "127.0.0.1:1", "--interface", "virtual"], "two buses"),
        (["--bitrate", "500000"], "--bitrate without an --interface"),
        (["--connect", "127.0.0.1:1"], "nobody answers at 127.0.0.1:1"),
        (["--connect", "somewhere"], "no HOST:PORT"),
    ],
)
def test_bad_options(run: Run, arguments: list[str], message: str) -> None:
    failed = run("decode", *arguments, *([] if "--device" in arguments else ["--device", "tmcm6212"]))
    assert failed.status == 2
    assert message in failed.err
