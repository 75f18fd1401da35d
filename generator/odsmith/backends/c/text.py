"""How numbers and comments are spelled in C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from odsmith import escape
from odsmith.canopen_types import NOWHERE, DataType, Place
from odsmith.errors import SpecError
from odsmith.rules import diagnose

WIDTH = 120
"""Longest line of a comment."""


@dataclass(frozen=True, slots=True)
class Constant:
    """A macro or an enumerator: its name, its value as C text (may be empty for an enumerator), what it is."""

    name: str
    value: str
    text: str = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Group:
    """Constants that belong together, as macros or as an enumeration; that may have a type's name."""

    text: str
    constants: tuple[Constant, ...]
    enumeration: bool = False
    type: str = ""


def unsigned(value: int) -> str:
    """A decimal constant of an unsigned type."""
    return f"{value}{'ull' if value > 0xFFFFFFFF else 'u'}"


def hexadecimal(value: int, digits: int = 0) -> str:
    """A hexadecimal constant of an unsigned type."""
    return f"0x{value:0{digits}X}{'ull' if value > 0xFFFFFFFF else 'u'}"


def number(value: int, data_type: DataType) -> str:
    """A constant that has a value of this type without a conversion that a compiler would warn about."""
    if data_type in (DataType.REAL32, DataType.REAL64):
        return f"{value}.0{'f' if data_type is DataType.REAL32 else ''}"
    return signed(value) if data_type.signed else unsigned(value)


def signed(value: int) -> str:
    """A decimal constant of a signed type. The smallest number of a type has no constant of its own in C."""
    suffix = "" if -0x80000000 <= value <= 0x7FFFFFFF else "ll"
    if value in (-0x80000000, -0x8000000000000000):
        return f"-{-value - 1}{suffix} - 1"
    return f"{value}{suffix}"


def comment(text: str, indent: int = 0) -> str:
    """A comment on lines of its own, with the indentation of the first line included."""
    safe = escape.c_comment(text)
    blank = " " * indent
    one_line = f"{blank}/* {safe} */"
    if len(one_line) <= WIDTH:
        return one_line
    lines = escape.wrap(safe, WIDTH - indent - 3)
    return "\n".join([f"{blank}/*", *(f"{blank} * {line}" for line in lines), f"{blank} */"])


def beside(code: str, text: str, indent: int = 0) -> str:
    """A line of code with a comment: behind it where there is room, else above it."""
    line = " " * indent + code
    if not text:
        return line
    one_line = f"{line} /* {escape.c_comment(text)} */"
    return one_line if len(one_line) <= WIDTH else f"{comment(text, indent)}\n{line}"


def rows(items: Iterable[str], per_line: int) -> list[str]:
    """Items joined by commas, so many to a line."""
    items = list(items)
    return [", ".join(items[start : start + per_line]) for start in range(0, len(items), per_line)]


def distinct(groups: Iterable[Group]) -> None:
    """Raise SpecError if two constants have the same name."""
    seen: dict[str, Constant] = {}
    problems = []
    for constant in _all(groups):
        first = seen.setdefault(constant.name, constant)
        if first is not constant:
            problems.append(
                diagnose(
                    "E472",
                    constant.place,
                    f"two elements become {constant.name} in C",
                    "rename one of them",
                    notes=((first.place, "the other one is here"),),
                )
            )
    if problems:
        raise SpecError(problems)


def _all(groups: Iterable[Group]) -> Iterator[Constant]:
    for group in groups:
        yield from group.constants
