"""The sections of the file: their names, which there must be, and their order (CiA 306-1, clauses 4.5 and 5)."""

from __future__ import annotations

import re
from collections.abc import Iterator

from odsmith.eds_dictionary import address
from odsmith.eds_file import Section, plain_name
from odsmith.errors import Diagnostic, Fix, did_you_mean, listed, quoted
from odsmith.lint.sheet import Sheet

LISTS = ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects")

NEEDED = ("FileInfo", "DeviceInfo", "DummyUsage", *LISTS)
"""Without one of these a reader fails, or takes the device for something that it is not."""

ORDER = ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", *LISTS)
"""The order that all readers take; the objects follow."""

COMMISSIONING = "DeviceComissioning"
"""The standard spells it with one m."""

_KNOWN = {name.lower(): name for name in (*ORDER, COMMISSIONING)} | {"devicecommissioning": COMMISSIONING}

# Sections of CiA 306 for modular devices and tools, and the tables of CompactSubObj: nothing here judges them.
_OTHER = re.compile(
    r"(?:DynamicChannels|Tools|Tool\d+|SupportedModules|M\d+\w+|StandardDataTypes"
    r"|[0-9A-F]{4}(?:Name|Value|Denotation|ObjectLinks))\Z",
    re.IGNORECASE,
)

_SUGGESTIONS = 20
"""Looking for similar words takes time, and nobody reads more of them."""


def canonical(name: str) -> str:
    """The name of a section as the standard spells it; empty for an unknown one."""
    at = address(name)
    if at is None:
        return _KNOWN.get(plain_name(name), "")
    index, sub = at
    return f"{index:04X}" if sub is None else f"{index:04X}sub{sub:X}"


def _spelling(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.file.sections:
        name = canonical(section.name)
        if name and name != section.name:
            message = f"{quoted(section.name)} has to be spelt {quoted(name)}"
            yield sheet.at_section("L201", section, message, fix=Fix(section.line, section.line, (f"[{name}]",)))


def _unknown(sheet: Sheet) -> Iterator[Diagnostic]:
    unknown = [s for s in sheet.file.sections if not canonical(s.name) and not _OTHER.match(s.name)]
    for number, section in enumerate(unknown):
        hint = did_you_mean(section.name, _KNOWN.values()) if number < _SUGGESTIONS else ""
        yield sheet.at_section("L202", section, f"CiA 306 knows no section {quoted(section.name)}", hint=hint)


def _missing(sheet: Sheet) -> Iterator[Diagnostic]:
    needed = (*NEEDED, COMMISSIONING) if sheet.dcf else NEEDED
    there = {canonical(section.name) for section in sheet.file.sections}
    for name in needed:
        if name not in there:
            yield sheet.at_section("L203", None, f"the section {quoted(f'[{name}]')} is missing")


def _order(sheet: Sheet) -> Iterator[Diagnostic]:
    """Each place where the order breaks is told once, not each section that comes after."""
    before: Section | None = None
    for section in sheet.file.sections:
        rank = _rank(section)
        if rank is None:
            continue
        if before and rank < (_rank(before) or rank):
            sections = listed([f"[{before.name}]"])
            yield sheet.at_section("L204", section, f"the section belongs before {sections}")
        before = section


def _rank(section: Section) -> tuple[int, int, int] | None:
    """What sections are sorted by; None for those that may stand anywhere."""
    at = address(section.name)
    if at:
        return len(ORDER), at[0], -1 if at[1] is None else at[1]
    name = canonical(section.name)
    return (ORDER.index(name), 0, 0) if name in ORDER else None


RULES = (_spelling, _unknown, _missing, _order)
