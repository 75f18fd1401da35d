"""`odsmith simulate` and the commands that talk to it, as a user has them in two terminals."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import can
import pytest
from tests.unit.generator.commands.conftest import Run, Simulation

Simulate = Callable[..., Simulation]

pytestmark = pytest.mark.slow


def bus(simulation: Simulation) -> can.BusABC:
    host, _, port = simulation.address.rpartition(":")
    return can.Bus(interface="socketcand", host=host, port=int(port), channel="can0")


def ask(simulation: Simulation, *requests: str) -> list[str]:
    """The answers to requests, data only."""
    answers = []
    with bus(simulation) as can_bus:
        for request in requests:
            can_bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex(request), is_extended_id=False))
            answer = can_bus.recv(20)
            assert answer is not None
            answers.append(bytes(answer.data).hex())
    return answers


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_parameters_are_kept(simulate: Simulate, tmp_path: Path, number: int) -> None:
    state = tmp_path / "state.json"
    first = simulate("--state", state)
    ask(first, "2b17100010270000", "2310100173617665")
    assert first.end(number) == 0
    second = simulate("--state", state)
    assert ask(second, "4017100000000000") == ["4b17100010270000"]
    assert second.end(number) == 0


def test_two_terminals(simulate: Simulate, run: Run, tmp_path: Path) -> None:
    log = tmp_path / "run.log"
    simulation = simulate("--node-id", "1", "--node-id", "7", "--record", log)
    place = ("--connect", simulation.address)

    scanned = run("scan", *place, "--nodes", "1-8", "--json")
    assert scanned.status == 0
    assert [(node["node_id"], node["model"]) for node in json.loads(scanned.out)] == [
        (1, "TMCM-6212"),
        (7, "TMCM-6212"),
    ]

    assert run("inject", *place, "--node-id", "7", "axis3", "overtemperature", "on") == (0, "", "")
    assert "EMCY 4310h Overtemperature error, axis 3" in simulation.wait_for("EMCY")
    wrong = run("inject", *place, "axis3", "overtemperature", "on")
    assert (wrong.status, wrong.err) == (2, "odsmith: error: which node? there are 1, 7\n")

    busy = run("simulate", "tmcm6212", "--engine", "python", "--listen", simulation.address)
    assert busy.status == 2
    assert "in use" in busy.err
    assert simulation.end() == 0

    decoded = run("decode", log, "--device", "tmcm6212")
    assert decoded.status == 0
    assert "4310h Overtemperature error of axis 3" in decoded.out
    assert "remedy: " in decoded.out


def test_a_log_is_replayed(simulate: Simulate, run: Run, tmp_path: Path) -> None:
    log = tmp_path / "run.log"
    first = simulate("--record", log)
    ask(first, "2b17100010270000", "2f60600003000000")
    first.end()
    same = run("replay", log, "tmcm6212", "--engine", "python")
    assert (same.status, same.out) == (0, "the device sent the same 3 frames\n")

    second = simulate()
    sent = run("replay", log, "--connect", second.address, "--speed", "1000")
    assert (sent.status, sent.out) == (0, "2 frames sent, 3 of devices left out\n")
    assert ask(second, "4017100000000000") == ["4b17100010270000"]

    lines = log.read_text().splitlines()
    log.write_text("\n".join([*lines[:-1], lines[-1].replace("#60", "#61")]))
    other = run("replay", log, "tmcm6212", "--engine", "python", "--json")
    assert other.status == 1
    assert json.loads(other.out)["difference"]["logged"] == "581#6160600000000000"


def test_a_live_bus_is_decoded(simulate: Simulate, root: Path) -> None:
    simulation = simulate()
    command = [sys.executable, "-m", "odsmith.cli", "decode", "--connect", simulation.address, "--device", "tmcm6212"]
    with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, text=True) as decoder:
        assert decoder.stdout is not None
        try:
            simulation.wait_for("joins")
            ask(simulation, "4000100000000000")
            assert "read device_type (1000h)" in decoder.stdout.readline()
            assert "device_type (1000h) is FFFC0192h" in decoder.stdout.readline()
            decoder.send_signal(signal.SIGINT)
            assert decoder.wait() == 0
        finally:
            decoder.kill()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--node-id", "128"], "a node-ID is 1 to 127, not 128"),
        (["--node-id", "1", "--node-id", "1"], "two devices with one node-ID"),
        (["--speed", "0"], "0.001 to 1000, not 0"),
        (["--speed", "fast"], "0.001 to 1000, not fast"),
        (["--engine", "rust"], "invalid choice: 'rust'"),
        (["--listen", "nowhere"], "no HOST:PORT"),
        (["--listen", "256.0.0.1:1"], "256.0.0.1"),
        (["--interface", "nonsense"], "no bus at interface nonsense"),
        (["--state", "pyproject.toml", "--listen", "127.0.0.1:0"], "pyproject.toml is damaged or no state"),
        (["--state", ".", "--listen", "127.0.0.1:0"], "directory"),
        (["--record", "no/such/folder/x.log"], "no/such/folder/x.log: No such file"),
    ],
)
def test_bad_options(run: Run, options: list[str], message: str) -> None:
    failed = run("simulate", "tmcm6212", "--engine", "python", *options)
    assert failed.status == 2
    assert message in failed.err
    assert "Traceback" not in failed.err


def test_other_machines_are_let_in_only_when_told(root: Path) -> None:
    for address, told in (("127.0.0.1:0", False), ("0.0.0.0:0", True)):
        command = [
            sys.executable,
            "-m",
            "odsmith.cli",
            "simulate",
            "tmcm6212",
            "--engine",
            "python",
            "--listen",
            address,
        ]
        with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            process.stdout.readline()
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate()
        assert ("other machines can reach it" in errors) is told


def test_an_unknown_device(run: Run) -> None:
    failed = run("simulate", "tmcm9999")
    assert failed.status == 2
    assert "there is no device `tmcm9999`" in failed.err


def test_a_live_view(root: Path) -> None:
    """In a terminal: it shows the device, takes keys, and leaves with one."""
    pty = pytest.importorskip("pty")
    process, terminal = pty.fork()
    if not process:  # the child
        os.chdir(root)
        options = ["simulate", "tmcm6212", "--engine", "python", "--listen", "127.0.0.1:0"]
        os.environ |= {"TERM": "xterm", "COLUMNS": "120", "LINES": "30"}
        os.execv(sys.executable, [sys.executable, "-m", "odsmith.cli", *options])
    shown = b""
    pressed = iter([b"3t", b"q"])
    waits_for = iter([b"Switch on disabled", b"Overtemperature", b""])
    wanted = next(waits_for)
    try:
        while octets := os.read(terminal, 1 << 16):
            shown += octets
            if wanted and wanted in shown:
                os.write(terminal, next(pressed))
                wanted = next(waits_for)
    except OSError:
        pass  # it has left
    _, status = os.waitpid(process, 0)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 0
    assert b"axis3 overtemperature on" in shown
