"""The runtime does not recurse and keeps to a small stack, as the calls that the compiler states show."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

MOST = 640
"""Bytes of stack that any function of the interface may need on a Cortex-M4, without the callbacks of the port."""

RECURSION = """
int odd(int n);
__attribute__((noinline)) int even(int n) { return (n == 0) ? 1 : odd(n - 1) * 3; }
__attribute__((noinline)) int odd(int n) { return (n == 0) ? 0 : even(n - 1) + 1; }
"""

POINTER = """
extern void take(int (*function)(int));
static int function(int n) { return n + 1; }
void give(void) { take(function); }
"""


@pytest.fixture
def stack(root: Path, tool: Callable[[str], str]) -> Callable[..., subprocess.CompletedProcess[str]]:
    tool("arm-none-eabi-gcc")

    def run(*files: Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, str(root / "bench" / "stack.py"), *map(str, files)]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    return run


def test_the_runtime(stack: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    done = stack()
    assert done.returncode == 0, done.stderr
    depths = {name: int(depth) for name, depth in re.findall(r"^  (ods_\w+) +(\d+)", done.stdout, re.MULTILINE)}
    assert depths.keys() >= {"ods_node_receive", "ods_node_advance", "ods_node_power_on"}
    assert max(depths.values()) <= MOST, done.stdout


@pytest.mark.parametrize(
    ("source", "complaint"), [(RECURSION, "recursion: even > odd > even"), (POINTER, "takes the address of function")]
)
def test_what_is_not_allowed(
    stack: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, source: str, complaint: str
) -> None:
    path = tmp_path / "seeded.c"
    path.write_text(source, encoding="utf-8")
    done = stack(path)
    assert done.returncode == 1
    assert complaint in done.stderr
