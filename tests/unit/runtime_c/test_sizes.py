"""Flash that the dictionary takes on a Cortex-M4, and that more axes hardly cost any."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from odsmith.backends.c import CBackend
from odsmith.compile import compile_file
from odsmith.render import write

pytestmark = pytest.mark.slow

MOST_FOR_SIX_AXES = 3200
"""Bytes of the rows and what leads to them."""

MOST_GROWTH = 1.10
"""Six axes against one. What grows is the base of each instance, and the entries that store one axis."""

POWER_ON = ("_defaults", "other_cob_ids", "node_ids", "areas")
"""Tables that hold power-on values rather than rows."""


def tables(
    spec: Path, folder: Path, ctree: Any, run: Callable[[Iterable[str]], str], tool: Callable[[str], str]
) -> int:
    """Bytes of the dictionary of a spec beside its power-on values."""
    write(CBackend().render(compile_file(spec)), folder)
    source, out = folder / "tmcm3230" / "c" / "tmcm3230_od.c", folder / "od.o"
    flags = ["-mcpu=cortex-m4", "-mthumb", "-Os", "-std=c99", *ctree.includes(), f"-I{source.parent}"]
    run([tool("arm-none-eabi-gcc"), *flags, "-c", str(source), "-o", str(out)])
    total = int(run([tool("arm-none-eabi-size"), str(out)]).splitlines()[1].split()[0])
    symbols = [line.split() for line in run([tool("arm-none-eabi-nm"), "-S", str(out)]).splitlines()]
    return total - sum(int(line[1], 16) for line in symbols if len(line) == 4 and line[3].endswith(POWER_ON))


def spec_with(axes: int, root: Path, folder: Path) -> Path:
    """The TMCM-3230 with another number of axes; six of them need the room where the device's own block lies."""
    shutil.copytree(root / "spec", folder)
    path = folder / "tmcm3230.yaml"
    text = path.read_text(encoding="utf-8")
    for old, new in (
        ("  count: 3", f"  count: {axes}"),
        ("{first: 0x2700, last: 0x27FF}", "{first: 0x3000, last: 0x30FF}"),
        ("device_block: 0x2700", "device_block: 0x3000"),
    ):
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path


def test_sizes(
    ctree: Any, run: Any, tool: Callable[[str], str], root: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sizes = {
        axes: tables(spec_with(axes, root, tmp_path / f"spec{axes}"), tmp_path / f"c{axes}", ctree, run, tool)
        for axes in (1, 3, 6)
    }
    with capsys.disabled():
        print(f"\ndictionary on a Cortex-M4: {', '.join(f'{axes} axes {size}' for axes, size in sizes.items())} bytes")
    assert sizes[6] <= MOST_FOR_SIX_AXES
    assert sizes[6] <= MOST_GROWTH * sizes[1]
