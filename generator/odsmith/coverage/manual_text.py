"""Reads the text of a manual: its list of contents, and its tables.

The layout is what text extraction makes of the manuals: in a table the cells of a row stand on one line with tabs
between them, and the caption `Table 7: Object Description (1000h)` follows the last row. A subscript h comes as `_h`.
Everything else is prose and is skipped. A text whose tables have lost their tabs still has captions and contents.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from odsmith.canopen_types import Place
from odsmith.errors import UsageError
from odsmith.manual import section_key

_CAPTION = re.compile(r"Table (\d+): (.*)")
_HEADING = re.compile(r"(\d+(?:\.\d+)*) (\S.*)")
_CONTENTS = re.compile(r"(\d+(?:\.\d+)*)[\t ]+(.*?)[\t .]*?[\t .](\d+)")
_SUBSCRIPT = re.compile(r"\s*_(?:\{h\}|h\b)")
_INDEX = re.compile(r"\(?\b([0-9A-F]{4})\)?h\b")
_MODE = re.compile(r"\bin (\w+) Mode\b")


@dataclass(frozen=True, slots=True)
class TextCell:
    """A cell as it is printed, its subscripts written out; `place` is where it begins."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table of the text. `heading` is the title of its section, `place` where its caption stands."""

    number: int
    caption: str
    heading: str
    rows: tuple[tuple[TextCell, ...], ...]
    place: Place

    @property
    def index(self) -> int | None:
        """The index of the object that the caption is about, or else the heading."""
        match = _INDEX.search(self.caption) or _INDEX.search(self.heading)
        return int(match[1], 16) if match else None

    @property
    def about_one_object(self) -> bool:
        """True if the caption itself names the object."""
        return _INDEX.search(self.caption) is not None

    @property
    def mode(self) -> str:
        """Short name of the mode of operation that the caption is about, or nothing."""
        match = _MODE.search(self.caption)
        return match[1] if match else ""

    def body(self, *heading: str, width: int = 2) -> tuple[tuple[TextCell, ...], ...]:
        """The rows below the one that begins with these cells, none shorter than that or than `width`; nothing if it
        is not there.

        A table that was broken over pages repeats its heading, which does not count.
        """
        start = next((i for i, row in enumerate(self.rows) if _begins(row, heading)), None)
        if start is None:
            return ()
        width = max(width, len(self.rows[start]))
        return tuple(_padded(row, width) for row in self.rows[start + 1 :] if not _begins(row, heading))

    def heads(self, *heading: str) -> tuple[str, ...]:
        """The whole row that begins with these cells; nothing if there is none."""
        return next((tuple(cell.text for cell in row) for row in self.rows if _begins(row, heading)), ())


@dataclass(frozen=True, slots=True)
class ManualText:
    """`title` is the first line, `contents` the sections that the list of contents names, `text` all of it."""

    path: str
    title: str
    contents: Mapping[str, str]
    tables: Mapping[int, TextTable]
    text: str


def read_manual(path: Path) -> ManualText:
    """Read the text of a manual. Raises OSError, and UsageError where it is none."""
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is no UTF-8 text", "extract the text of the manual first") from error
    lines = text.split("\n")
    title = next((line.strip() for line in lines if line.strip()), "")
    contents = _contents(lines)
    tables = {table.number: table for table in _tables(lines, str(path), contents)}
    if not tables:
        raise UsageError(f"{path} has no captions of tables", "a caption is a line such as `Table 7: Title`")
    return ManualText(str(path), title, contents, tables, text)


def clean(text: str) -> str:
    """A text as the manual means it: `1000 _h` is 1000h."""
    return _SUBSCRIPT.sub("h", text).strip()


def _contents(lines: Sequence[str]) -> dict[str, str]:
    """The list of contents: lines with a section number, a title and a page, as long as the numbers ascend."""
    found: dict[str, str] = {}
    last: tuple[int, ...] = ()
    for line in lines:
        match = _CONTENTS.fullmatch(line.strip())
        if not match:
            continue
        key = section_key(match[1])
        if not last and key != (1,):
            continue
        if key <= last:
            break
        last = key
        found[match[1]] = clean(match[2])
    return found


def _tables(lines: Sequence[str], path: str, contents: Mapping[str, str]) -> Iterator[TextTable]:
    rows: list[tuple[TextCell, ...]] = []
    heading = ""
    for number, line in enumerate(lines, 1):
        caption = _CAPTION.fullmatch(line.strip())
        if caption:
            place = Place(path, number, 1)
            yield TextTable(int(caption[1]), clean(caption[2]), heading, tuple(rows), place)
            rows = []
        elif "\t" in line:
            rows.append(tuple(_cells(line, path, number)))
        elif (opened := _HEADING.fullmatch(line)) and opened[1] in contents:
            heading, rows = contents[opened[1]], []


def _cells(line: str, path: str, number: int) -> Iterator[TextCell]:
    column = 1
    for part in line.split("\t"):
        yield TextCell(clean(part), Place(path, number, column + len(part) - len(part.lstrip())))
        column += len(part) + 1


def _padded(row: tuple[TextCell, ...], width: int) -> tuple[TextCell, ...]:
    return (*row, *(TextCell("", row[-1].place) for _ in range(width - len(row))))


def _begins(row: Sequence[TextCell], heading: Sequence[str]) -> bool:
    return len(row) >= len(heading) and all(
        cell.text.casefold() == word.casefold() for cell, word in zip(row, heading, strict=False)
    )
