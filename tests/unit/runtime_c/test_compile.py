"""What is generated compiles without a warning: every compiler at hand, each header alone and first."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

DEVICES = ("tmcm3230", "tmcm6212", "io_module", "toy")

CORTEX_M4 = ("-mcpu=cortex-m4", "-mthumb", "-Os", "-ffreestanding")

COMPILERS = [
    pytest.param("gcc", ("-m64",), id="gcc-m64"),
    pytest.param("gcc", ("-m32",), id="gcc-m32"),
    pytest.param("clang", ("-m64",), id="clang-m64"),
    pytest.param("clang", ("-m32",), id="clang-m32"),
    pytest.param("arm-none-eabi-gcc", CORTEX_M4, id="cortex-m4"),
]

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("standard", ["c99", "c11"])
@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize(("compiler", "flags"), COMPILERS)
def test_sources(
    ctree: Any,
    run: Any,
    compiles: Any,
    tmp_path: Path,
    device: str,
    compiler: str,
    flags: tuple[str, ...],
    standard: str,
) -> None:
    command = [*compiles(compiler, *flags), f"-std={standard}", *WARNINGS, *ctree.includes(device)]
    for source in ctree.sources(device):
        run([*command, "-c", str(source), "-o", str(tmp_path / f"{source.stem}.o")])


@pytest.mark.parametrize(("compiler", "flags"), COMPILERS)
def test_each_header_alone(
    ctree: Any, run: Any, compiles: Any, tmp_path: Path, compiler: str, flags: tuple[str, ...]
) -> None:
    """A source file that includes one header and nothing else, then the same header again."""
    command = [*compiles(compiler, *flags), "-std=c99", *WARNINGS, *ctree.includes(*DEVICES)]
    for header in _headers(ctree):
        source = tmp_path / "alone.c"
        source.write_text(
            f'#include "{header}"\n#include "{header}"\nint alone(void);\nint alone(void)\n{{ return 0; }}\n'
        )
        run([*command, "-c", str(source), "-o", str(tmp_path / "alone.o")])


@pytest.mark.parametrize("standard", ["c++11", "c++17"])
def test_each_header_in_cpp(ctree: Any, run: Any, tool: Callable[[str], str], tmp_path: Path, standard: str) -> None:
    for header in _headers(ctree):
        source = tmp_path / "alone.cpp"
        source.write_text(f'#include "{header}"\n')
        flags = [f"-std={standard}", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", *ctree.includes(*DEVICES)]
        run([tool("g++"), *flags, str(source)])


def _headers(ctree: Any) -> list[Path]:
    generated = [header for name in ("cia", *DEVICES) for header in ctree.headers(name)]
    return [*generated, *sorted((ctree.runtime / "include").rglob("*.h"))]
