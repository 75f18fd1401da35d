"""The fuzzer finds faults that were put into a copy of the runtime, and nothing in the runtime itself."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

RUNS = 5_000
"""Inputs within which each seeded fault has to be found, and the runtime itself must pass."""

SEEDED = {
    "segment_bound": (
        "ods_sdo.c",
        "if (length > sdo->length) {",
        "if (length > 0xFFFFu) {",
        "AddressSanitizer: heap-buffer-overflow",
    ),
    "upper_limit": (
        "ods_od.c",
        "return (value > interval->high) ? ODS_ABORT_VALUE_TOO_HIGH : 0u;",
        "return 0;",
        "broken promise: allowed > 0u",
    ),
    "silence": (
        "ods_sdo.c",
        "abort_transfer(node, ODS_ABORT_TOGGLE_BIT);",
        "ods_sdo_abandon(node);",
        "broken promise: rig->answers == expected",
    ),
}
"""A file, what stands in it exactly once, what shall stand there, and how the find is reported."""


def fuzz(root: Path, work: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(root / "tests" / "fuzz" / "fuzz.py"), "--work", str(work), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def patched(root: Path, folder: Path, file: str, old: str, new: str) -> Path:
    """A copy of the runtime with a fault in it."""
    runtime = folder / "runtime_c"
    shutil.copytree(root / "runtime_c", runtime)
    path = runtime / "src" / file
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1, f"{file} has changed: seed the fault anew"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return runtime


def test_the_runtime_keeps_its_promises(root: Path, tool: Callable[[str], str], tmp_path: Path) -> None:
    tool("clang")
    done = fuzz(root, tmp_path, "--runs", str(RUNS), "--seed", "1")
    assert done.returncode == 0, done.stderr[-4000:]
    assert f"stat::number_of_executed_units: {RUNS}" in done.stderr


@pytest.mark.parametrize("name", SEEDED)
def test_a_seeded_fault_is_found(root: Path, tool: Callable[[str], str], tmp_path: Path, name: str) -> None:
    tool("clang")
    file, old, new, report = SEEDED[name]
    runtime = patched(root, tmp_path, file, old, new)
    done = fuzz(root, tmp_path / "work", "--runs", str(RUNS), "--seed", "1", "--runtime", str(runtime))
    assert done.returncode == 1, f"not found within {RUNS} inputs"
    assert report in done.stderr


def test_without_libfuzzer(root: Path, tool: Callable[[str], str], tmp_path: Path) -> None:
    """Any compiler runs the dialogues and some made-up inputs."""
    done = fuzz(root, tmp_path, "--standalone", "--compiler", tool("cc"), "--runs", "200")
    assert done.returncode == 0, done.stderr[-4000:]
