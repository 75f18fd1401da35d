"""A made-up device with a made-up manual: 28 tables, six kinds of misprint, each with an erratum."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from odsmith.compile import compile_file
from odsmith.coverage.account import account
from odsmith.coverage.compare import Comparison, compare
from odsmith.coverage.manual_text import ManualText, read_manual
from odsmith.model import Device

HERE = Path(__file__).parent


@pytest.fixture(scope="session")
def covered() -> Device:
    model = compile_file(HERE / "covered.yaml")
    assert isinstance(model, Device)
    assert model.manual
    return model


@pytest.fixture(scope="session")
def printed() -> str:
    """The text of the manual."""
    return (HERE / "manual.txt").read_text(encoding="utf-8")


@pytest.fixture
def manual_of(tmp_path: Path) -> Callable[[str], ManualText]:
    """`manual_of(text)` reads a text as a manual."""

    def read(text: str) -> ManualText:
        path = tmp_path / "manual.txt"
        path.write_text(text, encoding="utf-8")
        return read_manual(path)

    return read


@pytest.fixture
def compared(covered: Device, manual_of: Callable[[str], ManualText]) -> Callable[[str], Comparison]:
    """`compared(text)` holds a text against the made-up device."""

    def hold(text: str) -> Comparison:
        assert covered.manual
        return compare(covered, account(covered, covered.manual), manual_of(text))

    return hold
