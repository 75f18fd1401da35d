"""The guide "Put it on your board": its code is that of the port or compiles beside it, and it leaves nothing out."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

PRELUDE = """
#include "board.h"
#include "frame_queue.h"
#include "tmcm6212.h"

extern tmcm6212_t drive;
"""


@pytest.fixture(scope="module")
def guide(root: Path) -> str:
    return (root / "runtime_c" / "README.md").read_text()


@pytest.fixture(scope="module")
def port(root: Path) -> str:
    """All sources of the port that the guide explains."""
    return "".join(path.read_text() for path in sorted((root / "runtime_c" / "port" / "cortex_m").glob("*.c")))


def blocks(guide: str) -> list[str]:
    found = re.findall(r"^```c\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)
    assert len(found) > 5
    assert len(found) == len(re.findall(r"^```.", guide, re.MULTILINE))  # every block is C, none is overlooked
    return found


def test_most_of_the_code_is_that_of_the_port(guide: str, port: str) -> None:
    """Which other tests compile and run. What is not there is marked by its own test below."""
    others = [block.split("(")[0].split()[-1] for block in blocks(guide) if block not in port]
    assert others == ["driver_reported", "obey"]


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang", "arm-none-eabi-gcc"])
def test_the_rest_compiles(
    ctree: Any, run: Any, tool: Callable[[str], str], root: Path, tmp_path: Path, guide: str, port: str, compiler: str
) -> None:
    rest = [block for block in blocks(guide) if block not in port]
    declarations = "void driver_reported(uint8_t axis, int hot);\nextern const ods_port_t port;\n"
    use = "const ods_port_t port = { .os_command = obey };\n"
    source = tmp_path / "guide.c"
    source.write_text("\n".join([PRELUDE, declarations, *rest, use]))
    folders = [*ctree.includes("tmcm6212"), f"-I{root / 'runtime_c/port/cortex_m'}"]
    run([tool(compiler), *WARNINGS, *folders, "-c", str(source), "-o", str(tmp_path / "guide.o")])


def test_nothing_is_left_out(guide: str, root: Path) -> None:
    """Every callback of a port, every function of the board, and every function that takes something from the board."""
    runtime = root / "runtime_c"
    callbacks = re.findall(r"\(\*(\w+)\)\(", (runtime / "include" / "ods" / "port.h").read_text())
    board = re.findall(r"^\w.*?\b((?:board|main)_\w+)\(", (runtime / "port/cortex_m/board.h").read_text(), re.MULTILINE)
    node = re.findall(r"^\w.*?\b(ods_\w+)\(", (runtime / "include" / "ods" / "node.h").read_text(), re.MULTILINE)
    assert len(callbacks) == 8
    assert len(board) > 10
    told = {"ods_node_advance", "ods_node_next", "ods_node_input", "ods_node_fault", "ods_node_motor", "ods_store_size"}
    assert told < set(node)
    for name in (*callbacks, *board, *told):
        assert re.search(rf"\b{name}\b", guide), name
