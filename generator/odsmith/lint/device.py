"""What the file says of itself and of the device: [FileInfo] and [DeviceInfo] (CiA 306-1, clauses 4.4 and 4.5.1)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from datetime import date
from pathlib import PurePath

from odsmith.eds_dictionary import EdsEntry, parse_number
from odsmith.eds_file import Key, Section
from odsmith.errors import Diagnostic, quoted
from odsmith.lint.keys import BIT_RATES, DEVICE_INFO, FILE_INFO
from odsmith.lint.objects import is_mapping
from odsmith.lint.sheet import Note, Sheet, append, delete

EDS_VERSION = "4.0"

_TIME = re.compile(r"(?:0[1-9]|1[0-2]):[0-5][0-9][AP]M\Z")
_DATE = re.compile(r"(\d\d)-(\d\d)-(\d{4})\Z")

_MAY_BE_ABSENT = frozenset({"LastEDS", "CompactPDO"})
_USUAL = {
    **dict.fromkeys(("SimpleBootUpMaster", "DynamicChannelsSupported", "GroupMessaging", "LSS_Supported"), "0")
} | {f"BaudRate_{rate}": "0" for rate in BIT_RATES}
"""What a missing key most likely means."""

_PDO_COUNTS = {"NrOfRXPDO": range(0x1400, 0x1600), "NrOfTXPDO": range(0x1800, 0x1A00)}

_IDENTITY = {1: "VendorNumber", 2: "ProductNumber", 3: "RevisionNumber"}
"""Sub-indices of 1018h and the keys that say the same."""


def _complete(sheet: Sheet) -> Iterator[Diagnostic]:
    usual: Mapping[str, str] = {**_USUAL, **{name: str(number) for name, number in _pdo_counts(sheet).items()}}
    for name, keys in (("FileInfo", FILE_INFO), ("DeviceInfo", DEVICE_INFO)):
        section = sheet.file.section(name)
        if section is None:
            continue
        for known in keys.values():
            key = section.get(known.name)
            if known.name in _MAY_BE_ABSENT:
                continue
            if key is None:
                fix = append(section, f"{known.name}={usual[known.name]}") if known.name in usual else None
                yield sheet.at_section("L301", section, f"{quoted(known.name)} is missing", fix=fix)
            elif key and not key.value and known.kind == "text" and not known.name.endswith(("Time", "Date")):
                yield sheet.at_key("L301", key, f"{quoted(known.name)} is empty")


def _file_name(sheet: Sheet) -> Iterator[Diagnostic]:
    key, name = _key(sheet, "FileInfo", "FileName"), PurePath(sheet.file.path).name
    if key and key.value and key.value != name:
        yield sheet.at_value("L302", key, f"the file is called {quoted(name)}", value=name)


def _versions(sheet: Sheet) -> Iterator[Diagnostic]:
    for name in ("FileVersion", "FileRevision"):
        key = _key(sheet, "FileInfo", name)
        number = parse_number(key.value) if key else None
        if key and number and not 0 <= number.number <= 0xFF:
            yield sheet.at_value("L303", key, f"{quoted(name)} is {key.value}, it has 8 bits")


def _eds_version(sheet: Sheet) -> Iterator[Diagnostic]:
    key = _key(sheet, "FileInfo", "EDSVersion")
    if key and key.value and key.value != EDS_VERSION:
        yield sheet.at_value("L304", key, f"{quoted(key.value)} is not {EDS_VERSION}", value=EDS_VERSION)


def _times(sheet: Sheet) -> Iterator[Diagnostic]:
    for name in ("CreationTime", "ModificationTime"):
        key = _key(sheet, "FileInfo", name)
        if key and not _TIME.match(key.value):
            yield sheet.at_value("L305", key, f"{quoted(key.value)} is no time such as `09:30AM`")


def _dates(sheet: Sheet) -> Iterator[Diagnostic]:
    for name in ("CreationDate", "ModificationDate"):
        key = _key(sheet, "FileInfo", name)
        if key and not _is_date(key.value):
            yield sheet.at_value("L306", key, f"{quoted(key.value)} is no date such as `12-31-2026`")


def _is_date(text: str) -> bool:
    found = _DATE.match(text)
    if not found:
        return False
    month, day, year = map(int, found.groups())
    try:
        date(year, month, day)
    except ValueError:
        return False
    return True


def _bit_rates(sheet: Sheet) -> Iterator[Diagnostic]:
    section = sheet.file.section("DeviceInfo")
    for key in section.keys if section else ():
        name = key.name.lower()
        if name.startswith("baudrate_") and name not in DEVICE_INFO and name[9:].isdecimal():
            message = f"CiA 306 has no key for {name[9:]} kbit/s"
            yield sheet.at_key("L307", key, message, fix=delete(key))


def _pdo_counts(sheet: Sheet) -> dict[str, int]:
    return {name: sum(index in indices for index in sheet.dictionary.objects) for name, indices in _PDO_COUNTS.items()}


def _numbers_of_pdos(sheet: Sheet) -> Iterator[Diagnostic]:
    compact = _key(sheet, "DeviceInfo", "CompactPDO")
    if compact and compact.value != "0":
        return  # PDOs then exist without objects in the file
    for name, count in _pdo_counts(sheet).items():
        key = _key(sheet, "DeviceInfo", name)
        number = parse_number(key.value) if key else None
        if key and number and number.number != count:
            message = f"{quoted(name)} is {key.value}, the file describes {count}"
            yield sheet.at_value("L309", key, message, value=str(count))


def _identity(sheet: Sheet) -> Iterator[Diagnostic]:
    for sub, name in _IDENTITY.items():
        key, entry = _key(sheet, "DeviceInfo", name), sheet.dictionary.entry(0x1018, sub)
        number = parse_number(key.value) if key else None
        if key and number and entry and entry.default and entry.default != number:
            default = entry.section.value("DefaultValue")
            message = f"{quoted(name)} is {key.value}, {sheet.name_of(entry)} says {default}"
            yield sheet.at_value("L310", key, message, entry, notes=_default_note(sheet, entry))


def _default_note(sheet: Sheet, entry: EdsEntry) -> tuple[Note, ...]:
    key = entry.key("DefaultValue")
    return ((sheet.place_of(key), "the identity of the device"),) if key else ()


def _empty_identity(sheet: Sheet) -> Iterator[Diagnostic]:
    """The serial number differs between devices: no file can know it, but it is told where the rest is missing too."""
    serial = sheet.dictionary.entry(0x1018, 4)
    for sub, name in _IDENTITY.items():
        entry, section = sheet.dictionary.entry(0x1018, sub), sheet.file.section("DeviceInfo")
        if entry is None or entry.implied or entry.key("DefaultValue"):
            continue
        value = section.value(name) if section else ""
        known = f", {quoted(name)} is {value}" if value else ""
        fix = append(entry.section, f"DefaultValue={value}") if value else None
        note = (
            ((sheet.place_of(serial.section), "the serial number has no default either"),)
            if serial and not serial.key("DefaultValue")
            else ()
        )
        message = f"{sheet.name_of(entry)} has no DefaultValue{known}"
        yield sheet.at_section("L311", entry.section, message, entry, notes=note, fix=fix)


def _granularity(sheet: Sheet) -> Iterator[Diagnostic]:
    key = _key(sheet, "DeviceInfo", "Granularity")
    number = parse_number(key.value) if key else None
    if key is None or number is None:
        return
    writable = any(entry.writable for entry in sheet.dictionary.entries if is_mapping(entry.index))
    if not 0 <= number.number <= 64:
        yield sheet.at_value("L312", key, f"{key.value} bits are no part of a PDO", value="8")
    elif number.number == 0 and writable:
        yield sheet.at_value("L312", key, "the mapping of PDOs can be written, 0 says that it is fixed", value="8")


def _key(sheet: Sheet, section: str, name: str) -> Key | None:
    found: Section | None = sheet.file.section(section)
    return found.get(name) if found else None


RULES = (
    _complete,
    _file_name,
    _versions,
    _eds_version,
    _times,
    _dates,
    _bit_rates,
    _numbers_of_pdos,
    _identity,
    _empty_identity,
    _granularity,
)
