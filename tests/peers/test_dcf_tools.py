"""dcfchk, the strictest open checker of EDS files, has nothing to say of ours."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def dcfchk(path: Path, node_id: int) -> tuple[int, str]:
    """Its exit status and all that it says."""
    command = [sys.executable, "-m", "dcf.cli", "-n", str(node_id), str(path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    return result.returncode, result.stdout + result.stderr


def test_dcfchk_has_nothing_to_say(eds: Path, node_id: int) -> None:
    assert dcfchk(eds, node_id) == (0, "")


def test_dcfchk_would_say_something(eds_files: dict[str, Path], tmp_path: Path) -> None:
    broken = tmp_path / "broken.eds"
    broken.write_bytes(eds_files["io_module"].read_bytes().replace(b"\nHighLimit=0x04", b"\nHighLimit=-4", 1))
    status, said = dcfchk(broken, 1)
    assert status == 1
    assert "HighLimit underflow" in said
