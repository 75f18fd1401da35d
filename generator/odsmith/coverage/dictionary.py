"""Compares the tables that describe objects and their entries."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from odsmith.canopen_types import ObjectType
from odsmith.coverage.cells import Cell, by_index, cell
from odsmith.coverage.manual_text import TextCell, TextTable
from odsmith.coverage.printed import (
    number,
    same_data_type,
    same_default,
    same_mapping,
    same_object_type,
    same_range,
    same_title,
)
from odsmith.model import Default, Device, Entry, ExpandedEntry, ExpandedObject, Object

_INDICES = re.compile(r"([0-9A-F]{4})h(?: \u2013 ([0-9A-F]{4})h)?")
_OF_INDEX = re.compile(r"Index ([0-9A-F]{4})h : (.*?)(?= Index |$)")

_COLUMNS = ("Sub-index", "Description", "Access", "PDO Mapping", "Value Range", "Default Value")

_PDO_FIELDS = {
    "pdo_cob_id": "cob_id",
    "pdo_transmission_type": "transmission_type",
    "pdo_inhibit_time": "inhibit_time",
    "pdo_event_timer": "event_timer",
    "pdo_mapped_count": "map",
    "pdo_mapping": "map",
}
"""Keys of a PDO in the spec by the role of the entry that powers on with them."""


def objects(device: Device, table: TextTable) -> Iterator[Cell]:
    """Index, name, object type, data type; one row, or one for each PDO below one for all of them."""
    known = by_index(device)
    for row in table.body("Index", "Name", "Object Type", width=4):
        match = _INDICES.fullmatch(row[0].text)
        item = known.get(int(match[1], 16)) if match else None
        if match is None or item is None:
            yield cell(table, row[0], "index", "no such object", False, ["objects"])
            continue
        obj, base = item.object, f"objects.{item.object.name}"
        last = obj.index + obj.count - 1
        if match[2]:
            modelled, equal = f"{obj.index:04X}h to {last:04X}h", int(match[2], 16) == last
        else:
            modelled, equal = f"{item.index:04X}h", True
        title = obj.title.replace(" {number}", "") if match[2] else item.title
        types = list(dict.fromkeys(entry.type for entry in _described(obj)))
        subs = (f"{base}.subs.{entry.sub}.type" for entry in _described(obj))
        yield cell(table, row[0], "index", modelled, equal, [base])
        yield cell(table, row[1], "name", title, same_title(row[1].text, title), [f"{base}.title"])
        yield cell(
            table,
            row[2],
            "object type",
            obj.object_type,
            same_object_type(row[2].text, obj.object_type),
            [f"{base}.object_type"],
        )
        yield cell(
            table,
            row[3],
            "data type",
            ", ".join(types),
            same_data_type(row[3].text, types),
            [f"{base}.type", *subs],
        )


def _described(obj: Object) -> Sequence[Entry]:
    """The entries whose type is that of the object: of an array or record not the count of them."""
    return obj.entries if obj.object_type is ObjectType.VAR else obj.entries[1:]


def entries(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each sub-index, with a description where there are several, and PDO mapping in most tables."""
    item = by_index(device).get(table.index or 0)
    if item is None:
        yield cell(table, None, "index", "no such object", False, ["objects"])
        return
    reader = _Entries(device, table, item)
    yield from reader.heading()
    rows = table.body("Sub-index")
    printed = [number(row[0].text) for row in rows]
    for row, sub in zip(rows, printed, strict=True):
        yield from reader.row(row, sub, alone=printed == [0])
    for expanded in item.entries:
        if expanded.entry.sub not in printed:
            # That there is a sub-index 0 follows from the object type.
            paths = [*reader.paths(expanded.entry), *([] if expanded.entry.sub else [f"{reader.base}.object_type"])]
            yield cell(table, None, "sub-index", f"{expanded.entry.sub:02X}h", False, paths)


