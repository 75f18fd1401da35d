"""The examples of the README run, and print what their comments say; its commands do what stands beside them."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import pytest

PORT = "29536"  # of the README; the tests take a free one


def blocks(root: Path) -> list[str]:
    text = (root / "README.md").read_text(encoding="utf-8")
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def run(code: str, root: Path) -> subprocess.CompletedProcess[str]:
    packages = [str(root / "generated" / device / "python") for device in ("tmcm3230", "tmcm6212")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(packages)}
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)


def shell_lines(text: str) -> list[str]:
    """What is to be typed, without the comments."""
    typed: list[str] = []
    for kind, block in re.findall(r"```(sh|console)\n(.*?)```", text, re.DOTALL):
        lines = block.splitlines()
        typed += lines if kind == "sh" else [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]
    return [line.partition(" #")[0].strip() for line in typed]


class Terminals:
    """Two terminals in a folder that looks like the checkout after the README's first command.

    That command needs a network, so here its environment has the interpreter of the tests and the package by its path.
    """

    def __init__(self, folder: Path, root: Path) -> None:
        self.folder = folder
        self.device: subprocess.Popen[str] | None = None
        self.port = ""
        self._environment = {
            **os.environ,
            "PYTHONPATH": str(root / "generated" / "tmcm6212" / "python"),
            "PYTHONUNBUFFERED": "1",
        }
        (folder / "spec").symlink_to(root / "spec")
        for name, start in (("odsmith", "-m odsmith.cli"), ("python", "")):
            program = folder / "motors" / "bin" / name
            program.parent.mkdir(parents=True, exist_ok=True)
            program.write_text(f'#!/bin/sh\nexec "{sys.executable}" {start} "$@"\n')
            program.chmod(0o755)

    def first(self, line: str) -> None:
        """Start a device in the first terminal, after Ctrl-C if there is one."""
        self.interrupt()
        self.device = subprocess.Popen(
            ["sh", "-c", f"exec {line} --listen 127.0.0.1:0 --speed 5"],
            cwd=self.folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        found = re.search(r"socketcand 127\.0\.0\.1:(\d+)", self.wait_for("socketcand"))
        assert found is not None
        self.port = found[1]
        self.wait_for("Pre-operational")

    def second(self, line: str) -> str:
        """What a command of the second terminal prints."""
        place = f" --connect 127.0.0.1:{self.port}" if re.search(r"odsmith (scan|inject)", line) else ""
        done = subprocess.run(
            ["sh", "-c", line + place],
            cwd=self.folder,
            env=self._environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, ""), done
        return done.stdout

    def wait_for(self, text: str) -> str:
        """The next line of the device that has a text."""
        assert self.device is not None
        assert self.device.stdout is not None
        return next(line for line in self.device.stdout if text in line)

    def interrupt(self) -> None:
        if self.device:
            self.device.send_signal(signal.SIGINT)
            assert "ended" in self.device.communicate()[0]
            assert self.device.returncode == 0
            self.device = None


@pytest.mark.slow
def test_six_motors_move_in_two_terminals(root: Path, tmp_path: Path) -> None:
    (text,) = re.findall(r"## Move six motors[^\n]*\n(.*?)\n## ", (root / "README.md").read_text("utf-8"), re.DOTALL)
    install, *lines = shell_lines(text)
    (code,) = (block for block in blocks(root) if PORT in block)
    terminals = Terminals(tmp_path, root)
    answers: dict[str, str] = {}
    try:
        for line in lines:
            word = re.sub(r"motors/bin/(odsmith )?", "", line).split()[0 if "odsmith" in line else 1]
            if word == "simulate":
                terminals.first(line)
                (tmp_path / "six.py").write_text(code.replace(PORT, terminals.port))
                continue
            answers[word] = terminals.second(line)
            if word == "inject":
                terminals.wait_for("EMCY 4310h Overtemperature error, axis 0")
        terminals.interrupt()
    finally:
        if terminals.device:
            terminals.device.kill()
            terminals.device.communicate()
    assert install == (
        "python3 -m venv motors && motors/bin/pip install '.[client,generator]' ./generated/tmcm6212/python"
    )  # and not into .venv, where `make test` would find a snapshot instead of the checkout
    assert answers.keys() == {"six.py", "scan", "inject", "decode", "replay"}
    assert answers["six.py"].splitlines() == [f"axis {n} is at {Fraction(n + 1, 2)} revolutions" for n in range(6)]
    assert re.search(r"^1 .* TMCM-6212 .* TMCM-6212$", answers["scan"], re.MULTILINE)
    assert re.fullmatch(r"the device sent the same \d\d+ frames\n", answers["replay"])
    assert answers["inject"] == ""
    assert "read device_type (1000h)" in answers["decode"]
    assert "4310h Overtemperature error of axis 0" in answers["decode"]
    assert "remedy: " in answers["decode"]
    assert (tmp_path / "drive.json").is_file()


@pytest.mark.parametrize("number", range(2))
def test_a_python_example_runs(number: int, root: Path) -> None:
    found = [block for block in blocks(root) if PORT not in block]
    assert len(found) == 2
    code = found[number]
    done = run(code, root)
    assert done.returncode == 0, done.stderr
    printed = [
        comment for comment in re.findall(r"\)  # (.*)", code) if re.fullmatch(r"[0-9a-f]{3}( [0-9a-f]{2})+", comment)
    ]
    assert done.stdout.splitlines() == printed
