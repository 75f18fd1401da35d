"""A toy device with everything that is generated from it, small enough to read.

After a deliberate change of outputs: `pytest tests/golden --accept`, then read the diff.
"""

from __future__ import annotations

from pathlib import Path

from odsmith.compile import compile_spec
from odsmith.project import compile_all, render_all, roots
from odsmith.render import compare, write

HERE = Path(__file__).parent


def test_toy(accept: bool) -> None:
    outputs = render_all([compile_spec(HERE / "toy.yaml")])
    if accept:
        write(outputs, HERE)
    differences = compare(outputs, HERE)
    assert not differences, f"{differences}: pytest tests/golden --accept writes them anew"


def test_shipped_devices_are_fresh(root: Path) -> None:
    differences = compare(render_all(compile_all(roots(root))), root / "generated")
    assert not differences, f"{differences}: run `odsmith build`"
