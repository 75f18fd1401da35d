"""The examples of the README run, and print what their comments say."""

from __future__ import annotations

import os
import re
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


@pytest.mark.slow
def test_six_motors_move(root: Path) -> None:
    (code,) = (block for block in blocks(root) if PORT in block)
    command = [sys.executable, "-m", "odsmith.cli", "simulate", "tmcm6212", "--listen", "127.0.0.1:0", "--speed", "5"]
    with subprocess.Popen(
        command, cwd=root, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"}
    ) as device:
        assert device.stdout is not None
        try:
            found = (re.search(r"socketcand 127\.0\.0\.1:(\d+)", line) for line in device.stdout)
            port = next(match[1] for match in found if match)
            done = run(code.replace(PORT, port), root)
        finally:
            device.terminate()
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [f"axis {n} is at {Fraction(n + 1, 2)} revolutions" for n in range(6)]


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
