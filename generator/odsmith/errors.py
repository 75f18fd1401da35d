"""What is wrong with a specification, and how it is shown: one diagnostic for each mistake, with place and hint.

A specification is untrusted text. Whatever of it gets into a message passes `visible`, so that it can neither
move a terminal's cursor nor swap the direction of the line.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from odsmith.canopen_types import Place

Severity = Literal["error", "warning", "note"]

WINDOW = 100
"""Columns of a source line that are shown; a longer one is cut around the caret."""

_CUT = "..."

# libyaml ends a line at each of these and at nothing else; str.splitlines knows more of them.
_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")

# The token that begins at a place: quoted text, a plain scalar up to what can end one, or a single character.
_TOKEN = re.compile(
    r""" "(?:[^"\\]|\\.)*"? | '(?:[^']|'')*'? | [^\s,\[\]{}"'\#:](?:(?!:\s|:$|\s\#|[,\[\]{}]).)* | . """, re.VERBOSE
)


@dataclass(frozen=True, slots=True)
class Fix:
    """A proposed change: lines `first` to `last` of the file become `lines`.

    Without `lines` they are deleted; with a `last` before `first` the lines are inserted before line `first`.
    """

    first: int
    last: int
    lines: tuple[str, ...]

    def __str__(self) -> str:
        if not self.lines:
            return "delete the line"
        return ("insert " if self.last < self.first else "") + " / ".join(self.lines)

    def to_json(self) -> dict[str, Any]:
        return {"first": self.first, "last": self.last, "lines": list(self.lines)}


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    `message` is a sentence without its full stop. `length` is the number of characters to underline, 0 for the
    token that begins at `place`. A `place` with line 0 stands for the file as a whole. `notes` are further places
    that belong to it, such as the first definition of something defined twice. `subject` is the path of the object
    of a dictionary that it is about, such as `6212.axes.607D:1`; `fix` a change that would mend it.
    """

    rule: str
    severity: Severity
    message: str
    place: Place
    length: int = 0
    hint: str = ""
    notes: tuple[tuple[Place, str], ...] = ()
    subject: str = ""
    fix: Fix | None = None

    def to_json(self) -> dict[str, Any]:
        """The diagnostic as plain data: places as path, line and column, lines and columns from 1."""
        return {
            "rule": self.rule,
            "severity": self.severity,
            "message": self.message,
            **_place_json(self.place),
            "length": self.length,
            "object": self.subject,
            "hint": self.hint,
            "fix": self.fix.to_json() if self.fix else None,
            "notes": [{**_place_json(place), "message": text} for place, text in self.notes],
        }


class SpecError(Exception):
    """A specification cannot be used. Carries every finding of the phase that stopped, in the order of the source.

    `texts` has the raw text of the files concerned by path, as far as they could be read; whoever reports the error
    may fill it in.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic], texts: Mapping[str, str] | None = None) -> None:
        self.diagnostics = in_order(diagnostics)
        self.texts: Mapping[str, str] = texts or {}
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        lines = SourceLines(self.texts)
        return "\n".join(format_diagnostic(item, lines) for item in self.diagnostics)


class UsageError(Exception):
    """A request that cannot be carried out; `hint` is the remedy."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


class SourceLines:
    """The lines of source files, split when they are first asked for: `lines(path)`, empty for an unknown path."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self._texts = texts
        self._lines: dict[str, Sequence[str]] = {}

    def __call__(self, path: str) -> Sequence[str]:
        if path not in self._lines:
            self._lines[path] = split_lines(self._texts[path]) if path in self._texts else ()
        return self._lines[path]


def split_lines(text: str) -> list[str]:
    """The lines of a source text, numbered as libyaml numbers them."""
    return _LINE_END.split(text)


