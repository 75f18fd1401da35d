"""Python source as `ruff format` lays it out: literals, calls, docstrings, imports.

What fits on a line stands on one; what does not is opened, one element per line, each with a comma after it. Long text
becomes several literals that Python joins, and the whole text again at run time.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from odsmith import escape

WIDTH = 120

_ENDLESS = 1 << 30
"""Room for what has to be on one line, however long it is: the key of a dictionary."""


@dataclass(frozen=True, slots=True)
class Hex:
    """An integer that is written in hexadecimal; `group` digits at the end stand apart: 0x6040_01."""

    value: int
    digits: int
    group: int = 0


class Code(str):
    """Source that is written as it is: a name, an expression."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Call:
    """A call with keyword arguments, always opened."""

    function: str
    arguments: Mapping[str, Any]


def literal(value: Any, indent: int = 0, used: int | str = 0) -> str:
    """A value as source. `indent` is that of its line, `used` what already stands on that line."""
    room = WIDTH - indent - (used if isinstance(used, int) else len(used)) - 1  # 1 for the comma that follows
    flat = _flat(value, room)
    if flat is not None:
        return flat
    if isinstance(value, Call):
        arguments = (
            f"{name}={literal(argument, indent + 4, len(name) + 1)}" for name, argument in value.arguments.items()
        )
        return _opened(f"{value.function}(", arguments, ")", indent)
    if isinstance(value, dict):
        keys = ((_flat(key, _ENDLESS) or "", item) for key, item in value.items())
        items = (f"{key}: {literal(item, indent + 4, len(key) + 2)}" for key, item in keys)
        return _opened("{", items, "}", indent)
    if isinstance(value, tuple):
        return _opened("(", (literal(item, indent + 4) for item in value), ")", indent)
    whole, room = string(value), WIDTH - indent - 4
    parts = [whole] if len(whole) <= room else [string(part) for part in _split(value, room)]
    lines = "".join(f"{' ' * (indent + 4)}{part}\n" for part in parts)
    return f"(\n{lines}{' ' * indent})"


def _opened(start: str, items: Iterable[str], end: str, indent: int) -> str:
    lines = "".join(f"{' ' * (indent + 4)}{item},\n" for item in items)
    return f"{start}\n{lines}{' ' * indent}{end}" if lines else start + end


def _flat(value: Any, room: int) -> str | None:
    """The value on one line, if it has at most `room` columns; None for what does not or is always opened."""
    if type(value) is str:
        flat = string(value)
        return flat if len(flat) <= room else None
    if isinstance(value, tuple):
        return _flat_tuple(value, room)
    if isinstance(value, Hex):
        digits = f"{value.value:0{value.digits}X}"
        return f"0x{digits[: -value.group]}_{digits[-value.group :]}" if value.group else f"0x{digits}"
    if isinstance(value, Call):
        return None
    if isinstance(value, dict):
        return None if value else "{}"
    if isinstance(value, Code):
        return str(value)
    if value is None or isinstance(value, int):
        return repr(value)
    raise TypeError(f"{value!r} cannot be written as a literal")


def _flat_tuple(items: tuple[Any, ...], room: int) -> str | None:
    parts, left = [], room - 2
    for item in items:
        part = _flat(item, left)
        if part is None:
            return None
        parts.append(part)
        left -= len(part) + 2
    flat = f"({', '.join(parts)}{',' * (len(items) == 1)})"
    return flat if len(flat) <= room else None


def string(text: str) -> str:
    """A string literal, with the quotes that need fewer escapes, double ones where that does not matter."""
    if text.isascii() and text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'  # by far the most, and nothing in them to escape
    safe = escape.py_string(text)
    if safe.startswith("'") and "'" in text and text.count('"') <= text.count("'"):
        return '"' + safe[1:-1].replace("\\'", "'").replace('"', '\\"') + '"'
    return safe


def _split(text: str, width: int) -> list[str]:
    """Cut a text, behind blanks where it can be, into parts that are at most `width` wide as literals."""
    parts, part = [], ""
    for word in re.findall(r"\S+\s*|\s+", text):
        if part and len(string(part + word)) > width:
            parts.append(part)
            part = ""
        for char in word if len(string(word)) > width else (word,):
            if part and len(string(part + char)) > width:
                parts.append(part)
                part = ""
            part += char
    return [*parts, part] if part else parts


def docstring(paragraphs: str | Iterable[str], indent: int = 0) -> str:
    """A docstring, quotes included, of one line where it fits; the first paragraph is the summary."""
    texts = [paragraphs] if isinstance(paragraphs, str) else list(paragraphs)
    safe = [text for text in map(escape.docstring, texts) if text]
    margin = " " * indent
    if len(safe) == 1 and indent + len(safe[0]) + 6 <= WIDTH:
        return f'"""{safe[0]}"""'
    wrapped = [f"\n{margin}".join(_lines(text, WIDTH - indent - 3 * (text is safe[0]))) for text in safe]
    return '"""' + f"\n\n{margin}".join(wrapped) + f'\n{margin}"""'


def _lines(text: str, width: int) -> list[str]:
    return [text] if len(text) <= width else escape.wrap(text, width)


def assignment(name: str, values: tuple[Any, ...], indent: int) -> str:
    """`NAME = 1, "text"`: a member of an enumeration."""
    flat = _flat(values, WIDTH - indent - len(name) - 1)  # as long as with the parentheses left out
    return f"{name} = {flat[1:-1]}" if flat else f"{name} = {literal(values, indent, WIDTH)}"


def declaration(name: str, annotation: tuple[str, str], call: tuple[str, str], indent: int) -> str:
    """`name: Variable[int] = Variable(0x6040)` from ("Variable", "int") and ("Variable", "0x6040")."""
    head, value = f"{name}: {annotation[0]}[{annotation[1]}] = ", f"{call[0]}({call[1]})"
    inner, outer = "\n" + " " * (indent + 4), "\n" + " " * indent
    if indent + len(head + value) <= WIDTH:
        return head + value
    if indent + len(head + call[0]) + 1 <= WIDTH:
        arguments = call[1].replace(", ", f",{inner}")
        return f"{head}{call[0]}({inner}{arguments},{outer})"
    if indent + len(head) + 1 <= WIDTH:
        return f"{head}({inner}{value}{outer})"
    return f"{name}: {annotation[0]}[{inner}{annotation[1]}{outer}] = {value}"


def reexports(modules: Mapping[str, Iterable[str]], indent: int) -> list[str]:
    """`from .enums import ChopperMode as ChopperMode`, sorted as ruff sorts imports."""
    lines = []
    for module in sorted(modules):
        for name in sorted(modules[module], key=_import_order):
            line = f"from .{module} import {name} as {name}"
            if indent + len(line) > WIDTH:
                line = _opened(f"from .{module} import (", [f"{name} as {name}"], ")", indent)
            lines.append(line)
    return lines


def _import_order(name: str) -> tuple[int, list[tuple[int, str]], list[tuple[int, str]]]:
    """Constants, classes, functions; each alphabetically, numbers by their value."""
    kind = 0 if name.isupper() and len(name) > 1 else 1 if name[0].isupper() else 2
    return kind, _natural(name.lower()), _natural(name)


def _natural(text: str) -> list[tuple[int, str]]:
    return [(int(piece), "") if piece.isdigit() else (-1, piece) for piece in re.findall(r"\d+|\D", text)]
