"""What only a DCF has: the configuration of one device (CiA 306-1, clause 5)."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.eds_dictionary import parse_number
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.sections import COMMISSIONING
from odsmith.lint.sheet import Sheet, delete


def _node_id(sheet: Sheet) -> Iterator[Diagnostic]:
    section = sheet.file.section(COMMISSIONING)
    key = section.get("NodeID") if section else None
    if section and key is None:
        yield sheet.at_section("L321", section, "`NodeID` is missing")
        return
    number = parse_number(key.value) if key else None
    if key is None or number is None or number.node_id:
        return
    if not 1 <= number.number <= 127:
        yield sheet.at_value("L321", key, f"{quoted(key.value)} is no node-ID")
    elif not key.value.isdecimal():
        yield sheet.at_value("L321", key, f"{quoted(key.value)} is not decimal", value=str(number.number))


def _parameter_values(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("ParameterValue")
        if key is None:
            continue
        value = parse_number(key.value)
        if not sheet.dcf:
            yield sheet.at_key("L322", key, f"{sheet.name_of(entry)} has a ParameterValue", entry, fix=delete(key))
        elif value and value.node_id:
            yield sheet.at_value("L323", key, f"{quoted(key.value)} still depends on the node-ID", entry)
        elif value and value == entry.default:
            message = f"{sheet.name_of(entry)} has this value anyway"
            yield sheet.at_value("L324", key, message, entry, fix=delete(key))


RULES = (_node_id, _parameter_values)
