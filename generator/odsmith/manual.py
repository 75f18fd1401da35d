"""What a manual contains: its sections and tables, and where their facts stand if not in elements that cite them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache

from odsmith.canopen_types import NOWHERE, Place


@dataclass(frozen=True, slots=True)
class Restated:
    """Sections and tables whose facts stand at `paths`, in elements that cite somebody else or nobody."""

    sections: tuple[str, ...]
    tables: tuple[int, ...]
    paths: tuple[str, ...]
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class WithoutFacts:
    """Sections and tables that say nothing about the device, with the reason."""

    sections: tuple[str, ...]
    tables: tuple[int, ...]
    reason: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Manual:
    """The table of contents of the manual of the device `name`.

    `sections` are all titles by number, in the order of the document; `tables` is how many tables are known, numbered
    from 1. `family` names the manual that `section` of a source cites where this one is a sister's; `sections_there`
    and `tables_there` say which section or table of it tells the same. `cut_off` says what of it is not at hand.
    """

    name: str
    sections: Mapping[str, str]
    tables: int
    family: str = ""
    sections_there: Mapping[str, str] = field(default_factory=dict)
    tables_there: Mapping[int, int] = field(default_factory=dict)
    restated: tuple[Restated, ...] = ()
    without_facts: tuple[WithoutFacts, ...] = ()
    cut_off: str = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)


_NUMBER = r"[1-9]\d*(?:\.[1-9]\d*)*"
_SECTIONS = re.compile(rf"({_NUMBER})(?:\s*-\s*({_NUMBER}))?")


def section_key(number: str) -> tuple[int, ...]:
    """What sections sort by: 3.1.2 stands before 3.1.10."""
    return tuple(map(int, number.split(".")))


@cache  # many elements cite the same section
def section_numbers(text: str) -> tuple[str, ...]:
    """The sections that a source names: `3.1.18-3.1.20, 4.1` gives 3.1.18, 3.1.19, 3.1.20 and 4.1.

    The title page counts as none. Raises ValueError for what is no section, and for a range whose ends are no
    neighbours in ascending order.
    """
    numbers: list[str] = []
    for piece in filter(None, map(str.strip, text.split(","))):
        if piece == "title page":
            continue
        match = _SECTIONS.fullmatch(piece)
        if not match:
            raise ValueError(f"`{piece}` is no section")
        first = section_key(match[1])
        last = section_key(match[2] or match[1])
        if first[:-1] != last[:-1] or first > last:
            raise ValueError(f"`{piece}` is no range of neighbouring sections")
        numbers += [".".join(map(str, (*first[:-1], end))) for end in range(first[-1], last[-1] + 1)]
    return tuple(numbers)
