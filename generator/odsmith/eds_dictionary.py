"""The object dictionary that an EDS or a DCF file describes: its sections as objects and entries (CiA 306-1).

As tolerant as the reader of the file: what cannot be understood is None, and every element keeps its section, so that
whoever asks further (`lint`, `import`, `diff`) can name the line.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

from odsmith.eds_file import EdsFile, Key, Section
from odsmith.model import Default

VAR, ARRAY, RECORD = 7, 8, 9
"""Object types of CiA 301, table 42."""

_SECTION = re.compile(r"([0-9A-F]{4})(?:sub([0-9A-F]{1,2}))?\Z", re.IGNORECASE)

# Forty digits are enough for 64 bits; int() takes quadratic time for long decimal numbers.
_NUMBER = re.compile(r"(-?)(?:0[xX]([0-9A-Fa-f]{1,40})|([0-9]{1,40}))\Z")
_NODE_ID = re.compile(r"\$NODEID(?:\s*\+\s*([0-9A-Z]+))?\Z|([0-9A-Z]+)\s*\+\s*\$NODEID\Z", re.IGNORECASE)


class BasicType(NamedTuple):
    """A static data type of CiA 301, table 44. `bits` is 0 where the length is not fixed."""

    name: str
    bits: int
    kind: Literal["signed", "unsigned", "real", "other"]

    @property
    def integer(self) -> bool:
        return self.kind in ("signed", "unsigned")

    @property
    def low(self) -> int:
        return -(1 << (self.bits - 1)) if self.kind == "signed" else 0

    @property
    def high(self) -> int:
        return (1 << (self.bits - (self.kind == "signed"))) - 1


def _integers(kind: Literal["signed", "unsigned"], codes: Mapping[int, int]) -> dict[int, BasicType]:
    name = "INTEGER" if kind == "signed" else "UNSIGNED"
    return {code: BasicType(f"{name}{bits}", bits, kind) for code, bits in codes.items()}


TYPES: Mapping[int, BasicType] = {
    0x01: BasicType("BOOLEAN", 1, "unsigned"),
    **_integers("signed", {2: 8, 3: 16, 4: 32, 0x10: 24, 0x12: 40, 0x13: 48, 0x14: 56, 0x15: 64}),
    **_integers("unsigned", {5: 8, 6: 16, 7: 32, 0x16: 24, 0x18: 40, 0x19: 48, 0x1A: 56, 0x1B: 64}),
    0x08: BasicType("REAL32", 32, "real"),
    0x11: BasicType("REAL64", 64, "real"),
    0x09: BasicType("VISIBLE_STRING", 0, "other"),
    0x0A: BasicType("OCTET_STRING", 0, "other"),
    0x0B: BasicType("UNICODE_STRING", 0, "other"),
    0x0C: BasicType("TIME_OF_DAY", 48, "other"),
    0x0D: BasicType("TIME_DIFFERENCE", 48, "other"),
    0x0F: BasicType("DOMAIN", 0, "other"),
}
"""Every data type that a variable may have, by its index in the dictionary."""


@lru_cache(maxsize=4096)
def parse_number(text: str) -> Default | None:
    """A number as EDS files write it: `0x10`, `16`, `-3`, `$NODEID+0x200`, in whatever case and order; else None."""
    found = _NUMBER.match(text)
    if found:
        sign, hexadecimal, decimal = found.groups()
        number = int(hexadecimal, 16) if hexadecimal else int(decimal)
        return Default(-number if sign else number)
    with_node_id = _NODE_ID.match(text) if text[-1:].isalnum() else None
    if not with_node_id:
        return None
    addend = parse_number(with_node_id[1] or with_node_id[2] or "0")
    return Default(addend.number, node_id=True) if addend and not addend.node_id else None


@dataclass(frozen=True)
class EdsEntry:
    """A value of the dictionary: a sub-index, or an object that is one variable.

    `object_type`, `data_type` are codes of CiA 301, None where missing or unreadable; `access` is in lower case.
    Limits and values are None where missing, and where they are no number. `implied` entries have no section of their
    own: they come from CompactSubObj.
    """

    index: int
    sub: int
    section: Section
    name: str
    data_type: int | None
    access: str
    mapped: bool
    default: Default | None
    implied: bool = False

    @cached_property
    def type(self) -> BasicType | None:
        return TYPES.get(self.data_type) if self.data_type is not None else None

    @property
    def writable(self) -> bool:
        return self.access in ("rw", "wo", "rww", "rwr")

    @property
    def bits(self) -> int:
        """Length on the bus in bits, 0 where it is not fixed."""
        return self.type.bits if self.type else 0

    @property
    def low(self) -> Default | None:
        return parse_number(self.section.value("LowLimit"))

    @property
    def high(self) -> Default | None:
        return parse_number(self.section.value("HighLimit"))

    def key(self, name: str) -> Key | None:
        """The key that says something of this entry."""
        return None if self.implied else self.section.get(name)


@dataclass(frozen=True, slots=True)
class EdsObject:
    """An object: its own section, and its entries by sub-index, ascending. A variable has one entry, 0."""

    index: int
    section: Section
    name: str
    object_type: int
    entries: Mapping[int, EdsEntry]

    @property
    def variable(self) -> bool:
        return self.object_type not in (ARRAY, RECORD)

    @property
    def highest_sub(self) -> int:
        """The highest sub-index; FFh, which holds the structure of the object, does not count (CiA 301, 7.4.5)."""
        return max((sub for sub in self.entries if sub != 0xFF), default=0)


@dataclass(frozen=True)
class EdsDictionary:
    """The objects of a file by index, ascending, and the sections of sub-indices whose object has none."""

    file: EdsFile
    objects: Mapping[int, EdsObject]
    orphans: tuple[Section, ...]

    def entry(self, index: int, sub: int) -> EdsEntry | None:
        obj = self.objects.get(index)
        return obj.entries.get(sub) if obj else None

    @cached_property
    def entries(self) -> tuple[EdsEntry, ...]:
        """Every entry, ascending."""
        return tuple(entry for obj in self.objects.values() for entry in obj.entries.values())

    @cached_property
    def device(self) -> str:
        """What the device is called in the paths of objects: its product name, of which a series is left out.

        `TMCM-6212` is 6212, `EW-IO-16` and `TOY-2` stay as they are; empty if the file gives no name.
        """
        info = self.file.section("DeviceInfo")
        name = re.sub(r"[^\w-]+", "_", info.value("ProductName")) if info else ""
        model = re.match(r"[A-Za-z]+[-_]?(\d{3}\w*)\Z", name)
        return model[1] if model else name


@lru_cache(maxsize=8192)
def address(section: str) -> tuple[int, int | None] | None:
    """The index and sub-index in the name of a section, `1018` or `1018sub1`; None for any other name."""
    found = _SECTION.match("".join(section.split()))
    return (int(found[1], 16), int(found[2], 16) if found[2] else None) if found else None


def dictionary(file: EdsFile) -> EdsDictionary:
    """The object dictionary of a file. Of a section that is there twice the first one counts."""
    heads: dict[int, Section] = {}
    subs: dict[int, dict[int, Section]] = {}
    for section in file.sections:
        at = address(section.name)
        if at is None:
            continue
        index, sub = at
        if sub is None:
            heads.setdefault(index, section)
        else:
            subs.setdefault(index, {}).setdefault(sub, section)
    objects = {index: _object(file, index, heads[index], subs.get(index, {})) for index in sorted(heads)}
    orphans = tuple(section for index in subs if index not in heads for section in subs[index].values())
    return EdsDictionary(file, objects, orphans)


def _object(file: EdsFile, index: int, section: Section, subs: Mapping[int, Section]) -> EdsObject:
    given = _integer(section, "ObjectType")
    object_type = VAR if given is None else given
    entries = {sub: _entry(index, sub, subs[sub]) for sub in sorted(subs)}
    if object_type not in (ARRAY, RECORD):
        entries = {0: _entry(index, 0, section), **{sub: entry for sub, entry in entries.items() if sub}}
    elif not entries:
        entries = {entry.sub: entry for entry in _implied(file, index, section)}
    return EdsObject(index, section, section.value("ParameterName"), object_type, entries)


def _entry(index: int, sub: int, section: Section) -> EdsEntry:
    return EdsEntry(
        index=index,
        sub=sub,
        section=section,
        name=section.value("ParameterName"),
        data_type=_integer(section, "DataType"),
        access=section.value("AccessType").lower(),
        mapped=bool(_integer(section, "PDOMapping")),
        default=parse_number(section.value("DefaultValue")),
    )


def _implied(file: EdsFile, index: int, head: Section) -> Iterator[EdsEntry]:
    """The entries that CompactSubObj stands for; their names and values are in sections `1003Name`, `1003Value`."""
    count = min(_integer(head, "CompactSubObj") or 0, 0xFE)
    if count < 1:
        return
    names, values = file.section(f"{index:04X}Name"), file.section(f"{index:04X}Value")
    yield EdsEntry(index, 0, head, "NrOfObjects", 5, "ro", False, Default(count), implied=True)
    for sub in range(1, count + 1):
        yield EdsEntry(
            index=index,
            sub=sub,
            section=head,
            name=(names.value(str(sub)) if names else "") or f"{head.value('ParameterName')}{sub}",
            data_type=_integer(head, "DataType"),
            access=head.value("AccessType").lower(),
            mapped=bool(_integer(head, "PDOMapping")),
            default=parse_number((values.value(str(sub)) if values else "") or head.value("DefaultValue")),
            implied=True,
        )


def _integer(section: Section, name: str) -> int | None:
    number = parse_number(section.value(name))
    return number.number if number and not number.node_id else None
