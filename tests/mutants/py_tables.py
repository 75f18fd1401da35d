"""Mutants of a device's tables in Python: one value at a time is another one; the twin of c_tables.py."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from tests.mutants.mutant import Catalogue

from odsmith_runtime.emergencies import EmergencyTable
from odsmith_runtime.rows import Row
from odsmith_runtime.state_machine import StateMachine

TEXTS = {
    *(
        "title",
        "text",
        "source",
        "why",
        "cause",
        "remedy",
        "colour",
        "symbol",
        "short",
        "parameter_name",
        "hidden_default",
    ),
    *("values_class", "bits_class", "unit_name", "refuse_write_on_scan", "objects", "controlword", "statusword"),
}
"""Columns that say something to people or to masters: no device acts on them, so no mutant is made of them."""

TABLES = (
    *("IDENTITY", "EMERGENCIES", "NMT_STATES", "NMT_COMMANDS", "ERROR_BEHAVIOUR", "LEDS", "STATE_MACHINE"),
    *("MODES", "HOMING_METHODS", "RAMP", "ABORT_CODES"),
)

HOLDERS = (Row, EmergencyTable, StateMachine)

ENTRY_COLUMNS = ("type", "access", "mapping", "default")

INHIBIT_TIME, EVENT_TIMER = (3,), (4,)
"""Columns of PDOs."""

NODE_ID = "$NODEID"
"""The mark of an offset, which is one whatever the mark says."""

Change = Callable[[], None]


class PyTables:
    """The tables of a generated package that nobody has used yet."""

    def __init__(self, package: Any, catalogue: Catalogue) -> None:
        self._package = package
        self._catalogue = catalogue
        self._changes: dict[int, Change] = {}
        self._words: dict[str, set[str]] = {}
        self._collect(*(row for row in package.DICTIONARY.entry_rows.values()))
        self._collect(*(getattr(package, name) for name in TABLES))
        self._dictionary()
        for name in TABLES:
            self._walk(name.lower(), getattr(package, name))
        self._add("layout", "layout", "more", partial(setattr, package, "LAYOUT", package.LAYOUT + 1))
        groups = package.STORAGE_GROUPS
        for name in list(groups)[1:]:
            self._add("storage_groups", f"storage_groups {name}", "first", partial(_to_front, groups, name))

    def apply(self, number: int) -> None:
        """Make a mutant. There is no way back: it is done in a process of its own."""
        self._changes[number]()

    def numbers(self) -> list[int]:
        return list(self._changes)

    def _add(self, column: str, label: str, how: str, change: Change) -> None:
        where = f"{self._package.__name__}.{label}"
        self._changes[self._catalogue.add(f"Python tables: {column}", where, how)] = change

    def _collect(self, *values: Any) -> None:
        """Which words each column has: a mutant has another one of them."""
        for value in values:
            if isinstance(value, dict):
                self._collect(*value.values())
            elif isinstance(value, tuple) and len(value) == 2 and isinstance(value[0], str):
                self._take_words(value[0], value[1])
            elif isinstance(value, tuple):
                self._collect(*value)
            elif isinstance(value, HOLDERS):
                for name, item in vars(value).items():
                    self._take_words(name, item)
                    self._collect(item)

    def _take_words(self, column: str, value: Any) -> None:
        words = {leaf for _, leaf in _leaves(value) if isinstance(leaf, str)}
        self._words.setdefault(column, set()).update(words)

    def _others(self, column: str, value: Any) -> tuple[Any, ...]:
        """Other values than this one."""
        if isinstance(value, bool):
            return (not value,)
        if isinstance(value, int):
            return value + 1, value - 1
        if isinstance(value, str):
            words = sorted({*self._words.get(column, ()), value})
            following = words[(words.index(value) + 1) % len(words)]
            return (f"{value}_" if following == value else following,)
        return (1,)

    # ---- the dictionary ----------------------------------------------------------------------------------------------

    def _dictionary(self) -> None:
        dictionary = self._package.DICTIONARY
        for name in ("axis_count", "max_pdo_entries"):
            self._attribute(dictionary, name, "dictionary", getattr(dictionary, name))
        for place, value in _leaves(dictionary.areas):
            for other in self._others("areas", value):
                areas = _replaced(dictionary.areas, place, other)
                label = f"areas[{place[0]}]"
                self._add("areas", label, f"{value!r}: {other!r}", partial(setattr, dictionary, "areas", areas))
        for index in dictionary.object_rows:
            for column, at in (("stride", 4), ("count", 5), ("pdo", 6)):
                others = ("",) if column == "pdo" else ()
                self._row(f"objects.{column}", dictionary.object_rows, index, (at,), f"{index:04X}h", others)
        for address, row in dictionary.entry_rows.items():
            self._entry(dictionary.entry_rows, address, row)
        for key, row in dictionary.pdo_rows.items():
            for place, value in _leaves(row):
                if value == NODE_ID or (key[0] == "rpdo" and place in (INHIBIT_TIME, EVENT_TIMER)):
                    continue  # which no RPDO has
                self._row("pdos", dictionary.pdo_rows, key, place, f"{key[0]} {key[1]}")

    def _entry(self, rows: dict[int, Any], address: int, row: tuple[Any, ...]) -> None:
        label = f"{address >> 8:04X}h:{address & 0xFF:02X}"
        is_of_pdo = bool(self._package.DICTIONARY.object_rows[address >> 8][6])
        for at, column in enumerate(ENTRY_COLUMNS):
            for place, value in _leaves(row[at], (at,)):
                if value == NODE_ID or (value is None and is_of_pdo):
                    continue  # the defaults of PDOs stand in rows of their own
                others = _WORDS.get(column, {}).get(value, ())
                self._row(f"entries.{column}", rows, address, place, label, others)
        names = [name for name, _ in row[4:]]
        for at, (name, value) in enumerate(row[4:], start=4):
            if name in TEXTS or name == "name":
                continue
            self._add(f"entries.{name}", label, f"{name} left out", _setter(rows, address, (*row[:at], *row[at + 1 :])))
            for place, _ in _leaves(value, (at, 1)):
                self._row(f"entries.{name}", rows, address, place, label)
        for name, value in (("writable_in", ("operation_enabled",)), ("listed", True), ("allowed", ((1, 1),))):
            if name not in names and row[1] in ("rw", "wo"):
                self._add(f"entries.{name}", label, f"{name} added", _setter(rows, address, (*row, (name, value))))

    def _row(
        self,
        column: str,
        rows: dict[Any, Any],
        key: Any,
        place: tuple[int, ...],
        label: str,
        others: tuple[Any, ...] = (),
    ) -> None:
        """One value of a row that is a tuple."""
        row = rows[key]
        value: Any = row
        for at in place:
            value = value[at]
        for other in others or self._others(column.partition(".")[2], value):
            if other != value:
                change = _setter(rows, key, _replaced(row, place, other))
                self._add(column, label, f"{column.partition('.')[2]} {value!r}: {other!r}", change)

    # ---- rows of other tables ----------------------------------------------------------------------------------------

    def _walk(self, label: str, value: Any) -> None:
        """Everything that a table holds."""
        if isinstance(value, dict):
            for key, item in value.items():
                if isinstance(item, int):
                    for other in self._others(label, item):
                        self._add(
                            label.partition("[")[0], f"{label}[{key!r}]", f"{item}: {other}", _setter(value, key, other)
                        )
                else:
                    self._walk(f"{label}[{key!r}]", item)
                self._add(label.partition("[")[0], f"{label}[{key!r}]", "left out", partial(_leave_out, value, key))
        elif isinstance(value, tuple) and value and isinstance(value[0], Row):
            for number, item in enumerate(value):
                self._walk(f"{label}[{number}]", item)
        elif isinstance(value, HOLDERS):
            for name, item in list(vars(value).items()):
                if name not in TEXTS and not name.startswith("_"):
                    self._member(value, name, label, item)

    def _member(self, owner: Any, name: str, label: str, value: Any) -> None:
        if isinstance(value, dict) or (isinstance(value, tuple) and value and isinstance(value[0], Row)):
            self._walk(f"{label}.{name}", value)
        else:
            self._attribute(owner, name, label, value)

    def _attribute(self, owner: Any, name: str, label: str, value: Any) -> None:
        column = f"{label.partition('[')[0]}.{name}"
        for place, leaf in _leaves(value):
            for other in self._others(name, leaf):
                new = _replaced(value, place, other)
                how = f"{name} {leaf!r}: {other!r}"
                self._add(column, label, how, _setter(owner.__dict__, name, new))
        if isinstance(value, tuple) and value:
            shorter = value[:-1]
            self._add(column, label, f"{name} shorter", _setter(owner.__dict__, name, shorter))


_WORDS: dict[str, dict[Any, tuple[str, ...]]] = {
    "type": {
        "UNSIGNED8": ("INTEGER8", "UNSIGNED16"),
        "UNSIGNED16": ("INTEGER16", "UNSIGNED8"),
        "UNSIGNED32": ("INTEGER32", "UNSIGNED16"),
        "INTEGER8": ("UNSIGNED8", "INTEGER16"),
        "INTEGER16": ("UNSIGNED16", "INTEGER32"),
        "INTEGER32": ("UNSIGNED32", "INTEGER16"),
        "VISIBLE_STRING": ("OCTET_STRING",),
        "OCTET_STRING": ("VISIBLE_STRING",),
    },
    "access": {"rw": ("ro", "wo"), "ro": ("rw", "wo"), "wo": ("rw", "ro"), "const": ("rw", "wo")},
    "mapping": {"no": ("rx", "tx"), "rx": ("no", "tx"), "tx": ("no", "rx"), "both": ("rx", "tx")},
}
"""Which other words are tried."""


def _leaves(value: Any, place: tuple[int, ...] = ()) -> Iterator[tuple[tuple[int, ...], Any]]:
    """What nested tuples hold, and where."""
    if isinstance(value, tuple):
        for at, item in enumerate(value):
            yield from _leaves(item, (*place, at))
    else:
        yield place, value


def _replaced(value: Any, place: tuple[int, ...], other: Any) -> Any:
    if not place:
        return other
    at, *rest = place
    return (*value[:at], _replaced(value[at], tuple(rest), other), *value[at + 1 :])


def _setter(rows: dict[Any, Any], key: Any, value: Any) -> Change:
    return partial(rows.__setitem__, key, value)


def _leave_out(rows: dict[Any, Any], key: Any) -> None:
    del rows[key]


def _to_front(rows: dict[str, Any], name: str) -> None:
    others = {key: row for key, row in rows.items() if key != name}
    moved = rows[name]
    rows.clear()
    rows[name] = moved
    rows.update(others)
