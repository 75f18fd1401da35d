"""Packs a dictionary into the tables of `ods/od.h`, whose opening comment describes them.

The tables are folded: an object of the axes stands in them once, however many axes there are, and a PDO parameter once
for all PDOs. What depends on the number of axes is the owner of a page of indices, and where each struct of values
begins.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeVar

from odsmith.backends.c.storage import Location, Storage
from odsmith.canopen_types import DataType, Place
from odsmith.errors import SpecError
from odsmith.model import SCOPES, Device, Entry, Object, Scope
from odsmith.rules import diagnose

T = TypeVar("T")

PAGE = 512
"""Indices of a page. An axis' objects may begin at a multiple of it without costing anything."""

PAGES = 0x10000 // PAGE

CHUNK = 16
"""Indices of a chunk."""

MAP_UNIT = 4
"""Maps begin at multiples of this, so that a byte is enough to say where."""

FOLDED = 0x80
"""Owners from here on are numbers of folds: what belongs to whom is found within the page."""

_LIMIT_8 = 0xFF
_LIMIT_16 = 0xFFFF

_LONGEST_NUMBER = 8

REFUSING = frozenset(
    {
        "cob_id_sync",
        "cob_id_emcy",
        "consumer_heartbeat",
        "store",
        "restore",
        "os_command",
        "pdo_cob_id",
        "pdo_mapped_count",
        "pdo_mapping",
    }
)
"""Effects that may refuse a value that is in range, or any value in some state: those of `ods_effect_state()` and
`ods_effect_check()` of the C runtime."""


@dataclass(frozen=True, slots=True)
class Fold:
    """How the indices of a page are shared out among instances: see `ods_od_fold_t`. `each` is 0 for axes that share
    a page; it counts the PDOs of an axis where the page holds one object of PDOs, whose rows begin at `entry`."""

    entry: int
    first: int
    shift: int
    each: int
    groups: int
    subs: int


@dataclass(frozen=True, slots=True)
class PackedEntry:
    """A row of the entry table. `location` is where a variable lives; a constant has its value, or the number of the
    row that holds it, in `at`. A hole has no entry."""

    object: Object
    sub: int
    entry: Entry | None = None
    location: Location | None = None
    at: int = 0
    rule: int = 0


@dataclass(frozen=True, slots=True)
class Chunk:
    """Sixteen consecutive indices: where their entries begin, counted from the first entry of the chunk.

    Chunks of two axes are equal; `index` is that of the first of them.
    """

    index: int = field(compare=False)
    entry: int
    first: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Interval:
    """Limits of a value. `biased` ones are those of signed types, see `ods/od.h`."""

    low: int
    high: int
    biased: bool


@dataclass(frozen=True, slots=True)
class Rule:
    """What a write has to satisfy, and what it does."""

    first: int = 0
    intervals: int = 0
    signature: bool = False
    listed: bool = False
    states: tuple[str, ...] = ()
    group: str = ""
    effect: str = ""

    @property
    def ranged(self) -> bool:
        """Whether the intervals are neither signatures nor a set, but one range."""
        return self.intervals > 0 and not self.signature and not self.listed

    @property
    def guarded(self) -> bool:
        """Whether more than the intervals can speak against a write."""
        return bool(self.states) or self.effect in REFUSING


@dataclass(frozen=True, slots=True)
class Text:
    """A row of the string table: constant text, or the place and length of a variable."""

    location: Location | None
    octets: bytes
    length: int


@dataclass(frozen=True, slots=True)
class NodeId:
    """A value that has the node-ID added at power-on. `instance` is an index into the structs of its scope."""

    scope: Scope
    instance: int
    location: Location
    type: DataType


@dataclass(frozen=True, slots=True)
class Default:
    """A value at power-on that is not 0. `ordinal` counts the PDOs of an axis; it is 0 for other values."""

    scope: Scope
    ordinal: int
    location: Location
    type: DataType
    number: int
    octets: bytes


