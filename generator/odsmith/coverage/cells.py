"""A cell of a manual's table beside what the model says in its place."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from odsmith.canopen_types import Place
from odsmith.coverage.manual_text import TextCell, TextTable
from odsmith.model import Device, ExpandedObject, Object

NO_ROW = "no row"
"""What stands for the print of something that is modelled and has no row in its table."""


@dataclass(frozen=True, slots=True)
class Cell:
    """`what` names the column, `paths` are the model paths that say it, `errata` those that explain a difference."""

    table: int
    place: Place
    what: str
    paths: tuple[str, ...]
    printed: str
    modelled: str
    equal: bool
    errata: tuple[str, ...] = ()


def cell(
    table: TextTable, printed: TextCell | None, what: str, modelled: str, equal: bool, paths: Iterable[str]
) -> Cell:
    """A cell of a table; `printed` is None where the table has no row for something that is modelled."""
    place, text = (printed.place, printed.text) if printed else (table.place, NO_ROW)
    return Cell(table.number, place, what, tuple(paths), text, modelled, equal)


def by_index(device: Device) -> dict[int, ExpandedObject]:
    """The objects as the manual lists them: of axes and PDOs those of axis 0."""
    return {item.index: item for item in device.expanded if not item.axis}


def object_of(device: Device, table: TextTable) -> Object | None:
    """The object that a table is about."""
    found = by_index(device).get(table.index) if table.index is not None else None
    return found.object if found else None
