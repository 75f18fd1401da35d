"""Mutants of the tables in C: one value at a time is another one, in memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from tests.mutants.mutant import Catalogue

TYPE, READ, RX, TX, CONST = 0x0F, 0x10, 0x20, 0x40, 0x80
U8 = 4
TEXTS = (1, 2, 3)
FOLDED = 0x80

BITS = {
    "rules.flags": (0, 1, 2),
    "rules.states": range(8),
    "nmt_states.services": range(6),
    "stores.groups": range(5),
    "emergencies.error_register": range(8),
    "emergencies.driver_flag": range(8),
    "homing_methods.flags": (0, 1),
    "modes.control": range(16),
    "modes.status": range(16),
    "pds_states.mask": range(16),
    "pds_states.value": range(16),
    "pds_commands.mask": range(16),
    "pds_commands.value": range(16),
    "pds_commands.edge": range(16),
}
"""Columns that are made of bits: each one is turned."""

LISTS = {
    "rules.first": ("rules.intervals", ("intervals.low", "intervals.high")),
    "leds.first": ("leds.phases", ("led_phases",)),
}
"""Columns that say where a list begins: with its length, and the columns that it is in."""

SWITCHES = {"emergencies.momentary", "leds.steady", "pds_states.power"}
"""Columns that are 0 or 1."""

IMAGES = ("device_defaults", "axis_defaults", "rpdo_defaults", "tpdo_defaults")
"""The default values, by scope; they are changed entry by entry."""


@dataclass(frozen=True)
class Change:
    """So many octets from `address` on become another number."""

    address: int
    size: int
    value: int


@dataclass(frozen=True)
class Column:
    name: str
    address: int
    rows: int
    stride: int
    each: int
    size: int

    def places(self) -> Iterator[tuple[str, int]]:
        """Name and address of each value."""
        for row in range(self.rows):
            for n in range(self.each):
                table, _, member = self.name.partition(".")
                label = f"{table}[{row}]" if self.rows > 1 else table
                label += f".{member}" if member else ""
                yield f"{label}[{n}]" if self.each > 1 else label, self.address + row * self.stride + n * self.size


class CTables:
    """The writable tables of a device, in a library that is loaded."""

    def __init__(self, ffi: Any, library: Any, device: str, catalogue: Catalogue) -> None:
        """`ffi` knows `mutant_columns`. The mutants' keys begin with the device's name."""
        self._ffi = ffi
        self._device = device
        self._catalogue = catalogue
        self._changes: dict[int, Change] = {}
        self._columns = {column.name: column for column in _columns(ffi, library)}
        for column in self._columns.values():
            if column.name not in IMAGES:
                self._change_column(column)
        self._change_defaults()

    def apply(self, number: int) -> None:
        """Make a mutant. There is no way back: it is done in a process of its own."""
        change = self._changes[number]
        self._ffi.buffer(self._ffi.cast("char *", change.address), change.size)[:] = change.value.to_bytes(
            change.size, "little"
        )

    def numbers(self) -> list[int]:
        return list(self._changes)

    # ---- columns -----------------------------------------------------------------------------------------------------

    def _change_column(self, column: Column) -> None:
        for number, (label, address) in enumerate(column.places()):
            if not self._is_read(column.name, number):
                continue
            old = self._read(address, column.size)
            for new, how in dict(_others(column, old)).items():
                value = new & ((1 << 8 * column.size) - 1)
                if value != old:
                    self._add(column.name, label, Change(address, column.size, value), f"{old:X}h {how}")

    def _is_read(self, column: str, number: int) -> bool:
        """Whether anybody looks at a value: the owner of a page without objects means nothing, for example."""
        if column == "od.owners":
            return self._cell("od.map_of", 0, number) > 0 or self._cell(column, 0, number) > 0
        if column == "od.map_of":
            return not self._is_page_of_pdos(number)
        if column in ("entries.at", "entries.rule"):
            return self._cell("entries.kind", number) > 0
        if column == "texts.at":
            return number not in self._constant_texts()
        if column == "chunks.entry":
            return number > 0  # the first one has no objects
        if column.startswith("rules.") and column != "rules.group" and not number:
            return False  # that of entries that cannot be written
        return column not in LISTS or self._listed(column, number) != self._listed(column, number, later=1)

    def _is_page_of_pdos(self, page: int) -> bool:
        owner = self._cell("od.owners", 0, page)
        return owner >= FOLDED and self._cell("folds.each", owner - FOLDED) > 0

    def _constant_texts(self) -> set[int]:
        kinds = [self._cell("entries.kind", entry) for entry in range(self._columns["entries.kind"].rows)]
        texts = (entry for entry, kind in enumerate(kinds) if kind & TYPE in TEXTS and kind & CONST)
        return {self._cell("entries.at", entry) for entry in texts}

    def _listed(self, column: str, number: int, later: int = 0) -> list[tuple[int, ...]]:
        """What a row leads to, or would lead to so many rows later: equal lists may stand in two places."""
        count, columns = LISTS[column]
        first = self._cell(column, number) + later
        end = min(first + self._cell(count, number), self._columns[columns[0]].rows)
        return [tuple(self._cell(name, row) for name in columns) for row in range(first, end)]

    def _add(self, column: str, label: str, change: Change, how: str) -> None:
        number = self._catalogue.add(f"C tables: {column}", f"{self._device} {label}", f"{how}: {change.value:X}h")
        self._changes[number] = change

    def _read(self, address: int, size: int) -> int:
        return int.from_bytes(self._ffi.buffer(self._ffi.cast("char *", address), size)[:], "little")

    def _cell(self, column: str, row: int, n: int = 0) -> int:
        found = self._columns[column]
        return self._read(found.address + row * found.stride + n * found.size, found.size)

    # ---- defaults ----------------------------------------------------------------------------------------------------

    def _change_defaults(self) -> None:
        """Each entry that has memory, in the image of its scope: for PDOs in that of each PDO."""
        for scope, name in enumerate(IMAGES):
            image = self._columns[name]
            first, end = (self._cell("od.scope_entries", 0, scope + n) for n in (0, 1))
            for entry in range(first, end):
                place = self._place(entry)
                for row in range(image.rows) if place else ():
                    at, size = place or (0, 0)
                    address = image.address + row * image.stride + at
                    value = (self._read(address, size) + 1) & ((1 << 8 * size) - 1)
                    label = f"{name}[{row}] of entries[{entry}]"
                    self._add(name, label, Change(address, size, value), "default")

    def _place(self, entry: int) -> tuple[int, int] | None:
        """Where in its instance an entry has its memory: offset and octets; None for a constant or a hole."""
        kind, at = self._cell("entries.kind", entry), self._cell("entries.at", entry)
        if not kind or kind & CONST:
            return None
        if kind & TYPE in TEXTS:
            return self._cell("texts.at", at), 1
        return at, 1 << (kind & 3)


def _others(column: Column, old: int) -> Iterator[tuple[int, str]]:
    """Other values than `old`, and what is different."""
    if column.name == "entries.kind":
        yield from _other_kinds(old)
    elif column.name == "entries.rule":
        yield old + 1, "another rule"
        yield 0, "no access"
    elif column.name in BITS:
        for bit in BITS[column.name]:
            yield old ^ (1 << bit), f"bit {bit}"
    elif column.name in SWITCHES:
        yield old ^ 1, "turned"
    else:
        yield old + 1, "more"
        if column.name in ("intervals.low", "intervals.high"):
            yield old - 1, "less"


def _other_kinds(old: int) -> Iterator[tuple[int, str]]:
    if not old:
        yield U8 | READ, "an entry in a hole"
        return
    yield old ^ READ, "access"
    yield old ^ RX, "mapping"
    yield old ^ TX, "mapping"
    yield old ^ CONST, "access"
    yield old ^ 1, "type"
    if old & TYPE not in TEXTS:
        yield old ^ 0x0C, "type"


def _columns(ffi: Any, library: Any) -> Iterator[Column]:
    row = 0
    while library.mutant_columns[row].name != ffi.NULL:
        found = library.mutant_columns[row]
        name = ffi.string(found.name).decode()
        address = int(ffi.cast("uintptr_t", found.at))
        yield Column(name, address, found.rows, found.stride, found.each, found.size)
        row += 1
