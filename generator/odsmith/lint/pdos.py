"""PDOs: what their default mapping carries, and how they are sent (CiA 301, 7.5.2.35 to 7.5.2.38)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from odsmith.eds_dictionary import TYPES, EdsEntry, EdsObject, parse_number
from odsmith.eds_file import Key
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.sheet import Note, Sheet
from odsmith.model import Default

PDO_BITS = 64
MAX_MAPPED = 64

_INVALID = 1 << 31
_CAN_ID = 0x1FFFFFFF
_DUMMIES = range(0x0001, 0x0020)
_AREAS: tuple[tuple[Literal["RPDO", "TPDO"], int, int], ...] = (("RPDO", 0x1400, 0x1600), ("TPDO", 0x1800, 0x1A00))
_RESERVED_TYPES = {"RPDO": range(241, 254), "TPDO": range(241, 252)}
_NOT_CARRIED_BY = {"RPDO": ("ro", "const", "rwr"), "TPDO": ("wo", "rww")}


@dataclass(frozen=True, slots=True)
class Pdo:
    """A PDO, of which one object may be missing. `number` counts from 1 over the whole device."""

    kind: Literal["RPDO", "TPDO"]
    number: int
    communication: EdsObject | None
    mapping: EdsObject | None

    def __str__(self) -> str:
        return f"{self.kind} {self.number}"


@dataclass(frozen=True, slots=True)
class Mapped:
    """A mapping entry that is in force: which object, which length."""

    entry: EdsEntry
    key: Key
    index: int
    sub: int
    bits: int

    def respelt(self, bits: int) -> str:
        return f"0x{self.index << 16 | self.sub << 8 | bits:08X}"

    def __str__(self) -> str:
        return f"{self.index:04X}h:{self.sub:X}"


def _pdos(sheet: Sheet) -> Iterator[Diagnostic]:
    pdos = tuple(_find(sheet))
    for rule in (_halves, _defaults, _number_mapped, _mappings, _lengths, _can_ids, _transmission_types):
        yield from rule(sheet, pdos)


def _find(sheet: Sheet) -> Iterator[Pdo]:
    objects = sheet.dictionary.objects
    for kind, communication, mapping in _AREAS:
        for offset in range(0x200):
            pair = objects.get(communication + offset), objects.get(mapping + offset)
            if any(pair):
                yield Pdo(kind, offset + 1, *pair)


def _count(pdo: Pdo) -> int | None:
    """How many entries are in force; None if that is not told, or if it is a multiplex PDO."""
    zero = pdo.mapping.entries.get(0) if pdo.mapping else None
    if zero is None or zero.default is None or zero.default.node_id:
        return None
    return zero.default.number if 0 <= zero.default.number <= MAX_MAPPED else None


def _in_force(pdo: Pdo) -> Iterator[Mapped]:
    for sub in range(1, (_count(pdo) or 0) + 1):
        entry = pdo.mapping.entries.get(sub) if pdo.mapping else None
        key = entry.key("DefaultValue") if entry else None
        if entry and key and entry.default and entry.default.number > 0:
            value = entry.default.number
            yield Mapped(entry, key, value >> 16, value >> 8 & 0xFF, value & 0xFF)


def _halves(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        here = pdo.communication or pdo.mapping
        if here and (pdo.communication is None or pdo.mapping is None):
            other = "communication" if pdo.mapping else "mapping"
            yield sheet.at_section("L501", here.section, f"{pdo} has no {other} parameter", here)


def _defaults(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        for sub, entry in pdo.mapping.entries.items() if pdo.mapping else ():
            if sub <= (_count(pdo) or 0) and not entry.implied and entry.section.get("DefaultValue") is None:
                what = "how many objects it carries" if sub == 0 else f"its object number {sub}"
                yield sheet.at_section("L502", entry.section, f"{pdo} has no default that says {what}", entry)


def _number_mapped(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        count = _count(pdo)
        if pdo.mapping is None or not count:
            continue
        zero = pdo.mapping.entries[0]
        key, room = zero.key("DefaultValue"), pdo.mapping.highest_sub
        if key and count > room:
            yield sheet.at_value("L508", key, f"{pdo} carries {count} objects, but has room for {room}", zero)
        for sub in range(1, min(count, room) + 1):
            entry = pdo.mapping.entries.get(sub)
            gap = entry.key("DefaultValue") if entry and entry.default == Default(0) else None
            if gap:
                yield sheet.at_value("L508", gap, f"{pdo} carries {count} objects, number {sub} is none", entry)


def _mappings(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        for mapped in _in_force(pdo):
            if mapped.index in _DUMMIES:
                yield from _dummy(sheet, pdo, mapped)
                continue
            target = sheet.dictionary.entry(mapped.index, mapped.sub)
            if target is None:
                yield sheet.at_value("L503", mapped.key, f"{pdo} carries {mapped}, which does not exist", mapped.entry)
            else:
                yield from _target(sheet, pdo, mapped, target)


def _dummy(sheet: Sheet, pdo: Pdo, mapped: Mapped) -> Iterator[Diagnostic]:
    """A place holder for data of other devices, of a type as long as they are (CiA 301, 7.5.2.36)."""
    usage = sheet.file.section("DummyUsage")
    allowed = parse_number(usage.value(f"Dummy{mapped.index:04X}")) if usage else None
    bits = TYPES[mapped.index].bits if mapped.index in TYPES else 0
    if pdo.kind == "TPDO" or allowed != Default(1):
        message = f"{pdo} carries the dummy {mapped.index:04X}h, which [DummyUsage] does not allow"
        yield sheet.at_value("L504", mapped.key, message, mapped.entry)
    elif mapped.bits != bits:
        message = f"{pdo} carries {mapped.bits} bits of the dummy {mapped.index:04X}h, it has {bits}"
        yield sheet.at_value("L505", mapped.key, message, mapped.entry, value=mapped.respelt(bits))


def _target(sheet: Sheet, pdo: Pdo, mapped: Mapped, target: EdsEntry) -> Iterator[Diagnostic]:
    if not target.mapped:
        notes = _notes(sheet, target, "PDOMapping", "here it is not mappable")
        message = f"{pdo} carries {mapped}, which is not mappable"
        yield sheet.at_value("L504", mapped.key, message, mapped.entry, notes=notes)
    if target.bits and mapped.bits != target.bits:
        message = f"{pdo} carries {mapped.bits} bits of {mapped}, it has {target.bits}"
        notes = _notes(sheet, target, "DataType", "its type")
        yield sheet.at_value("L505", mapped.key, message, mapped.entry, notes=notes, value=mapped.respelt(target.bits))
    if target.access in _NOT_CARRIED_BY[pdo.kind]:
        cannot = "cannot be written" if pdo.kind == "RPDO" else "cannot be read"
        notes = _notes(sheet, target, "AccessType", "its access")
        yield sheet.at_value(
            "L507", mapped.key, f"{pdo} carries {mapped}, which {cannot} by a PDO", mapped.entry, notes=notes
        )


def _notes(sheet: Sheet, entry: EdsEntry, name: str, text: str) -> tuple[Note, ...]:
    return ((sheet.place_of(entry.key(name) or entry.section), text),)


def _lengths(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        mapped = list(_in_force(pdo))
        bits = sum(item.bits for item in mapped)
        if bits > PDO_BITS and pdo.mapping:
            added = " + ".join(str(item.bits) for item in mapped)
            message = f"{pdo} carries {added} = {bits} bits, {PDO_BITS} are the limit"
            yield sheet.at_value("L506", mapped[-1].key, message, pdo.mapping)


def _can_ids(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    seen: dict[tuple[int, bool], tuple[Pdo, Key]] = {}
    for pdo in pdos:
        entry = pdo.communication.entries.get(1) if pdo.communication else None
        key = entry.key("DefaultValue") if entry else None
        if entry is None or key is None or entry.default is None or entry.default.number & _INVALID:
            continue
        first, first_key = seen.setdefault((entry.default.number & _CAN_ID, entry.default.node_id), (pdo, key))
        if first is not pdo:
            note = (sheet.place_of(first_key), f"the CAN-ID of {first}")
            message = f"{pdo} has the CAN-ID of {first}, and both are active"
            yield sheet.at_value("L509", key, message, entry, notes=(note,))


def _directions(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("AccessType")
        if key and entry.access in ("rww", "rwr") and not entry.mapped:
            message = f"{quoted(key.value)} is the access of what a PDO carries, but PDOMapping is not 1"
            yield sheet.at_value("L510", key, message, entry)


def _transmission_types(sheet: Sheet, pdos: Sequence[Pdo]) -> Iterator[Diagnostic]:
    for pdo in pdos:
        entry = pdo.communication.entries.get(2) if pdo.communication else None
        key = entry.key("DefaultValue") if entry else None
        if entry and key and entry.default and entry.default.number in _RESERVED_TYPES[pdo.kind]:
            yield sheet.at_value("L511", key, f"the transmission type {key.value} of {pdo} is reserved", entry)


RULES = (_pdos, _directions)
