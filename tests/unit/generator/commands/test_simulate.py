"""`odsmith simulate` and the commands that talk to it, as a user has them in two terminals."""

from __future__ import annotations

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import can
import pytest
from tests.unit.generator.commands.conftest import Run, Simulation
from tests.unit.runtime_py.io.conftest import generated

from odsmith import engine
from odsmith.commands.common import Loaded
from odsmith.commands.simulate import _prepare_engine
from odsmith.errors import UsageError
from odsmith_runtime.io.library import find, library_path
from odsmith_runtime.io.socketcand import SocketcandServer

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

    decoded = run("decode", log, "--device", "tmcm6212")  # while it goes on
    assert simulation.end() == 0
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
        (["--interface", "virtual", "--bitrate", "500"], "in bit/s one of 10000, 20000, 50000, 100000, 125000, "),
        (["--interface", "virtual", "--bitrate", "fast"], "1000000, not fast"),
        (["--bitrate", "500000"], "--bitrate without an --interface"),
        (["--channel", "can0"], "--channel without an --interface"),
        (["--listen", "nowhere"], "no HOST:PORT"),
        (["--listen", "256.0.0.1:1"], "256.0.0.1"),
        (["--interface", "nonsense"], "no bus at interface nonsense"),
        (["--state", "pyproject.toml", "--listen", "127.0.0.1:0"], "pyproject.toml is damaged or no state"),
        (["--state", ".", "--listen", "127.0.0.1:0"], "cannot be read: Is a directory"),
        (["--state", "no/such/x.json", "--listen", "127.0.0.1:0"], "hint: make this folder"),
        (["--record", "no/such/folder/x.log"], "no/such/folder/x.log: No such file"),
        (["--record", "/dev/full", "--listen", "127.0.0.1:0"], "/dev/full: No space left"),
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


@pytest.fixture
def prepare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, ModuleType], str]:
    """`prepare("auto", package)` gives the engine to ask for, with a compiler that only makes a file."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(engine, "_compile", lambda outputs, path: path.write_bytes(b"library"))
    return lambda choice, package: _prepare_engine(argparse.Namespace(engine=choice), Loaded(package, None))


def test_the_engine_of_an_installed_package_is_c(prepare: Callable[[str, ModuleType], str]) -> None:
    """odsmith brings specification and runtime along, so it needs no checkout."""
    package = generated("tmcm6212")
    assert find(package) is None
    assert prepare("auto", package) == "auto"
    assert find(package) is not None


def test_it_says_why_it_is_python(
    prepare: Callable[[str, ModuleType], str], capsys: pytest.CaptureFixture[str]
) -> None:
    package = ModuleType("my_drive")
    package.__dict__["__spec_digest__"] = "x"
    assert prepare("python", package) == "python"
    assert capsys.readouterr().err == ""
    assert prepare("auto", package) == "python"
    said = capsys.readouterr().err
    assert said.startswith("the engine is Python's: odsmith brings no specification of the installed my_drive along; ")
    assert said.endswith("odsmith engine my_drive.yaml\n")
    assert said.count("\n") == 1
    with pytest.raises(UsageError, match="my_drive"):
        prepare("c", package)
    library = library_path("my_drive", "x")
    library.parent.mkdir(parents=True)
    library.touch()  # somebody has built it elsewhere
    assert prepare("auto", package) == "auto"


def test_without_a_compiler_it_is_python(
    prepare: Callable[[str, ModuleType], str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise UsageError("the C engine needs a C compiler", "install one")

    monkeypatch.setattr(engine, "_compile", refuse)
    assert prepare("auto", generated("tmcm6212")) == "python"
    assert "the engine is Python's: the C engine needs a C compiler; install one\n" in capsys.readouterr().err


def test_who_comes_while_the_engine_is_compiled_waits(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """python-can would be told that nobody is there, and give up after ten seconds."""
    places: list[str] = []
    make = SocketcandServer.__init__

    def listen(self: SocketcandServer, *arguments: Any) -> None:
        make(self, *arguments)
        places.append(self.address)

    def compile_nothing() -> None:
        host, _, port = places[0].rpartition(":")
        socket.create_connection((host, int(port))).close()
        places.append("connected")
        raise KeyboardInterrupt

    monkeypatch.setattr(SocketcandServer, "__init__", listen)
    monkeypatch.setattr(engine, "build", lambda *_, **__: compile_nothing())
    assert run("simulate", "tmcm6212", "--listen", "127.0.0.1:0").status == 130
    assert places[1:] == ["connected"]
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.1", int(places[0].rpartition(":")[2])))


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
