"""Values, limits and defaults: whether they fit their type, and whether every reader reads the same number."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from odsmith.eds_dictionary import BasicType, EdsEntry, parse_number
from odsmith.eds_file import Key
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.keys import check_number
from odsmith.lint.objects import is_command, is_mapping, is_pdo_parameter
from odsmith.lint.sheet import Sheet, delete
from odsmith.model import Default

_KEYS = ("LowLimit", "HighLimit", "DefaultValue", "ParameterValue")
_LIMITS = ("LowLimit", "HighLimit")
_VALUES = ("DefaultValue", "ParameterValue")

HIGHEST_NODE_ID = 127

_WITH_NODE_ID = re.compile(r"\$NODEID\+(?:0x[0-9A-Fa-f]+|0|[1-9][0-9]*)\Z")
_BUS_SETTING = re.compile(r"node[- _]?id|bit[- _]?rate|baud", re.IGNORECASE)

_WORD = range(ord("a"), ord("z") + 1)

_NARROW: Mapping[int, tuple[int, ...] | None] = {
    0x1019: (0,),
    0x1029: None,
    **dict.fromkeys((0x605A, 0x605B, 0x605C, 0x605D, 0x605E, 0x6060, 0x6098), (0,)),
    0x60C2: (2,),
}
"""Objects of CiA 301 and 402 of which no device allows every value of the type, and their sub-indices; None for all
but 0. The transmission type and the number of mapped objects of a PDO come to them, see `_is_narrow`."""


class Reading(NamedTuple):
    """A limit or a value of an integer that is a number."""

    entry: EdsEntry
    type: BasicType
    key: Key
    name: str
    number: Default


def _integers(sheet: Sheet) -> Iterator[Diagnostic]:
    readings = tuple(_read(sheet))
    for rule in (_negative_as_unsigned, _signed_in_hexadecimal, _fits, _limits, _inside, _cob_ids):
        yield from rule(sheet, readings)


def _read(sheet: Sheet) -> Iterator[Reading]:
    for entry in sheet.dictionary.entries:
        if entry.implied or entry.type is None or not entry.type.integer:
            continue
        for name in _KEYS:
            key = entry.section.get(name)
            number = parse_number(key.value) if key else None
            if key and number:
                yield Reading(entry, entry.type, key, name, number)


def _readable(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        for name in _KEYS if not entry.implied and entry.type and entry.type.integer else ():
            key = entry.section.get(name)
            if key and not key.value:
                yield sheet.at_key("L115", key, f"{quoted(name)} has no value", entry, fix=delete(key))
            elif key and not _WITH_NODE_ID.match(key.value):
                yield from _check(sheet, entry, key)


def _check(sheet: Sheet, entry: EdsEntry, key: Key) -> Iterator[Diagnostic]:
    number = parse_number(key.value)
    if number and number.node_id:
        spelt = f"$NODEID+0x{number.number:X}"
        message = f"{quoted(key.value)} has to be spelt {quoted(spelt)}"
        yield sheet.at_value("L427", key, message, entry, value=spelt)
    elif not key.value.lower().startswith("-0x"):
        yield from check_number(sheet, key)


def _negative_as_unsigned(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    for entry, data_type, key, _, number in readings:
        if _is_twos_complement(data_type, key, number):
            meant = number.number - (1 << data_type.bits)
            message = f"{key.value} is {number.number} to some readers and {meant} to others, for {data_type.name}"
            yield sheet.at_value("L421", key, message, entry, value=str(meant))


def _is_twos_complement(data_type: BasicType, key: Key, number: Default) -> bool:
    hexadecimal = key.value[:2].lower() == "0x"
    return hexadecimal and data_type.kind == "signed" and data_type.high < number.number < 1 << data_type.bits


def _signed_in_hexadecimal(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    for entry, data_type, key, _, number in readings:
        hexadecimal = "x" in key.value.lower() and not number.node_id
        if hexadecimal and data_type.kind == "signed" and not _is_twos_complement(data_type, key, number):
            message = f"{key.value} is a hexadecimal {data_type.name}"
            yield sheet.at_value("L422", key, message, entry, value=str(number.number))


def _fits(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    for entry, data_type, key, _, number in readings:
        if _is_twos_complement(data_type, key, number):
            continue
        highest = number.number + (HIGHEST_NODE_ID if number.node_id else 0)
        if number.number < data_type.low or highest > data_type.high:
            yield sheet.at_value("L423", key, f"{key.value} does not fit into {data_type.name}", entry)


def _limits(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    for entry, data_type, key, name, high in readings:
        low_key = entry.section.get("LowLimit")
        if name == "HighLimit" and low_key and entry.low and _signed(data_type, entry.low) > _signed(data_type, high):
            note = (sheet.place_of(low_key), "the lower one")
            yield sheet.at_value(
                "L424", key, f"no value lies between {low_key.value} and {key.value}", entry, notes=(note,)
            )


def _inside(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    for entry, data_type, key, name, number in readings:
        if number.node_id or name not in _VALUES:
            continue
        value = _signed(data_type, number)
        for limit_name, limit, outside in (("LowLimit", entry.low, -1), ("HighLimit", entry.high, 1)):
            limit_key = entry.section.get(limit_name)
            if limit_key and limit and not limit.node_id and (value - _signed(data_type, limit)) * outside > 0:
                note = (sheet.place_of(limit_key), "the limit")
                beyond = "below" if outside < 0 else "above"
                message = f"{key.value} is {beyond} the limit of {limit_key.value}"
                yield sheet.at_value("L425", key, message, entry, notes=(note,))


def _signed(data_type: BasicType, number: Default) -> int:
    """The number that is meant, also where a negative one is written without its sign."""
    too_high = data_type.kind == "signed" and data_type.high < number.number < 1 << data_type.bits
    return number.number - (1 << data_type.bits) if too_high else number.number


def _missing_limits(sheet: Sheet) -> Iterator[Diagnostic]:
    writable = [entry for entry in sheet.dictionary.entries if entry.writable and entry.type and entry.type.integer]
    without = [entry for entry in writable if entry.low is None and entry.high is None]
    if writable and len(without) == len(writable):
        message = f"none of the {len(writable)} writable integers has a LowLimit or a HighLimit"
        yield sheet.at_section("L426", None, message)
    alike: dict[str, list[EdsEntry]] = {}
    for entry in filter(_is_narrow, without):
        alike.setdefault(sheet.path_of(entry), []).append(entry)
    for entries in alike.values():
        others = ", nor has it on other axes" if len(entries) > 1 else ""
        message = f"{sheet.name_of(entries[0])} has no limits{others}"
        yield sheet.at_section("L426", entries[0].section, message, entries[0])


def _is_narrow(entry: EdsEntry) -> bool:
    """No device allows every value that the type can hold (CiA 301, CiA 402)."""
    if is_mapping(entry.index):
        return entry.sub == 0
    if is_pdo_parameter(entry.index):
        return entry.sub == 2
    subs = _NARROW.get(entry.index, ())
    return entry.sub > 0 if subs is None else entry.sub in subs


def _cob_ids(sheet: Sheet, readings: Sequence[Reading]) -> Iterator[Diagnostic]:
    """Bit 31 says that the identifier is not in use, and then the rest does not matter (CiA 301, 7.5.2.35)."""
    for entry, _, key, name, number in readings:
        of_pdo = is_pdo_parameter(entry.index) and not is_mapping(entry.index) and entry.sub == 1
        active = not number.node_id and not number.number >> 31 & 1
        if (of_pdo or entry.index == 0x1014) and name == "DefaultValue" and active:
            message = f"{key.value} is the same CAN-ID for every device of this type"
            yield sheet.at_value("L428", key, message, entry)


def _defaults_of_commands(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("DefaultValue") if entry.writable else None
        if key and (is_command(entry) or _is_signature(entry)):
            message = f"a tool that downloads defaults runs the command {sheet.name_of(entry)}"
            yield sheet.at_value("L429", key, message, entry, fix=delete(key))


def _is_signature(entry: EdsEntry) -> bool:
    """The default is four letters, as in `save` and `load` (CiA 301, 7.5.2.13)."""
    number = entry.default.number if entry.default and entry.bits == 32 else 0
    return all(number >> shift & 0xFF in _WORD for shift in (0, 8, 16, 24))


def _defaults_of_bus_settings(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("DefaultValue") if entry.writable and 0x2000 <= entry.index <= 0x5FFF else None
        if key and entry.type and entry.type.integer and _BUS_SETTING.search(entry.name):
            message = f"a tool that downloads defaults writes {key.value} into every device"
            yield sheet.at_value("L430", key, message, entry, fix=delete(key))


def _defaults_of_others(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("DefaultValue")
        if key and key.value and entry.type and not entry.type.integer and not is_command(entry):
            yield sheet.at_value("L431", key, f"a default of {entry.type.name}", entry, fix=delete(key))


def _limits_of_others(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        if entry.type is None or entry.type.kind != "other":
            continue
        for name in _LIMITS:
            key = entry.key(name)
            if key:
                yield sheet.at_key("L432", key, f"{entry.type.name} has no limits", entry, fix=delete(key))


RULES = (
    _readable,
    _integers,
    _missing_limits,
    _defaults_of_commands,
    _defaults_of_bus_settings,
    _defaults_of_others,
    _limits_of_others,
)
