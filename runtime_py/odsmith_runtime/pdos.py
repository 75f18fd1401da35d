"""The process data objects that a device starts with."""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .dictionary import ObjectDictionary
    from .entries import Entry, Object


class Pdo(Row):
    """A PDO of an axis: `kind` is rpdo or tpdo, `number` counts from 1 within the axis.

    `communication` and `mapping` are its parameter records, whose entries hold the defaults; `entries` are what it
    carries by default.
    """

    kind: str
    axis: int | None
    number: int
    communication: Object
    mapping: Object
    entries: tuple[Entry[Any], ...]

    def __repr__(self) -> str:
        names = ", ".join(entry.full_name for entry in self.entries)
        return f"<{self.kind} {self.number} of axis {self.axis}: {names}>"


def default_pdos(dictionary: ObjectDictionary) -> tuple[Pdo, ...]:
    """All PDOs by axis, RPDOs before TPDOs, ascending by number."""
    records = {row[6]: index for index, row in dictionary.object_rows.items() if row[6]}
    return tuple(
        _pdo(dictionary, records, kind, number, axis)
        for axis in (range(dictionary.axis_count) if dictionary.axis_count else (None,))
        for kind, number in dictionary.pdo_rows
    )


def _pdo(dictionary: ObjectDictionary, records: dict[str, int], kind: str, number: int, axis: int | None) -> Pdo:
    def mapped(value: int) -> Entry[Any]:
        base_index, sub = value >> 16, value >> 8 & 0xFF
        per_axis = dictionary.object_rows[base_index][4] > 0
        return dictionary.at(base_index, axis if per_axis else None)[sub]

    return Pdo(
        kind=kind,
        axis=axis,
        number=number,
        communication=dictionary.at(records[f"{kind}_communication"], axis, number),
        mapping=dictionary.at(records[f"{kind}_mapping"], axis, number),
        entries=tuple(mapped(value) for value in dictionary.pdo_rows[kind, number][5]),
    )