@dataclass(frozen=True, slots=True)
class Dictionary:
    """All tables; lists of rows in the order in which they are numbered."""

    owners: tuple[int, ...]
    map_of: tuple[int, ...]
    maps: tuple[int, ...]
    chunks: tuple[Chunk, ...]
    entries: tuple[PackedEntry, ...]
    rules: tuple[Rule, ...]
    users: tuple[tuple[PackedEntry, ...], ...]
    """For each rule the entries that it is for."""
    intervals: tuple[Interval, ...]
    words: tuple[int, ...]
    texts: tuple[Text, ...]
    folds: tuple[Fold, ...]
    instances: tuple[int, ...]
    """Number of structs of values of each scope."""
    scope_entries: tuple[int, ...]
    """First entry of each scope, and the end."""
    communication_entries: int
    """Entries of the device that lie in 1000h to 1FFFh; they come first."""
    buffer_size: int
    """Octets of the largest value that has memory, but at least those of the longest number."""
    defaults: tuple[Default, ...]
    node_ids: tuple[NodeId, ...]
    layout: int


def pack(device: Device) -> Dictionary:
    """The tables of a device. Raises SpecError where the dictionary does not fit into their format."""
    storage = Storage(device)
    objects = sorted(device.objects, key=lambda obj: (SCOPES.index(obj.scope), obj.index))
    instances = _instances(device)
    tables = _Tables(storage)
    first_entries = {obj.name: tables.add_object(obj) for obj in objects}
    pages = _Pages(device, instances, first_entries)
    for obj in objects:
        pages.add_object(obj)
    pages.number()
    counts = [sum(len(subs(obj)) for obj in objects if obj.scope == scope) for scope in SCOPES]
    return Dictionary(
        owners=tuple(pages.owners),
        map_of=tuple(pages.map_of),
        maps=tuple(pages.maps),
        chunks=tuple(pages.chunks),
        entries=tuple(tables.entries),
        rules=tuple(tables.rules),
        users=tuple(tuple(row for row in tables.entries if row.rule == number) for number in range(len(tables.rules))),
        intervals=tuple(tables.intervals),
        words=tuple(tables.words),
        texts=tuple(tables.texts),
        folds=tuple(pages.folds),
        instances=instances,
        scope_entries=tuple(sum(counts[:n]) for n in range(len(counts) + 1)),
        communication_entries=sum(len(subs(obj)) for obj in objects if obj.scope == "device" and obj.index < 0x2000),
        buffer_size=max([_LONGEST_NUMBER, *(_octets(row) for row in tables.entries)]),
        defaults=tuple(_defaults(storage)),
        node_ids=tuple(_node_ids(storage)),
        layout=device.layout,
    )


def subs(obj: Object) -> range:
    """Sub-indices that have a row, holes included."""
    return range(obj.highest_sub + 1)


