"""`make sizes`: the flash that the dictionary takes on a Cortex-M4, and that more axes hardly cost any."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def sizes(root: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(root / "bench" / "sizes.py")]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_sizes(root: Path, tool: Callable[[str], str], capsys: pytest.CaptureFixture[str]) -> None:
    tool("arm-none-eabi-gcc")
    done = sizes(root)
    assert done.returncode == 0, done.stdout + done.stderr
    with capsys.disabled():
        print("\n" + "\n".join(done.stdout.splitlines()[-2:]))


def test_without_the_compiler(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It says what is missing, rather than that all is well."""
    monkeypatch.setenv("PATH", str(tmp_path))
    done = sizes(root)
    assert done.returncode == 2
    assert "arm-none-eabi-gcc is not installed" in done.stderr
