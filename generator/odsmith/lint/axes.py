"""Axes: what one axis has, every axis has, under the same name and with the same properties.

The block of an axis repeats, so that a client written for one axis works on each. Where blocks differ, most of them
are taken to be right, and axis 0 if there is no majority.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from odsmith.eds_dictionary import EdsEntry, EdsObject, parse_number
from odsmith.eds_file import Key, Section
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.objects import is_mapping, is_pdo_parameter
from odsmith.lint.sheet import Sheet

_COMPARED = ("ObjectType", "DataType", "AccessType", "LowLimit", "HighLimit", "DefaultValue", "PDOMapping", "ObjFlags")

_NUMBERS = (re.compile(r"\b([0-9]+)\b"), re.compile(r"([0-9]+)"))
"""Numbers that stand alone, as in `Controlword 1`, and any number, as in `Axis1 Controlword`."""

_ITS_NUMBER = "\0"
"""Stands in a name for the number of the axis or of the PDO; no name contains it."""

Block = Mapping[int, EdsObject]
"""What an object that repeats is on each axis that has it."""
Properties = tuple[object, ...]
Counting = Callable[[int, int], str]
"""The number in a name, given an axis and an index."""


def _axes(sheet: Sheet) -> Iterator[Diagnostic]:
    blocks = tuple(_find(sheet)) if sheet.axes.count > 1 else ()
    for rule in (_complete, _alike, _object_names, _entry_names):
        yield from rule(sheet, blocks)


def _find(sheet: Sheet) -> Iterable[Block]:
    """Every object that repeats."""
    found: dict[int, dict[int, EdsObject]] = {}
    for index, obj in sheet.dictionary.objects.items():
        first, axis = sheet.axes.fold(index)
        if axis is not None:
            found.setdefault(first, {})[axis] = obj
    return found.values()


def _entries(objects: Block) -> Iterator[Mapping[int, EdsEntry]]:
    """For each sub-index of an object that repeats, what it is on each axis that has it."""
    for sub in sorted({sub for obj in objects.values() for sub in obj.entries}):
        yield {axis: obj.entries[sub] for axis, obj in objects.items() if sub in obj.entries}


# ---- what is missing ---------------------------------------------------------------------------------------------


def _complete(sheet: Sheet, blocks: Sequence[Block]) -> Iterator[Diagnostic]:
    axes = range(sheet.axes.count)
    for objects in blocks:
        some = next(iter(objects.values()))
        for axis in axes:
            if axis not in objects and 2 * len(objects) >= len(axes):
                message = f"axis {axis} lacks {_where(sheet, some.index, axis)}, which other axes have"
                yield sheet.at_section("L604", some.section, message, some)
        for entries in _entries(objects):
            there = next(iter(entries.values()))
            for axis in objects.keys() - entries.keys() if 2 * len(entries) >= len(objects) else ():
                note = (sheet.place_of(there.section), "there it is")
                message = f"{sheet.name_of(objects[axis])} lacks sub-index {there.sub:X}, which other axes have"
                yield sheet.at_section("L604", objects[axis].section, message, objects[axis], notes=(note,))


def _where(sheet: Sheet, index: int, axis: int) -> str:
    first, _ = sheet.axes.fold(index)
    stride = next(area.stride for area in sheet.axes.areas if area.first <= first < area.first + area.stride)
    return f"{first + axis * stride:04X}h"


# ---- what is different -------------------------------------------------------------------------------------------


def _alike(sheet: Sheet, blocks: Sequence[Block]) -> Iterator[Diagnostic]:
    for objects in blocks:
        for entries in _entries(objects):
            texts = {_text(entry.section) for entry in entries.values()}
            if len(texts) == 1 and not any(is_mapping(obj.index) for obj in objects.values()):
                continue  # nearly always, and then there is nothing to understand
            properties = {axis: _properties(sheet, entry) for axis, entry in entries.items()}
            right, reference = _majority(properties)
            for axis, found in properties.items():
                if found != right:
                    yield _difference(sheet, axis, entries[axis], reference, entries[reference], found, right)


def _text(section: Section) -> tuple[tuple[str, str], ...]:
    return tuple((key.name, key.value) for key in section.keys if key.name != "ParameterName")


def _properties(sheet: Sheet, entry: EdsEntry) -> Properties:
    return tuple(_property(sheet, entry, name) for name in _COMPARED)


def _property(sheet: Sheet, entry: EdsEntry, name: str) -> object:
    """What a key says, in a form that is equal for equal axes; None where the key is missing."""
    key = entry.section.get(name)
    if key is None:
        return None
    if name == "AccessType":
        return entry.access
    if name == "DefaultValue" and is_pdo_parameter(entry.index) and not is_mapping(entry.index) and entry.sub == 1:
        return "a COB-ID"  # each PDO has one of its own, and those of further axes are mostly not in use
    number = parse_number(key.value)
    if number and name == "DefaultValue" and is_mapping(entry.index) and entry.sub:
        _, own = sheet.axes.fold(entry.index)
        first, axis = sheet.axes.fold(number.number >> 16)
        return first, number.number & 0xFFFF, axis in (None, own)
    return (number.number, number.node_id) if number else key.value


def _majority(properties: Mapping[int, Properties]) -> tuple[Properties, int]:
    """The properties that most axes have, and the first axis that has them."""
    counts = Counter(properties.values())
    most = max(counts.values())
    axis = next(axis for axis in sorted(properties) if counts[properties[axis]] == most)
    return properties[axis], axis


def _difference(
    sheet: Sheet, axis: int, entry: EdsEntry, other_axis: int, other: EdsEntry, found: Properties, right: Properties
) -> Diagnostic:
    different = [name for name, one, two in zip(_COMPARED, found, right, strict=True) if one != two]
    said = "; ".join(f"{name} {_said(entry.section, name)}, not {_said(other.section, name)}" for name in different)
    message = f"{sheet.name_of(entry)} on axis {axis} differs from {sheet.name_of(other)} on axis {other_axis}: {said}"
    note = (sheet.place_of(_first_key(other.section, different)), f"axis {other_axis}")
    here = _first_key(entry.section, different)
    if isinstance(here, Key):
        return sheet.at_value("L601", here, message, entry, notes=(note,))
    return sheet.at_section("L601", here, message, entry, notes=(note,))


def _said(section: Section, name: str) -> str:
    key = section.get(name)
    return quoted(key.value) if key else "missing"


def _first_key(section: Section, names: list[str]) -> Key | Section:
    return next((key for key in map(section.get, names) if key), section)


# ---- names -------------------------------------------------------------------------------------------------------


def _object_names(sheet: Sheet, blocks: Sequence[Block]) -> Iterator[Diagnostic]:
    for objects in blocks:
        yield from _names(sheet, "L602", objects)


def _entry_names(sheet: Sheet, blocks: Sequence[Block]) -> Iterator[Diagnostic]:
    for objects in blocks:
        for entries in _entries(objects):
            own = {axis: entry for axis, entry in entries.items() if entry.section is not objects[axis].section}
            yield from _names(sheet, "L603", own)


def _names(sheet: Sheet, rule: str, items: Mapping[int, EdsObject | EdsEntry]) -> Iterator[Diagnostic]:
    """Names on several axes are alike if they are equal, or if they differ only in the number of the axis or PDO."""
    keys = {axis: item.section.get("ParameterName") for axis, item in items.items()}
    named = {axis: key for axis, key in keys.items() if key and key.value}
    if len({key.value for key in named.values()}) <= 1 or _numbered(named):
        return
    forms = {axis: _forms(key.value, axis, items[axis].index) for axis, key in named.items()}
    counts = Counter(form for each in forms.values() for form in each)
    right = max(counts, key=lambda form: (counts[form], _ITS_NUMBER in form))
    if counts[right] == len(named):
        return
    reference = next(axis for axis in forms if right in forms[axis])
    note = (sheet.place_of(named[reference]), f"axis {reference}")
    for axis, key in named.items():
        if right not in forms[axis]:
            name = right.replace(_ITS_NUMBER, forms[reference][right](axis, items[axis].index))
            message = f"{quoted(key.value)} on axis {axis} is {quoted(named[reference].value)} on axis {reference}"
            yield sheet.at_value(rule, key, message, items[axis], value=name, notes=(note,))


def _numbered(named: Mapping[int, Key]) -> bool:
    """The names are one, followed by the number of the axis: nearly always, and quickly found."""
    stems = {key.value.removesuffix(str(axis + 1)) for axis, key in named.items()}
    return len(stems) == 1 and all(key.value.endswith(str(axis + 1)) for axis, key in named.items())


def _forms(name: str, axis: int, index: int) -> dict[str, Counting]:
    """The name with a mark for its number, for each thing that the number may count, and the name as it is."""
    forms: dict[str, Counting] = {}
    for counted in (_axis_number, _pdo_number) if is_pdo_parameter(index) else (_axis_number,):
        number = counted(axis, index)
        for pattern in _NUMBERS if number in name else ():
            words = [_ITS_NUMBER if word == number else word for word in pattern.split(name)]
            forms.setdefault("".join(words), counted)
    return {**forms, name: _axis_number}


def _axis_number(axis: int, _: int) -> str:
    return str(axis + 1)


def _pdo_number(_: int, index: int) -> str:
    return str((index & 0x1FF) + 1)


RULES = (_axes,)
