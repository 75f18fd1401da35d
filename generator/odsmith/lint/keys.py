"""The keys of sections: which there may be, how they are spelt, and whether numbers are numbers (CiA 306-1)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

from odsmith.eds_dictionary import address, parse_number
from odsmith.eds_file import Key, Section
from odsmith.errors import Diagnostic, did_you_mean, quoted
from odsmith.lint.sections import COMMISSIONING, LISTS, canonical
from odsmith.lint.sheet import Sheet, delete, replace

BIT_RATES = (10, 20, 50, 125, 250, 500, 800, 1000)
"""In kbit/s: those that [DeviceInfo] has a key for."""

Kind = Literal["text", "number", "flag", "value"]
"""`value` is of the data type of its entry, and a matter of `values`."""


class Known(NamedTuple):
    """A key that the standard knows, under its own spelling."""

    name: str
    kind: Kind


class Keys(NamedTuple):
    """The keys of a section: by their name in lower case, and those that are numbered."""

    known: Mapping[str, Known]
    numbered: re.Pattern[str] | None = None
    numbered_kind: Kind = "number"


def _keys(**kinds: str) -> dict[str, Known]:
    given: dict[str, Known] = {}
    for kind in ("text", "number", "flag", "value"):
        given |= {name.lower(): Known(name, kind) for name in kinds.get(kind, "").split()}
    return given


FILE_INFO = _keys(
    text="FileName EDSVersion Description CreationTime CreationDate CreatedBy ModificationTime ModificationDate "
    "ModifiedBy LastEDS",
    number="FileVersion FileRevision",
)
DEVICE_INFO = _keys(
    text="VendorName ProductName OrderCode",
    number="VendorNumber ProductNumber RevisionNumber Granularity DynamicChannelsSupported NrOfRXPDO NrOfTXPDO "
    "CompactPDO",
    flag="SimpleBootUpMaster SimpleBootUpSlave GroupMessaging LSS_Supported "
    + " ".join(f"BaudRate_{rate}" for rate in BIT_RATES),
)
_COMMISSIONING = _keys(
    text="NodeName NodeRefd NetworkName NetRefd",
    number="NodeID Baudrate NetNumber LSS_SerialNumber",
    flag="CANopenManager",
)
_OBJECT = _keys(
    text="ParameterName AccessType UploadFile DownloadFile Denotation ParamRefd",
    number="SubNumber ObjectType DataType ObjFlags CompactSubObj",
    flag="PDOMapping",
    value="LowLimit HighLimit DefaultValue ParameterValue",
)
_LIST = Keys(_keys(number="SupportedObjects"), re.compile(r"\d+\Z"))

_OF_SECTION = {
    "FileInfo": Keys(FILE_INFO),
    "DeviceInfo": Keys(DEVICE_INFO, re.compile(r"BaudRate_\d+\Z", re.IGNORECASE), "text"),  # L307 looks at others
    COMMISSIONING: Keys(_COMMISSIONING),
    "DummyUsage": Keys({}, re.compile(r"Dummy[0-9A-F]{4}\Z", re.IGNORECASE), "flag"),
    "Comments": Keys(_keys(number="Lines"), re.compile(r"Line\d+\Z", re.IGNORECASE), "text"),
    **dict.fromkeys(LISTS, _LIST),
}
_OBJECT_KEYS = Keys(_OBJECT)

_PLAIN_NUMBER = re.compile(r"(?:0[xX][0-9A-Fa-f]{1,40}|0|-?[1-9][0-9]{0,39})\Z")

_SUGGESTIONS = 20
"""Looking for similar words takes time, and nobody reads more of them."""


def _check_keys(sheet: Sheet) -> Iterator[Diagnostic]:
    suggestions = 0
    for section in sheet.file.sections:
        keys = keys_of(section)
        if keys is None:
            continue
        for key in section.keys:
            known = keys.known.get(key.name.lower())
            if known is None and keys.numbered and keys.numbered.match(key.name):
                known = Known(key.name, keys.numbered_kind)
            if known is None:
                suggestions += 1
                words = [name for name, _ in keys.known.values()] if suggestions <= _SUGGESTIONS else []
                yield _unknown(sheet, section, key, words)
            else:
                yield from _check_key(sheet, key, known)


def keys_of(section: Section) -> Keys | None:
    """The keys that a section may have; None for a section that nothing is known of."""
    if address(section.name):
        return _OBJECT_KEYS
    return _OF_SECTION.get(canonical(section.name))


def _unknown(sheet: Sheet, section: Section, key: Key, words: list[str]) -> Diagnostic:
    message = f"CiA 306 knows no key {quoted(key.name)} in {quoted(f'[{section.name}]')}"
    return sheet.at_key("L205", key, message, hint=did_you_mean(key.name, words), fix=delete(key))


def _check_key(sheet: Sheet, key: Key, known: Known) -> Iterator[Diagnostic]:
    if key.name != known.name:
        spelt = replace(key._replace(name=known.name), key.value)
        yield sheet.at_key("L206", key, f"the standard spells it {quoted(known.name)}", fix=spelt)
    if known.kind in ("number", "flag"):
        yield from check_number(sheet, key)
    if known.kind == "flag":
        number = parse_number(key.value)
        if number and (number.node_id or number.number not in (0, 1)):
            yield sheet.at_value("L118", key, f"{quoted(known.name)} is 0 or 1, not {quoted(key.value)}")


def check_number(sheet: Sheet, key: Key) -> Iterator[Diagnostic]:
    """A number that every reader reads alike."""
    if _PLAIN_NUMBER.match(key.value):
        return
    number = parse_number(key.value)
    if not key.value:
        yield sheet.at_key("L115", key, f"{quoted(key.name)} has no value")
    elif number is None or number.node_id or key.value.lower().startswith("-0x"):
        yield sheet.at_value("L117", key, f"{quoted(key.value)} is not a number")
    else:
        message = f"{quoted(key.value)} has leading zeros"
        yield sheet.at_value("L116", key, message, value=str(number.number))


RULES = (_check_keys,)
