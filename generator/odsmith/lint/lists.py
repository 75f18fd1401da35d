"""The lists of supported objects, and the other numbered sections (CiA 306-1, clauses 4.5.2 and 4.6)."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.eds_dictionary import parse_number
from odsmith.eds_file import Key, Section
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.sections import LISTS
from odsmith.lint.sheet import Sheet, append

MANDATORY = (0x1000, 0x1001, 0x1018)
"""Objects that every device has (CiA 301), and the only ones that [MandatoryObjects] may list."""

_DUMMIES = tuple(f"Dummy{number:04X}" for number in range(1, 8))


def _lists(sheet: Sheet) -> Iterator[Section]:
    for name in LISTS:
        section = sheet.file.section(name)
        if section:
            yield section


def _items(section: Section) -> list[Key]:
    return [key for key in section.keys if key.name.isdecimal()]


def _listed(sheet: Sheet) -> Iterator[tuple[str, Key, int]]:
    """Every item of the lists: the list's name, the key, the index."""
    for name in LISTS:
        section = sheet.file.section(name)
        for key in _items(section) if section else ():
            number = parse_number(key.value)
            if number and not number.node_id:
                yield name, key, number.number


def _count(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in _lists(sheet):
        items = len(_items(section))
        key = section.get("SupportedObjects")
        number = parse_number(key.value) if key else None
        if key is None:
            fix = append(section, f"SupportedObjects={items}")
            yield sheet.at_section("L211", section, "the list does not say how long it is", fix=fix)
        elif number and number.number != items:
            message = f"{number.number} objects are announced, {items} are listed"
            yield sheet.at_value("L211", key, message, value=str(items))
        elif number and not key.value.isdecimal():
            yield sheet.at_value("L212", key, f"{quoted(key.value)} is not decimal", value=str(items))


def _numbering(sheet: Sheet) -> Iterator[Diagnostic]:
    """Only the first item out of step: those after it follow from it."""
    for section in _lists(sheet):
        for number, key in enumerate(_items(section), 1):
            if key.name != str(number):
                yield sheet.at_key("L213", key, f"item {number} of the list is called {quoted(key.name)}")
                break


def _spelling(sheet: Sheet) -> Iterator[Diagnostic]:
    for _, key, index in _listed(sheet):
        spelt = f"0x{index:04X}"
        if key.value != spelt and 0 <= index <= 0xFFFF:
            yield sheet.at_value("L214", key, f"{quoted(key.value)} has to be spelt {quoted(spelt)}", value=spelt)


def _once(sheet: Sheet) -> Iterator[Diagnostic]:
    seen: dict[int, Key] = {}
    for _, key, index in _listed(sheet):
        first = seen.setdefault(index, key)
        if first is not key:
            note = (sheet.place_of(first), "first listed here")
            yield sheet.at_value("L215", key, f"{_hex(index)} is listed twice", notes=(note,))


def _right_list(sheet: Sheet) -> Iterator[Diagnostic]:
    for name, key, index in _listed(sheet):
        right = list_of(index)
        if right != name:
            belongs = f"belongs into {quoted(f'[{right}]')}" if right else "belongs into no list"
            yield sheet.at_value("L216", key, f"{_hex(index)} {belongs}")


def list_of(index: int) -> str:
    """The list that an object belongs into; empty for what is no object of a dictionary."""
    if index in MANDATORY:
        return "MandatoryObjects"
    if 0x2000 <= index <= 0x5FFF:
        return "ManufacturerObjects"
    return "OptionalObjects" if 0x1000 <= index <= 0xFFFF else ""


def _described(sheet: Sheet) -> Iterator[Diagnostic]:
    for _, key, index in _listed(sheet):
        if index not in sheet.dictionary.objects:
            yield sheet.at_value("L217", key, f"{_hex(index)} has no section")


def _complete(sheet: Sheet) -> Iterator[Diagnostic]:
    listed = {index for _, _, index in _listed(sheet)}
    for index, obj in sheet.dictionary.objects.items():
        if index not in listed and index >= 0x1000:
            hint = f"add it to [{list_of(index)}]"
            yield sheet.at_section("L218", obj.section, f"{_hex(index)} is in no list", obj, hint=hint)


def _mandatory(sheet: Sheet) -> Iterator[Diagnostic]:
    known = {index for _, _, index in _listed(sheet)} | sheet.dictionary.objects.keys()
    for index in MANDATORY:
        if index not in known:
            section = sheet.file.section("MandatoryObjects")
            yield sheet.at_section("L219", section, f"{_hex(index)} is missing", sheet.path(index))


def _dummies(sheet: Sheet) -> Iterator[Diagnostic]:
    section = sheet.file.section("DummyUsage")
    for name in _DUMMIES if section else ():
        if section and section.get(name) is None:
            yield sheet.at_section("L207", section, f"{quoted(name)} is missing", fix=append(section, f"{name}=0"))


def _comment_lines(sheet: Sheet) -> Iterator[Diagnostic]:
    section = sheet.file.section("Comments")
    key = section.get("Lines") if section else None
    if section is None or (key and parse_number(key.value) is None):
        return
    lines = [item.name.lower() for item in section.keys if item.name.lower() != "lines"]
    announced = parse_number(key.value) if key else None
    if lines != [f"line{number}" for number in range(1, len(lines) + 1)]:
        yield sheet.at_section("L208", section, "the lines are not called Line1, Line2 and so on")
    elif key is None:
        yield sheet.at_section("L208", section, "`Lines` is missing", fix=append(section, f"Lines={len(lines)}"))
    elif announced and announced.number != len(lines):
        message = f"{announced.number} lines are announced, there are {len(lines)}"
        yield sheet.at_value("L208", key, message, value=str(len(lines)))


def _hex(index: int) -> str:
    return f"{index:04X}h"


RULES = (
    _dummies,
    _comment_lines,
    _count,
    _numbering,
    _spelling,
    _once,
    _right_list,
    _described,
    _complete,
    _mandatory,
)