def _octets(row: PackedEntry) -> int:
    """Octets of a value in memory; 0 for a constant."""
    if row.entry is None or row.location is None:
        return 0
    return -(-row.entry.bit_length // 8)


def constant_number(entry: Entry) -> int:
    """The bits of a constant as an unsigned number of its type's length."""
    number = entry.default.number if entry.default else 0
    if entry.type is DataType.REAL32:
        return int(struct.unpack("<I", struct.pack("<f", number))[0])
    if entry.type is DataType.REAL64:
        return int(struct.unpack("<Q", struct.pack("<d", number))[0])
    return number & ((1 << max(entry.type.bits, 8)) - 1)


def constant_octets(entry: Entry) -> bytes:
    text = entry.default.text if entry.default else None
    return (text or "").encode("utf-8")


def _instances(device: Device) -> tuple[int, ...]:
    counts: dict[Scope, int] = dict.fromkeys(SCOPES, 0)
    counts["device"] = 1
    counts["axis"] = device.axes if any(obj.per_axis and not obj.pdo for obj in device.objects) else 0
    for obj in device.objects:
        if obj.pdo:
            scope = obj.scope
            counts[scope] = max(counts[scope], obj.count * (device.axes if obj.per_axis else 1))
    return tuple(counts[scope] for scope in SCOPES)


def _fail(message: str, place: Place, hint: str) -> SpecError:
    return SpecError([diagnose("E471", place, message, hint)])


@dataclass
class _Tables:
    """Entries and what they lead to, in the order in which they are added."""

    storage: Storage
    entries: list[PackedEntry] = field(default_factory=list)
    rules: list[Rule] = field(default_factory=lambda: [Rule()])
    intervals: list[Interval] = field(default_factory=list)
    words: list[int] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)

    def add_object(self, obj: Object) -> int:
        """Add the rows of an object; gives the number of the first one."""
        first = len(self.entries)
        for sub in subs(obj):
            entry = obj.entry(sub)
            self.entries.append(self._row(obj, entry) if entry else PackedEntry(obj, sub))
        if len(self.entries) > _LIMIT_16:
            raise _fail("the dictionary has more entries than a table can number", obj.place, "at most 65535")
        return first

    def _row(self, obj: Object, entry: Entry) -> PackedEntry:
        location = self.storage.location(obj, entry)
        rule = self._rule(entry) if entry.access.writable else 0
        if not entry.type.bits:
            octets = b"" if location else constant_octets(entry)
            text = Text(location, octets, entry.length if location else len(octets))
            return PackedEntry(obj, entry.sub, entry, location, number_of(text, self.texts), rule)
        if location:
            return PackedEntry(obj, entry.sub, entry, location, 0, rule)
        return PackedEntry(obj, entry.sub, entry, None, self._constant(entry), rule)

    def _constant(self, entry: Entry) -> int:
        """Up to 16 bits stand in the entry itself, more in the table of words, the low one first."""
        number = constant_number(entry)
        if entry.type.bits <= 16:
            return number
        return place_of([number >> shift & 0xFFFFFFFF for shift in range(0, entry.type.bits, 32)], self.words)

    def _rule(self, entry: Entry) -> int:
        number = number_of(self._rule_of(entry), self.rules, start=1)  # rule 0 is that of read-only entries
        if number > _LIMIT_8:
            raise _fail("the dictionary needs more than 255 different rules for writing", entry.place, "fewer ranges")
        return number

    def _rule_of(self, entry: Entry) -> Rule:
        signature = bool(entry.signatures)
        if signature:
            intervals = [Interval(item.value, item.value, False) for item in entry.signatures]
        else:
            intervals = list(_limits(entry))
        if intervals and entry.type.bits > 32:
            raise _fail(
                f"the range of a {entry.type} cannot be checked by the C tables", entry.place, "leave the range out"
            )
        first = place_of(intervals, self.intervals) if intervals else 0
        if first + len(intervals) > _LIMIT_8:
            raise _fail("the dictionary has more than 255 different ranges", entry.place, "fewer ranges")
        listed = bool(intervals and entry.allowed and entry.allowed.listed and not signature)
        group = "" if entry.stored == "never" else entry.stored
        return Rule(first, len(intervals), signature, listed, entry.writable_in, group, entry.effect)


def _limits(entry: Entry) -> Iterator[Interval]:
    """The intervals that a value has to lie in; none where every value of the type does.

    A BOOLEAN takes eight bits on the bus, so it always has a range.
    """
    boolean = entry.type is DataType.BOOLEAN
    every = ((entry.type.low, entry.type.high),) if entry.type.integer else ()
    intervals = entry.allowed.intervals if entry.allowed else every
    if boolean or intervals != every:
        for low, high in intervals:
            yield Interval(low, high, entry.type.signed)


def number_of(item: T, table: list[T], start: int = 0) -> int:
    """The number of an item in a table, to which it is added if it is not there."""
    try:
        return table.index(item, start)
    except ValueError:
        table.append(item)
        return len(table) - 1


