"""`odsmith scan`: its options."""

from __future__ import annotations

import pytest
from tests.unit.generator.commands.conftest import Run


@pytest.mark.parametrize("nodes", ["0", "1-128", "5-4", "x", "1-", "-3"])
def test_no_range(run: Run, nodes: str) -> None:
    failed = run("scan", f"--nodes={nodes}")
    assert failed.status == 2
    assert "argument --nodes" in failed.err


@pytest.mark.slow
def test_an_empty_bus(run: Run) -> None:
    empty = run("scan", "--interface", "virtual", "--channel", "odsmith empty", "--nodes", "1-2")
    assert (empty.status, empty.out) == (1, "nobody answers\n")
