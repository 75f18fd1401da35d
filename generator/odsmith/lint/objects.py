"""Objects and entries: whether they are complete, and what tools make of their names and flags (CiA 301, CiA 306-1)."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.eds_dictionary import ARRAY, RECORD, TYPES, VAR, EdsEntry, EdsObject, parse_number
from odsmith.eds_file import Key
from odsmith.errors import Diagnostic, listed, quoted
from odsmith.lint.sheet import Sheet, append, delete

_OBJECT_TYPES = (0, 2, 5, 6, VAR, ARRAY, RECORD)
_ACCESS = ("ro", "wo", "rw", "rwr", "rww", "const")
_OF_VALUES = ("DataType", "AccessType", "LowLimit", "HighLimit", "DefaultValue", "PDOMapping", "ParameterValue")

_DOMAIN = 2
_UNSIGNED8 = 5

PDO_NAME_LENGTH = 32
"""The names of PDO parameters become names of frames elsewhere, a DBC file for one holds 32 characters."""

_COMMANDS = {0x1010: None, 0x1011: None, 0x1023: (1,)}
"""Objects of CiA 301 that do something when they are written, and the sub-indices that do; None for all but 0."""


def is_pdo_parameter(index: int) -> bool:
    return 0x1400 <= index <= 0x1BFF


def is_mapping(index: int) -> bool:
    return 0x1600 <= index <= 0x17FF or 0x1A00 <= index <= 0x1BFF


def is_command(entry: EdsEntry) -> bool:
    """Writing the entry stores, restores or starts something (CiA 301)."""
    subs = _COMMANDS.get(entry.index, ())
    return entry.sub > 0 if subs is None else entry.sub in subs


# ---- completeness ------------------------------------------------------------------------------------------------


def _complete(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        if not obj.variable and not obj.name:
            yield sheet.at_section("L401", obj.section, f"{sheet.name_of(obj)} has no ParameterName", obj)
        for entry in obj.entries.values():
            for name in () if entry.implied else _needed(obj):
                if not entry.section.value(name):
                    message = f"{sheet.name_of(entry)} has no {name}"
                    yield sheet.at_section("L401", entry.section, message, entry)


def _needed(obj: EdsObject) -> tuple[str, ...]:
    """CiA 306 lets a domain go without the rest; its type says it all."""
    if obj.object_type in (0, _DOMAIN, 5, 6):
        return ("ParameterName",)
    return "ParameterName", "DataType", "AccessType"


def _object_types(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        for item in _sections_of(obj):
            key = item.section.get("ObjectType")
            number = parse_number(key.value) if key else None
            allowed = _OBJECT_TYPES if item is obj else (_DOMAIN, VAR)
            if key and number and number.number not in allowed:
                yield sheet.at_value("L402", key, f"{sheet.name_of(item)} cannot be of object type {key.value}", item)


def _data_types(sheet: Sheet) -> Iterator[Diagnostic]:
    """A device may define types of its own; they are then objects below 1000h."""
    for entry in sheet.dictionary.entries:
        key, code = entry.key("DataType"), entry.data_type
        if key and code is not None and code not in TYPES and code not in sheet.dictionary.objects:
            yield sheet.at_value("L403", key, f"CiA 301 knows no data type {quoted(key.value)}", entry)


def _access(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("AccessType")
        if key and key.value and key.value not in _ACCESS:
            spelt = entry.access if entry.access in _ACCESS else None
            yield sheet.at_value("L404", key, f"CiA 306 knows no access {quoted(key.value)}", entry, value=spelt)


def _misplaced(sheet: Sheet) -> Iterator[Diagnostic]:
    """Keys of a value in the head of an array or record, and keys of a head in a value."""
    for obj in sheet.dictionary.objects.values():
        if obj.section.get("CompactSubObj"):
            continue
        for key in _keys_of(obj, *_OF_VALUES) if not obj.variable else _keys_of(obj, "SubNumber"):
            kind = "a variable" if obj.variable else "an array or a record"
            yield sheet.at_key("L405", key, f"{quoted(key.name)} says nothing of {kind}", obj, fix=delete(key))
        for entry in obj.entries.values():
            number = entry.section.get("SubNumber") if entry.section is not obj.section else None
            if number:
                message = f"{quoted(number.name)} says nothing of a sub-index"
                yield sheet.at_key("L405", number, message, entry, fix=delete(number))


def _sections_of(obj: EdsObject) -> Iterator[EdsObject | EdsEntry]:
    """The object and its sub-indices: whatever has a section of its own."""
    yield obj
    yield from (entry for entry in obj.entries.values() if entry.section is not obj.section)


def _keys_of(obj: EdsObject, *names: str) -> Iterator[Key]:
    for name in names:
        key = obj.section.get(name)
        if key:
            yield key


# ---- sub-indices ---------------------------------------------------------------------------------------------------


def _variables(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        subs = [entry for entry in obj.entries.values() if entry.section is not obj.section]
        if obj.variable and subs:
            message = f"{sheet.name_of(obj)} is a variable, but {_sections(len(subs))} of sub-indices follow"
            yield sheet.at_section("L406", obj.section, message, obj)


def _sub_numbers(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        if obj.variable or obj.section.get("CompactSubObj"):
            continue
        key, count = obj.section.get("SubNumber"), len(obj.entries)
        number = parse_number(key.value) if key else None
        if key is None:
            fix = append(obj.section, f"SubNumber={count}")
            yield sheet.at_section("L407", obj.section, f"{sheet.name_of(obj)} has no SubNumber", obj, fix=fix)
        elif number and number.number != count:
            message = f"{sheet.name_of(obj)} announces {number.number} sub-indices, {_sections(count)} follow"
            yield sheet.at_value("L407", key, message, obj, value=str(count))


def _sections(count: int) -> str:
    return "no section" if not count else "1 section" if count == 1 else f"{count} sections"


def _sub_zero(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        zero = obj.entries.get(0)
        if obj.variable or not obj.entries or (zero and zero.implied):
            continue
        if zero is None:
            yield sheet.at_section("L408", obj.section, f"{sheet.name_of(obj)} has no sub-index 0", obj)
            continue
        data_type, access = zero.key("DataType"), zero.key("AccessType")
        if data_type and zero.type and zero.data_type != _UNSIGNED8:
            message = f"{sheet.name_of(zero)} is {zero.type.name}, not UNSIGNED8"
            yield sheet.at_value("L408", data_type, message, zero, value="0x0005")
        allowed = ("ro", "const", "rw") if _counts(obj.index) else ("ro", "const")
        if access and zero.access in _ACCESS and zero.access not in allowed:
            message = f"{sheet.name_of(zero)} cannot be {quoted(zero.access)}"
            yield sheet.at_value("L408", access, message, zero, value="ro")


def _counts(index: int) -> bool:
    """Sub-index 0 is the number of entries in force: of a mapping, or of the errors that are remembered."""
    return is_mapping(index) or index == 0x1003


def _highest_sub(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        zero = obj.entries.get(0)
        if obj.variable or zero is None or zero.implied or _counts(obj.index):
            continue
        key, highest = zero.key("DefaultValue"), obj.highest_sub
        spelt = f"0x{highest:02X}"
        if key is None:
            fix = append(zero.section, f"DefaultValue={spelt}")
            message = f"{sheet.name_of(zero)} has no DefaultValue, the highest sub-index is {spelt}"
            yield sheet.at_section("L409", zero.section, message, zero, fix=fix)
        elif zero.default and zero.default.number != highest:
            message = f"{sheet.name_of(zero)} is {key.value}, the highest sub-index is {spelt}"
            yield sheet.at_value("L409", key, message, zero, value=spelt)


def _compact(sheet: Sheet) -> Iterator[Diagnostic]:
    for obj in sheet.dictionary.objects.values():
        for item in _sections_of(obj):
            key = item.section.get("CompactSubObj")
            if key and key.value != "0":
                yield sheet.at_key("L410", key, f"{sheet.name_of(item)} has no sections for its sub-indices", item)


def _orphans(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.dictionary.orphans:
        yield sheet.at_section("L411", section, f"{quoted(section.name)} belongs to an object without a section")


# ---- names and flags ---------------------------------------------------------------------------------------------


def _unique_names(sheet: Sheet) -> Iterator[Diagnostic]:
    seen: dict[str, EdsObject] = {}
    for obj in sheet.dictionary.objects.values():
        key = obj.section.get("ParameterName")
        if key is None or not key.value:
            continue
        first = seen.setdefault(key.value, obj)
        first_key = first.section.get("ParameterName")
        if first is not obj and first_key:
            note = (sheet.place_of(first_key), f"the name of {sheet.name_of(first)}")
            message = f"{sheet.name_of(obj)} is called {quoted(key.value)} like another object"
            yield sheet.at_value("L412", key, message, obj, notes=(note,))


def _pdo_names(sheet: Sheet) -> Iterator[Diagnostic]:
    for index, obj in sheet.dictionary.objects.items():
        key = obj.section.get("ParameterName") if is_pdo_parameter(index) else None
        if key and len(key.value) > PDO_NAME_LENGTH:
            name = f"{'RPDO' if index < 0x1800 else 'TPDO'} {(index & 0x1FF) + 1}"
            name += " Mapping Parameter" if is_mapping(index) else " Communication Parameter"
            yield sheet.at_value("L413", key, f"the name has {len(key.value)} characters", obj, value=name)


def _flags(sheet: Sheet) -> Iterator[Diagnostic]:
    for entry in sheet.dictionary.entries:
        key = entry.key("ObjFlags")
        number = parse_number(key.value) if key else None
        refuses = number is not None and bool(number.number & 1)
        if is_command(entry) and entry.writable and not entry.implied and not refuses:
            message = f"{sheet.name_of(entry)} is a command, but is not kept from being written on a scan"
            fix = None if key else append(entry.section, "ObjFlags=1")
            yield sheet.at_section("L414", entry.section, message, entry, fix=fix)
        elif key and refuses and entry.index < 0x1F00 and entry.index not in _COMMANDS:
            message = f"{sheet.name_of(entry)} is a parameter, not a command"
            yield sheet.at_value("L414", key, message, entry, fix=delete(key))


# ---- the device type -----------------------------------------------------------------------------------------------


def _device_type(sheet: Sheet) -> Iterator[Diagnostic]:
    entry = sheet.dictionary.entry(0x1000, 0)
    if entry is None:
        return
    key = entry.key("DefaultValue")
    if key is None:
        yield sheet.at_section("L415", entry.section, "1000h does not say what kind of device this is", entry)
    elif entry.default and _is_drive(sheet) and entry.default.number & 0xFFFF != 402:
        yield sheet.at_value("L415", key, "the device has a controlword and a statusword, 402 is the profile", entry)
    elif entry.default and entry.default.number & 0xFFFF == 402:
        yield from _single_device_types(sheet, entry)


def _is_drive(sheet: Sheet) -> bool:
    return 0x6040 in sheet.dictionary.objects and 0x6041 in sheet.dictionary.objects


def _single_device_types(sheet: Sheet, device_type: EdsEntry) -> Iterator[Diagnostic]:
    if sheet.axes.count == 1:
        return
    indices = [0x67FF + 0x800 * axis for axis in range(sheet.axes.count)]
    missing = [f"{index:04X}h" for index in indices if index not in sheet.dictionary.objects]
    if missing:
        message = f"the device has {sheet.axes.count} axes, but not {listed(missing)}"
        yield sheet.at_section("L415", device_type.section, message, device_type)
    for index in indices:
        entry = sheet.dictionary.entry(index, 0)
        if entry and (entry.default is None or entry.default.number & 0xFFFF != 402):
            message = f"{sheet.name_of(entry)} does not say that the axis is a drive"
            yield sheet.at_section("L415", entry.section, message, entry)


RULES = (
    _complete,
    _object_types,
    _data_types,
    _access,
    _misplaced,
    _variables,
    _sub_numbers,
    _sub_zero,
    _highest_sub,
    _compact,
    _orphans,
    _unique_names,
    _pdo_names,
    _flags,
    _device_type,
)
