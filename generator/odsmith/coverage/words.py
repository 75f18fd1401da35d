"""Compares the tables that describe what is inside an entry or beside it: bits, values, signatures, names, axes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from odsmith.canopen_types import ObjectType
from odsmith.coverage.cells import Cell, by_index, cell, object_of
from odsmith.coverage.manual_text import TextCell, TextTable
from odsmith.coverage.printed import alike, number, same_title
from odsmith.model import Bit, Device, Entry, Mode, NamedValue, Object

_BITS = re.compile(r"(\d+)(?:\.\.\.?(\d+))?")
_HEXADECIMAL = re.compile(r"([0-9A-F]{4})h")
_AREA_OF_CAPTION = re.compile(r"\((\w+)")
_TAG = re.compile(r"</?\w+>")


# ---- bits ------------------------------------------------------------------------------------------------------------


def bits(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each bit or field of an entry, or of the controlword or statusword in one mode of operation."""
    obj = object_of(device, table)
    if obj is None:
        yield cell(table, None, "bits", "no such object", False, ["objects"])
        return
    base, modelled, whole = _bits_of(device, table, obj)
    seen: list[Bit] = []
    for row in table.body("Bit") or table.body("Bits"):
        match = _BITS.fullmatch(row[0].text)
        ends = sorted(int(end) for end in match.groups() if end) if match else []
        bit = next((bit for bit in modelled if ends and (bit.low, bit.high) == (ends[0], ends[-1])), None)
        if bit is None:
            yield cell(table, row[0], "bit", "no such bit", False, [f"{base}.{row[0].text}"])
            continue
        seen.append(bit)
        yield cell(table, row[0], "bit", bit.label, True, [f"{base}.{bit.label}"])
        yield from _bit(table, row, bit, f"{base}.{bit.label}")
    if whole:
        for bit in modelled:
            if bit not in seen:
                yield cell(table, None, "bit", f"{bit.label} {bit.name}", False, [f"{base}.{bit.label}"])


def _bits_of(device: Device, table: TextTable, obj: Object) -> tuple[str, Sequence[Bit], bool]:
    """Where the spec has the bits that a table is about, these bits, and whether the table has to have all of them."""
    mode = mode_of(device, table)
    if mode:
        role = obj.entries[0].role
        return f"modes.{mode.name}.{role}", word_of(mode, role), True
    entry = next((entry for entry in obj.entries if entry.bits), obj.entries[0])
    whole = table.about_one_object or same_title(table.caption.removesuffix(" Bits"), obj.title)
    return f"{_path(obj, entry)}.bits", entry.bits, whole


def mode_of(device: Device, table: TextTable) -> Mode | None:
    """The mode of operation that a table is about, if its caption names one."""
    return next((mode for mode in device.modes if mode.short == table.mode), None)


def word_of(mode: Mode, role: str) -> Sequence[Bit]:
    """The bits of the controlword or statusword that a mode gives a meaning."""
    return {"controlword": mode.control_bits, "statusword": mode.status_bits}.get(role, ())


def _path(obj: Object, entry: Entry) -> str:
    base = f"objects.{obj.name}"
    return base if obj.object_type is ObjectType.VAR else f"{base}.subs.{entry.sub}"


def _bit(table: TextTable, row: Sequence[TextCell], bit: Bit, path: str) -> Iterator[Cell]:
    """What a bit is called, and whether it does something. A reserved bit has no function in either sense."""
    same = alike(row[1].text, bit.name, bit.text)
    yield cell(table, row[1], "name", bit.name, same, [f"{path}.name"])
    last = row[-1]
    if row[1].text.casefold().startswith("reserved"):
        return
    works = not last.text.casefold().startswith("not supported")
    shown = "supported" if bit.supported else "not supported"
    yield cell(table, last, "function", shown, works == bit.supported, [f"{path}.supported"])


# ---- values ----------------------------------------------------------------------------------------------------------


