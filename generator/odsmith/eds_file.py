"""Reads EDS and DCF files (CiA 306-1): their sections and keys, each with its place, whatever the file looks like.

This is the only reader of such files. It judges nothing: garbage becomes lines without meaning, a repeated section
stays in the list, and every text is kept as it was spelt. `eds_dictionary` makes objects of the sections, `lint` says
what is wrong with them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from odsmith.canopen_types import Place
from odsmith.errors import SpecError, quoted, shown_path
from odsmith.rules import diagnose

MAX_BYTES = 16 * 1024 * 1024
"""The largest EDS files, of modular devices, have two or three megabytes."""

SUFFIXES = (".eds", ".dcf")

BYTE_ORDER_MARK = b"\xef\xbb\xbf"

_LINE_END = re.compile("\r\n|\n|\r")

# What `errors.split_lines` takes for the end of a line, but no reader of EDS files does.
_FOREIGN_LINE_END = re.compile("[\x85\u2028\u2029]")

_MARKS_AN_EDS = re.compile(
    r"\[\s*(?:FileInfo|Device\s*Info|DeviceComm?issioning|DummyUsage|(?:Mandatory|Optional|Manufacturer)\s*Objects"
    r"|[0-9A-F]{4}(?:\s*sub\s*[0-9A-F]{1,2})?)\s*\]",
    re.IGNORECASE,
)


class Key(NamedTuple):
    """A line `name=value`, without the blanks around the two. Line and columns count from 1."""

    name: str
    value: str
    line: int
    column: int
    value_column: int


@dataclass(frozen=True, slots=True)
class Section:
    """A section and its keys in the order of the file. `line` is that of its heading, `end` its last line."""

    name: str
    line: int
    column: int
    keys: tuple[Key, ...]
    end: int
    _by_name: Mapping[str, Key] = field(repr=False, compare=False)

    def get(self, name: str) -> Key | None:
        """The first key of this name, which readers compare without regard to case."""
        return self._by_name.get(name.lower())

    @property
    def repeats(self) -> bool:
        """A key is there more than once."""
        return len(self._by_name) < len(self.keys)

    def value(self, name: str) -> str:
        """The value of a key; empty if it is not there."""
        key = self._by_name.get(name.lower())
        return key.value if key else ""


@dataclass(frozen=True, slots=True)
class EdsFile:
    """A file as its lines say it is. `comments` and `strays` are line numbers; a stray line is none of the known kinds.

    Lines and columns count characters of `lines`, which have neither a byte order mark nor line ends.
    """

    path: str
    data: bytes
    lines: tuple[str, ...]
    sections: tuple[Section, ...]
    comments: tuple[int, ...]
    strays: tuple[int, ...]
    _by_name: Mapping[str, Section] = field(repr=False, compare=False)

    def section(self, name: str) -> Section | None:
        """The first section of this name, without regard to case and blanks."""
        return self._by_name.get(plain_name(name))

    def place(self, line: int, column: int = 1) -> Place:
        return Place(self.path, line, column)

    @property
    def text(self) -> str:
        """The text for the display of findings: its lines are those that findings count."""
        return _FOREIGN_LINE_END.sub("\ufffd", "\n".join(self.lines))


def plain_name(name: str) -> str:
    """The name of a section as it is compared: without case and blanks."""
    return "".join(name.split()).lower()


def is_eds(path: Path) -> bool:
    """True for a file that its name calls an EDS or a DCF."""
    return path.suffix.lower() in SUFFIXES


def read(path: Path) -> EdsFile:
    """Read a file. Raises SpecError if it is missing, a folder, too large, binary, or no EDS at all."""
    data = _content(path)
    eds = parse(data, str(path))
    if b"\0" in data or data.startswith((b"\xff\xfe", b"\xfe\xff")):
        what = "is UTF-16" if data.startswith((b"\xff\xfe", b"\xfe\xff")) else "is binary"
        raise _failure("E103", path, f"{_called(path)} {what}", "an EDS is a text in ASCII")
    if not any(_MARKS_AN_EDS.match(line.lstrip()) for line in eds.lines):
        raise _failure("L100", path, f"{_called(path)} has none of the sections of an EDS or a DCF")
    return eds


def _content(path: Path) -> bytes:
    data = b""
    try:
        if path.is_dir():
            reason = "is a folder, not a file"
        elif not path.is_file():
            reason = "is not a file" if path.exists() else "does not exist"
        else:
            reason = ""
            with path.open("rb") as stream:
                data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:  # a name with a NUL byte is a ValueError
        reason = f"cannot be read: {(getattr(error, 'strerror', None) or str(error)).lower()}"
    if reason:
        raise _failure("E101", path, f"{_called(path)} {reason}")
    if len(data) > MAX_BYTES:
        raise _failure(
            "E102", path, f"{_called(path)} is larger than {MAX_BYTES // (1024 * 1024)} MB", "no EDS is that large"
        )
    return data


def _called(path: Path) -> str:
    return quoted(shown_path(str(path)))


def _failure(rule: str, path: Path, message: str, hint: str = "") -> SpecError:
    return SpecError([diagnose(rule, Place(str(path), 0, 0), message, hint)])


def parse(data: bytes, path: str) -> EdsFile:
    """The sections of a file's content; `path` is the name that places carry. Never fails."""
    lines = tuple(_LINE_END.split(_decode(data)))
    comments: list[int] = []
    strays: list[int] = []
    sections: list[Section] = []
    heading: tuple[str, int, int] | None = None
    keys: list[Key] = []
    last = 0
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text:
            continue
        first = text[0]
        if first == "[":
            if heading:
                sections.append(_section(heading, keys, last))
            heading, keys = (_heading(text), number, 1 + line.index("[")), []
        elif first in ";#":
            comments.append(number)
            continue
        elif heading is None or "=" not in text or first == "=":
            strays.append(number)
            continue
        else:
            keys.append(_key(line, number))
        last = number
    if heading:
        sections.append(_section(heading, keys, last))
    by_name = {plain_name(section.name): section for section in reversed(sections)}
    return EdsFile(path, data, lines, tuple(sections), tuple(comments), tuple(strays), by_name)


def _decode(data: bytes) -> str:
    """The text. What is no UTF-8 was most likely written on Windows."""
    data = data.removeprefix(BYTE_ORDER_MARK)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def _heading(text: str) -> str:
    """The name between the brackets, blanks included; the rest of the line if the bracket is never closed."""
    end = text.rfind("]")
    return text[1:end] if end > 0 else text[1:]


def _key(line: str, number: int) -> Key:
    before, _, after = line.partition("=")
    name, value = before.strip(), after.strip()
    if len(name) + 1 + len(value) == len(line):  # nearly always
        return Key(name, value, number, 1, len(name) + 2)
    column = 1 + len(before) - len(before.lstrip())
    value_column = 2 + len(before) + len(after) - len(after.lstrip())
    return Key(name, value, number, column, value_column)


def _section(heading: tuple[str, int, int], keys: list[Key], end: int) -> Section:
    name, line, column = heading
    return Section(name, line, column, tuple(keys), end, {key.name.lower(): key for key in reversed(keys)})