def place_of(items: list[T], table: list[T]) -> int:
    """Where consecutive items stand in a table, to which they are added if they do not."""
    for start in range(len(table) - len(items) + 1):
        if table[start : start + len(items)] == items:
            return start
    table.extend(items)
    return len(table) - len(items)


class _Pages:
    """The way from an index to the entries of its object: page, map of the page, chunk."""

    def __init__(self, device: Device, instances: tuple[int, ...], first_entries: dict[str, int]) -> None:
        self.device = device
        self.instances = instances
        self.first_entries = first_entries
        self.owners = [0] * PAGES
        self.map_of = [0] * PAGES
        self.folds: list[Fold] = []
        self.maps: list[int] = []
        self.chunks: list[Chunk] = []
        self._objects: dict[int, dict[int, Object]] = {}  # page: offset in the page: object
        self._claimed: dict[int, Object] = {}  # page: the first object in it

    def add_object(self, obj: Object) -> None:
        """Claim the pages in which an object, or one of its copies for an axis or a PDO, lies."""
        if obj.pdo:
            self._add_pdo(obj)
        elif not obj.per_axis:
            self._add(obj, obj.index // PAGE, obj.index % PAGE, 0)
        elif obj.stride % PAGE == 0:
            if self.device.axes >= FOLDED:
                raise _fail(f"{self.device.axes} axes are more than a page can name", obj.place, "at most 127")
            for axis in range(self.device.axes):
                page = (obj.index + axis * obj.stride) // PAGE
                self._add(obj, page, obj.index % PAGE, self._first("axis") + axis)
        else:
            self._add_small_stride(obj)

    def _first(self, scope: Scope) -> int:
        """Number of the first instance of a scope, where the device is 0 and all others follow."""
        return sum(self.instances[: SCOPES.index(scope)])

    def _add_pdo(self, obj: Object) -> None:
        """All PDOs of an axis are one object, and so are those of all axes. Such a page needs no map."""
        stride = obj.stride or PAGE
        if stride > PAGE or stride & (stride - 1) or obj.index % PAGE:
            raise _fail(
                f"the PDO parameters of the axes lie {stride:X}h apart, which the C tables cannot fold",
                obj.place,
                "a power of two up to 200h",
            )
        groups = self.device.axes if obj.per_axis else 1
        first = self._first(obj.scope)
        if obj.count > _LIMIT_8:
            raise _fail(f"{obj.count} PDOs are more than a fold can count", obj.place, "at most 255")
        fold = Fold(self.first_entries[obj.name], first, stride.bit_length() - 1, obj.count, groups, len(subs(obj)))
        self._claim(obj, obj.index // PAGE, FOLDED + number_of(fold, self.folds))

    def _add_small_stride(self, obj: Object) -> None:
        """Several axes share a page; the part of it that an index lies in tells which one is meant."""
        area = next(a for a in self.device.areas if a.stride and a.first <= obj.index <= a.last)
        if obj.stride & (obj.stride - 1) or not CHUNK <= obj.stride <= PAGE or area.first % PAGE:
            raise _fail(
                f"axes {obj.stride:X}h apart cannot be folded into one table",
                obj.place,
                "a multiple of 200h, or a power of two from 10h on for an area that begins at a multiple of 200h",
            )
        each = PAGE // obj.stride
        for axis in range(self.device.axes):
            fold = Fold(0, self._first("axis") + axis // each * each, obj.stride.bit_length() - 1, 0, 0, 0)
            index = obj.index + axis * obj.stride
            self._add(obj, index // PAGE, index % PAGE, FOLDED + number_of(fold, self.folds))

    def _add(self, obj: Object, page: int, offset: int, owner: int) -> None:
        self._claim(obj, page, owner)
        self._objects.setdefault(page, {})[offset] = obj

    def _claim(self, obj: Object, page: int, owner: int) -> None:
        other = self._claimed.setdefault(page, obj)
        if other is obj:
            self.owners[page] = owner
        elif self.owners[page] != owner:
            raise _fail(
                f"'{other.name}' and '{obj.name}' both lie in {page * PAGE:04X}h..{page * PAGE + PAGE - 1:04X}h but "
                "belong to different parts of the device, which the C tables cannot tell apart there",
                obj.place,
                "keep objects of the device and of its axes in blocks of 200h indices of their own",
            )

    def number(self) -> None:
        """Give maps and chunks their numbers; the first ones are those of a page without objects."""
        self.chunks.append(Chunk(0, 0, (0,) * (CHUNK + 1)))
        maps: dict[int, list[int]] = {0: [0] * (PAGE // CHUNK)}  # page 0 stands for all without objects
        for page, objects in sorted(self._objects.items()):
            maps[page] = [0] * (PAGE // CHUNK)
            for position in sorted({offset // CHUNK for offset in objects}):
                maps[page][position] = number_of(self._chunk(page, position, objects), self.chunks, start=1)
        starts, self.maps = overlap(list(maps.values()), MAP_UNIT)
        for page, start in zip(maps, starts, strict=True):
            self.map_of[page] = start // MAP_UNIT
        if len(self.chunks) > _LIMIT_8 or max(self.map_of) > _LIMIT_8:
            raise _fail(
                "the objects are scattered too widely for the C tables", self.device.identity.place, "fewer gaps"
            )

    def _chunk(self, page: int, position: int, objects: dict[int, Object]) -> Chunk:
        first = [0]
        entry = None
        for offset in range(position * CHUNK, (position + 1) * CHUNK):
            obj = objects.get(offset)
            if obj and entry is None:
                entry = self.first_entries[obj.name]
            first.append(first[-1] + (len(subs(obj)) if obj else 0))
            if obj and first[-1] > _LIMIT_8:
                raise _fail("objects close to each other have more than 255 entries", obj.place, "fewer sub-indices")
        return Chunk(page * PAGE + position * CHUNK, entry or 0, tuple(first))


def overlap(windows: list[list[int]], unit: int) -> tuple[list[int], list[int]]:
    """Lay windows into one list so that they share cells where they agree.

    Gives the place of each window, a multiple of `unit`, and the list.

    >>> overlap([[0, 0, 0], [7, 0, 0], [0, 7, 0]], 1)
    ([0, 3, 2], [0, 0, 0, 7, 0, 0])
    """
    cells: list[int] = []
    starts = []
    for window in windows:
        start = 0
        while cells[start : start + len(window)] != window[: max(len(cells) - start, 0)]:
            start += unit
        cells += window[len(cells) - start :] if start + len(window) > len(cells) else []
        starts.append(start)
    return starts, cells


def _defaults(storage: Storage) -> Iterator[Default]:
    """What does not power on as 0, on the first axis."""
    for item in storage.device.expanded:
        if item.axis:
            continue
        for expanded in item.entries:
            entry, default = expanded.entry, expanded.default
            location = storage.location(item.object, entry)
            if location is None or default is None:
                continue
            octets = (default.text or "").encode()
            if default.number or octets.strip(b"\0"):
                ordinal = item.index - item.object.index
                yield Default(item.object.scope, ordinal, location, entry.type, default.number, octets)


def _node_ids(storage: Storage) -> Iterator[NodeId]:
    for item in storage.device.expanded:
        for expanded in item.entries:
            location = storage.location(item.object, expanded.entry)
            if location and expanded.default and expanded.default.node_id:
                scope = item.object.scope
                ordinal = item.index - item.object.index - (item.axis or 0) * item.object.stride
                instance = (item.axis or 0) * (item.object.count if item.object.pdo else 1) + ordinal
                yield NodeId(scope, instance, location, expanded.entry.type)