def values(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each named value."""
    rows = ((row[0], number(row[0].text), row[1]) for row in table.body("Value"))
    yield from _values(device, table, rows)


def bit_values(device: Device, table: TextTable) -> Iterator[Cell]:
    """A column for each of the bits that make a value, the highest first."""
    columns = len([head for head in table.heads("Bit 1", "Bit 0") if head.startswith("Bit ")])
    rows = ((row[0], _binary(row[:columns]), row[columns]) for row in table.body("Bit 1", "Bit 0", width=columns + 1))
    yield from _values(device, table, rows)


def _binary(row: Sequence[TextCell]) -> int | None:
    digits = "".join(part.text for part in row)
    return int(digits, 2) if set(digits) <= {"0", "1"} and digits else None


def _values(device: Device, table: TextTable, rows: Iterator[tuple[TextCell, int | None, TextCell]]) -> Iterator[Cell]:
    obj = object_of(device, table)
    entry = next((entry for entry in obj.entries if entry.values), obj.entries[0]) if obj else None
    if obj is None or entry is None:
        yield cell(table, None, "values", "no such object", False, ["objects"])
        return
    path = f"{_path(obj, entry)}.values"
    seen: list[NamedValue] = []
    for printed, number_of_row, meaning in rows:
        value = next((value for value in entry.values if value.value == number_of_row), None)
        reserved = meaning.text.casefold().startswith("reserved")
        if value is None or reserved:
            label = "no such value" if value is None else value.name
            yield cell(table, printed, "value", label, reserved and value is None, [f"{path}.{number_of_row}"])
            continue
        seen.append(value)
        where = f"{path}.{value.value}"
        same = alike(_TAG.sub("", meaning.text), value.name, value.text)
        yield cell(table, printed, "value", str(value.value), True, [where])
        yield cell(table, meaning, "meaning", f"{value.name}: {value.text}", same, [where])
    for value in entry.values:
        if value not in seen:
            yield cell(table, None, "value", f"{value.value} {value.name}", False, [f"{path}.{value.value}"])


def signatures(device: Device, table: TextTable) -> Iterator[Cell]:
    """The letters of a signature and below them their codes, the highest byte first."""
    signature = device.signatures.get(table.caption.split()[0].casefold())
    if signature is None or len(table.rows) < 2:
        yield cell(table, None, "signature", "no such signature", False, ["signatures"])
        return
    codes = signature.value.to_bytes(4, "big")
    path = f"signatures.{signature.name}.value"
    for row, shown in zip(table.rows[-2:], ("{:c}", "{:02X}h"), strict=True):
        for printed, code in zip(row, codes, strict=False):
            modelled = shown.format(code)
            yield cell(table, printed, "byte", modelled, printed.text == modelled, [path])


# ---- names and axes --------------------------------------------------------------------------------------------------


def names(device: Device, table: TextTable) -> Iterator[Cell]:
    """A list of objects with their names; blanks do not count, for such lists are careless with them."""
    known = by_index(device)
    for row in table.body("Object", "Name"):
        match = _HEXADECIMAL.fullmatch(row[0].text)
        item = known.get(int(match[1], 16)) if match else None
        if item is None:
            yield cell(table, row[0], "index", "no such object", False, ["objects"])
            continue
        path = f"objects.{item.object.name}"
        same = same_title(row[1].text.replace(" ", ""), item.title.replace(" ", ""))
        yield cell(table, row[0], "index", f"{item.index:04X}h", True, [path])
        yield cell(table, row[1], "name", item.title, same, [f"{path}.title", f"{path}.parameter_name"])


def areas(device: Device, table: TextTable) -> Iterator[Cell]:
    """The indices of each axis: a column for each area, which its heading or the caption names."""
    heads = table.heads("Motor")
    caption = _AREA_OF_CAPTION.search(table.caption)
    words = [caption[1] if caption else head.split()[0] for head in heads[1:] if head]
    found = [next((area for area in device.areas if area.name == word.casefold()), None) for word in words]
    axes = 0
    for axis, row in enumerate(table.body("Motor")):
        axes += 1
        numbered = row[0].text.endswith(f"#{axis}")
        yield cell(table, row[0], "axis", str(axis), numbered and axis < device.axes, ["axes.count"])
        for printed, area in zip(row[1:], found, strict=False):
            if area is None:
                yield cell(table, printed, "indices", "no such area", False, ["axes.areas"])
                continue
            ends = [area.first + axis * area.stride, area.last + axis * area.stride]
            shown = " to ".join(f"{end:04X}h" for end in ends)
            same = [int(end, 16) for end in _HEXADECIMAL.findall(printed.text)] == ends
            yield cell(table, printed, "indices", shown, same, [f"axes.areas.{area.name}"])
    if axes < device.axes:
        yield cell(table, None, "axes", str(device.axes), False, ["axes.count"])