def in_order(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Each diagnostic once, by path, line, column and rule."""
    return tuple(
        sorted(
            dict.fromkeys(diagnostics),
            key=lambda item: (item.place.path, item.place.line, item.place.column, item.rule, item.message),
        )
    )


def format_diagnostic(diagnostic: Diagnostic, source_lines: Callable[[str], Sequence[str]]) -> str:
    """The diagnostic as text without a newline at its end; `source_lines` gives the lines of a path.

    A line `path:line:col: error[E123]: sentence`, the source line with a caret line below, then the object, the hint,
    the fix and the notes. Parts that are not known are left out.
    """
    heading = f"{diagnostic.severity}[{diagnostic.rule}]: {visible(diagnostic.message)}"
    lines = [f"{shown_place(diagnostic.place)}: {heading}"]
    lines += _excerpt(diagnostic.place, diagnostic.length, source_lines)
    if diagnostic.subject:
        lines.append(f"object: {visible(diagnostic.subject)}")
    if diagnostic.hint:
        lines.append(f"hint: {visible(diagnostic.hint)}")
    if diagnostic.fix:
        lines.append(f"fix: {visible(str(diagnostic.fix))}")
    for place, text in diagnostic.notes:
        lines.append(f"{shown_place(place)}: note: {visible(text)}")
        lines += _excerpt(place, 0, source_lines)
    return "\n".join(lines)


def shown_path(path: str) -> str:
    """A path as users want to read it: relative to the current directory where it is below it."""
    try:
        inside = Path(path).is_absolute() and Path(path).is_relative_to(Path.cwd())
        return Path(path).relative_to(Path.cwd()).as_posix() if inside else path
    except (OSError, ValueError):
        return path


def shown_place(place: Place) -> str:
    """`path:line:column`, or the path alone for a whole file."""
    path = visible(shown_path(place.path))
    return f"{path}:{place.line}:{place.column}" if place.line else path


def visible(text: str) -> str:
    """The text with tabs, control, format and other unprintable characters written as escapes."""
    return text if text.isprintable() else "".join(map(_visible_character, text))


def quoted(value: object) -> str:
    """A value of the specification for use in a message: in backquotes, as YAML writes it, cut if it is long."""
    shown = visible("null" if value is None else str(value).lower() if isinstance(value, bool) else str(value))
    return f"`{shown if len(shown) <= 60 else shown[:57] + _CUT}`"


def listed(words: Iterable[str], last: str = "or") -> str:
    """Words as a sentence has them: `a`, `b` or `c`."""
    names = [quoted(word) for word in words]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {last} {names[-1]}" if names else "nothing"


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """A hint that names the most similar of the words, or nothing if none is similar."""
    if len(word) > 60:  # the comparison takes quadratic time, and nobody misspells such a word
        return ""
    from difflib import get_close_matches  # only a wrong specification needs it

    near = get_close_matches(word, list(words), 1, 0.6)
    return f"did you mean {quoted(near[0])}?" if near else ""


def _place_json(place: Place) -> dict[str, str | int]:
    return {"path": shown_path(place.path), "line": place.line, "column": place.column}


def _excerpt(place: Place, length: int, source_lines: Callable[[str], Sequence[str]]) -> list[str]:
    """The source line of a place and a caret line; nothing if the line is unknown or blank."""
    lines = source_lines(place.path) if place.line else ()
    if not 0 < place.line <= len(lines):
        return []
    line = lines[place.line - 1]
    if not line.strip():
        return []
    start = min(max(place.column, 1) - 1, len(line))
    if not length:
        token = _TOKEN.match(line, start)
        length = len(token.group().rstrip()) if token else 1
    end = min(start + max(length, 1), max(len(line), start + 1))
    first = 0 if len(line) <= WINDOW else max(0, min(start - WINDOW // 3, len(line) - WINDOW))
    last = min(len(line), first + WINDOW)
    before = (_CUT if first else "") + visible(line[first:start])
    marked = visible(line[start : min(end, last)])
    after = visible(line[min(end, last) : last]) + (_CUT if last < len(line) else "")
    caret = " " * _columns(before) + "^" + "~" * (_columns(marked) - 1)
    return [f"    {before}{marked}{after}".rstrip(), f"    {caret}"]


def _visible_character(character: str) -> str:
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")


def _columns(text: str) -> int:
    """Columns that a terminal gives to printable text: two for a wide character, none for a combining one."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(character) else 1 + (unicodedata.east_asian_width(character) in "WF")
        for character in text
    )
