"""The command in this process and in one of its own, in the checkout as its project."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, NamedTuple

import pytest

from odsmith.cli import main


class Result(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Result]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], root: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`run("scan", "--deep")` runs the command in this process, with the checkout as the current folder."""
    monkeypatch.chdir(root)

    def call(*arguments: str | Path) -> Result:
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as left:  # how argparse leaves
            status = int(left.code or 0)
        return Result(status, *capsys.readouterr())

    return call


class Simulation:
    """`odsmith simulate` in a process of its own, in Python and at a free port."""

    def __init__(self, root: Path, *options: str | Path) -> None:
        command = [
            sys.executable,
            "-m",
            "odsmith.cli",
            "simulate",
            "tmcm6212",
            "--engine",
            "python",
            *map(str, options),
        ]
        environment = os.environ | {"PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, text=True, env=environment)
        assert self.process.stdout is not None
        self.lines: IO[str] = self.process.stdout
        found = re.search(r"socketcand (\S+),", self.wait_for("socketcand"))
        assert found is not None
        self.address = found[1]
        self.wait_for("Pre-operational")

    def wait_for(self, wanted: str) -> str:
        """Read on to a line that has something."""
        for line in self.lines:
            if wanted in line:
                return line
        raise AssertionError(f"it ended without {wanted!r}")

    def end(self, number: int = signal.SIGINT) -> int:
        """End it as a user would; gives its exit status."""
        self.process.send_signal(number)
        self.lines.read()
        return self.process.wait()


@pytest.fixture
def simulate(root: Path) -> Iterator[Callable[..., Simulation]]:
    started: list[Simulation] = []

    def start(*options: str | Path) -> Simulation:
        started.append(Simulation(root, "--listen", "127.0.0.1:0", *options))
        return started[-1]

    yield start
    for simulation in started:
        if simulation.process.poll() is None:
            simulation.process.kill()
            simulation.process.wait()
        simulation.lines.close()