class _Entries:
    """Reads the rows of one entry table."""

    def __init__(self, device: Device, table: TextTable, item: ExpandedObject) -> None:
        self.table = table
        self.item = item
        self.base = f"objects.{item.object.name}"
        self.columns = table.heads("Sub-index")
        self.others = {other.index: other for other in device.expanded if other.object is item.object}

    def heading(self) -> Iterator[Cell]:
        """Columns that nobody would compare, because they are called otherwise than usual."""
        for row in self.table.rows:
            for printed in row if row[0].text == "Sub-index" else ():
                if printed.text not in _COLUMNS:
                    yield cell(self.table, printed, "heading", " or ".join(_COLUMNS), False, [self.base])

    def paths(self, entry: Entry, *keys: str) -> list[str]:
        """Where the spec says keys of an entry; a repeated entry is written once, at its first sub-index."""
        if self.item.object.object_type is ObjectType.VAR:
            owners = [self.base]
        else:
            owners = [f"{self.base}.subs.{sub}" for sub in dict.fromkeys((entry.sub, entry.sub - entry.repeat))]
        return [f"{owner}.{key}" for owner in owners for key in keys] if keys else owners

    def row(self, row: Sequence[TextCell], sub: int | None, alone: bool) -> Iterator[Cell]:
        cells = dict(zip(self.columns, row, strict=False))
        expanded = next((entry for entry in self.item.entries if entry.entry.sub == sub), None)
        if expanded is None:
            yield cell(self.table, row[0], "sub-index", "no such sub-index", False, [f"{self.base}.subs.{sub}"])
            return
        entry = expanded.entry
        # A row 0 alone describes a variable. If the model made something else of it, that decides the row.
        var = alone and self.item.object.object_type is not ObjectType.VAR
        decides = [f"{self.base}.object_type"] if var else []
        yield cell(self.table, row[0], "sub-index", f"{entry.sub:02X}h", True, self.paths(entry))
        if title := cells.get("Description"):
            same = same_title(title.text, entry.title)
            yield cell(self.table, title, "name", entry.title, same, self.paths(entry, "title"))
        if access := cells.get("Access"):
            same = access.text == entry.access
            yield cell(self.table, access, "access", entry.access, same, [*self.paths(entry, "access"), *decides])
        if mapping := cells.get("PDO Mapping"):
            same = same_mapping(mapping.text, entry.mapping)
            yield cell(self.table, mapping, "mapping", entry.mapping, same, self.paths(entry, "mapping"))
        if allowed := cells.get("Value Range"):
            paths = [*self.paths(entry, "range", "values", "signatures"), *decides]
            shown = str(entry.allowed) if entry.allowed else f"any {entry.type}"
            yield cell(self.table, allowed, "range", shown, same_range(allowed.text, entry), paths)
        if default := cells.get("Default Value"):
            yield from self.defaults(default, expanded)

    def defaults(self, printed: TextCell, expanded: ExpandedEntry) -> Iterator[Cell]:
        """One default, or one for each PDO: `Index 1400h : 200h + Node-ID Index 1401h : ...`."""
        several = _OF_INDEX.findall(printed.text)
        for index, text in several or [("", printed.text)]:
            item = self.others.get(int(index, 16)) if index else self.item
            entry = expanded.entry
            value = next((e.default for e in item.entries if e.entry.sub == entry.sub), None) if item else None
            paths = [*self.paths(entry, "default"), *self.pdo_paths(entry, item)]
            yield cell(
                self.table, TextCell(text, printed.place), "default", shown(value), same_default(text, value), paths
            )

    def pdo_paths(self, entry: Entry, item: ExpandedObject | None) -> list[str]:
        if item is None or entry.role not in _PDO_FIELDS or not item.object.pdo:
            return []
        pdo = f"pdos.{item.object.pdo[:4]}.{item.index - item.object.index + 1}.{_PDO_FIELDS[entry.role]}"
        return [pdo]


def shown(default: Default | None) -> str:
    """A default as a difference shows it."""
    if default is None:
        return "none"
    if default.text is not None:
        return default.text
    return f"{default.number:X}h + node-ID" if default.node_id else f"{default.number} ({default.number:X}h)"
