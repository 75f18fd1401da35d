"""Holds the text of a manual cell by cell against the model.

Each kind of table is known by its heading. A cell that differs is explained by an erratum whose `paths` name what the
cell says, or something above it, and whose source names the table; any other difference is an error.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from odsmith.canopen_types import Place
from odsmith.coverage import dictionary, drive, layouts, words
from odsmith.coverage.account import Account
from odsmith.coverage.cells import NO_ROW, Cell
from odsmith.coverage.manual_text import ManualText, TextTable
from odsmith.errors import Diagnostic, UsageError, quoted
from odsmith.manual import Manual
from odsmith.model import Device, Erratum
from odsmith.rules import diagnose

Comparer = Callable[[Device, TextTable], Iterator[Cell]]

_BY_HEADING: tuple[tuple[tuple[str, ...], Comparer], ...] = (
    (("Index", "Name", "Object Type"), dictionary.objects),
    (("Sub-index",), dictionary.entries),
    (("Bit 1", "Bit 0"), words.bit_values),
    (("Bit",), words.bits),
    (("Bits",), words.bits),
    (("Value",), words.values),
    (("Motor",), words.areas),
    (("Object", "Name"), words.names),
    (("Command",), drive.commands),
    (("Status word",), drive.states),
    (("Method",), drive.homing_methods),
    (("Parameter Name",), drive.ramp),
    (("Error code",), drive.emergencies),
    (("Abort code",), drive.abort_codes),
)
"""What the first cells of a table's heading are, the more special ones first."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """`skipped` are the numbers of the tables that no comparer knows."""

    path: str
    cells: tuple[Cell, ...]
    tables: tuple[int, ...]
    skipped: tuple[int, ...]
    findings: tuple[Diagnostic, ...]

    @property
    def equal(self) -> int:
        return sum(cell.equal for cell in self.cells)

    @property
    def explained(self) -> tuple[Cell, ...]:
        """Cells that differ for a reason that an erratum gives."""
        return tuple(cell for cell in self.cells if not cell.equal and cell.errata)

    @property
    def unexplained(self) -> tuple[Cell, ...]:
        return tuple(cell for cell in self.cells if not cell.equal and not cell.errata)


def compare(device: Device, accounted: Account, text: ManualText) -> Comparison:
    """Hold a text against the model and its account. Raises UsageError for the manual of another device."""
    if device.identity.name.casefold() not in text.title.casefold():
        raise UsageError(f"{text.path} is not the manual of the {device.identity.name}", f"it is {quoted(text.title)}")
    manual = accounted.manual
    errata = _errata_by_table(device, manual)
    cells: list[Cell] = []
    tables, skipped = [], []
    for number, table in sorted(text.tables.items()):
        comparer = comparer_of(table)
        if comparer is None:
            skipped.append(number)
            continue
        tables.append(number)
        cells += (_explained(cell, errata[number]) for cell in comparer(device, table))
    without_facts = {int(line.number) for line in accounted.tables if line.listed}
    findings = [
        *_contents(manual, text),
        *(_skipped(text.tables[number]) for number in skipped if number not in without_facts),
        *(_differing(cell) for cell in cells if not cell.equal and not cell.errata),
    ]
    return Comparison(text.path, tuple(cells), tuple(tables), tuple(skipped), tuple(findings))


def comparer_of(table: TextTable) -> Comparer | None:
    """Who can compare a table; None where it has no heading that anybody knows."""
    if table.caption.endswith(" Signature"):
        return words.signatures
    if table.caption.startswith("Structure of the "):
        return layouts.layout
    if table.heads("Version", "Date") and table.caption.startswith("Firmware"):
        return drive.revisions
    return next((comparer for heading, comparer in _BY_HEADING if table.heads(*heading)), None)


def _errata_by_table(device: Device, manual: Manual) -> defaultdict[int, list[Erratum]]:
    """The errata that speak of each table. Only a manual without a family is cited by table."""
    found: defaultdict[int, list[Erratum]] = defaultdict(list)
    for erratum in device.errata if not manual.family else ():
        for source in erratum.source:
            for table in source.tables if source.kind == "manual" else ():
                found[table].append(erratum)
    return found


def _explained(cell: Cell, errata: Iterable[Erratum]) -> Cell:
    """The cell with the errata that come nearest to it: one about its field says more than one about its object."""
    if cell.equal:
        return cell
    depths = {erratum.id: max((_depth(path, cell.paths) for path in erratum.paths), default=0) for erratum in errata}
    nearest = max(depths.values(), default=0)
    return replace(cell, errata=tuple(name for name, depth in depths.items() if depth == nearest > 0))


def _depth(path: str, said: Iterable[str]) -> int:
    """How many names of a cell's path a path of an erratum has, if the cell is within it; else 0."""
    inside = any(item == path or item.startswith(path + ".") for item in said)
    return path.count(".") + 1 if inside else 0


def _skipped(table: TextTable) -> Diagnostic:
    message = f"table {table.number}, {quoted(table.caption)}, cannot be compared"
    return diagnose("W704", table.place, message, length=1)


def _differing(cell: Cell) -> Diagnostic:
    printed = "has no row" if cell.printed == NO_ROW else f"prints {quoted(cell.printed)}"
    message = f"table {cell.table}, {cell.what}: the manual {printed}, the model says {quoted(cell.modelled)}"
    hint = f"correct the model, or write an erratum with `paths: [{cell.paths[0]}]` and `tables: [{cell.table}]`"
    return diagnose("E703", cell.place, message, hint, length=max(1, len(cell.printed)))


def _contents(manual: Manual, text: ManualText) -> Iterator[Diagnostic]:
    """Differences between the sections and tables that the spec lists and those of the text."""
    place = Place(text.path, 0, 0)
    for number, title in text.contents.items():
        if number not in manual.sections:
            yield diagnose("E704", place, f"section {number}, {title}, is in the manual and not in the spec")
    for number in manual.sections:
        if number not in text.contents:
            yield diagnose("E704", place, f"section {number} is in the spec and not in the manual")
    known = set(range(1, manual.tables + 1))
    for table in sorted(known ^ text.tables.keys()):
        here, there = ("spec", "manual") if table in known else ("manual", "spec")
        yield diagnose("E704", place, f"table {table} is in the {here} and not in the {there}")
