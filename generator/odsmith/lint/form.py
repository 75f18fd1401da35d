"""The text of the file: bytes, lines and spelling that one reader or another stumbles over (CiA 306-1, clause 4)."""

from __future__ import annotations

import re
from collections.abc import Iterator

from odsmith.eds_file import BYTE_ORDER_MARK, Key, plain_name
from odsmith.errors import Diagnostic, Fix, quoted
from odsmith.lint.sheet import Sheet

LINE_LENGTH = 255
"""Longest line of an EDS, line end left out (CiA 306-1)."""

_NOT_PRINTABLE = re.compile(r"[^\x20-\x7e]")
_NOT_CRLF = re.compile(rb"(?<!\r)\n|\r(?!\n)")
_COMMENT_SIGN = re.compile(r"(?:^|\s)[;#]")


def _byte_order_mark(sheet: Sheet) -> Iterator[Diagnostic]:
    if sheet.file.data.startswith(BYTE_ORDER_MARK):
        yield sheet.at_line("L101", 1, "the file begins with a byte order mark", fix=Fix(1, 1, sheet.file.lines[:1]))


def _beginning(sheet: Sheet) -> Iterator[Diagnostic]:
    first = sheet.file.section("FileInfo")
    if first and first.line > 1:
        line = next(number for number, line in enumerate(sheet.file.lines, 1) if line.strip())
        yield sheet.at_line(
            "L102", line, f"[FileInfo] begins in line {first.line}", length=len(sheet.file.lines[line - 1])
        )


def _characters(sheet: Sheet) -> Iterator[Diagnostic]:
    if sheet.file.data.isascii() and not _NOT_PRINTABLE.search("".join(sheet.file.lines)):
        return
    for number, line in enumerate(sheet.file.lines, 1):
        found = _NOT_PRINTABLE.search(line.replace("\t", " "))  # a tab counts as a blank, see below
        if found:
            code = f"U+{ord(found[0]):04X}"
            yield sheet.at_line("L103", number, f"{code} is no printable ASCII character", column=found.start() + 1)


def _line_ends(sheet: Sheet) -> Iterator[Diagnostic]:
    data = sheet.file.data
    wrong = data.count(b"\n") + data.count(b"\r") - 2 * data.count(b"\r\n")
    if wrong:
        first = _NOT_CRLF.search(data)
        before = data[: first.start()] if first else b""
        line = before.count(b"\r\n") + 1
        count = "1 line ends" if wrong == 1 else f"{wrong} lines end"
        yield sheet.at_line("L104", line, f"{count} without CRLF, this one first", length=0)


def _last_line(sheet: Sheet) -> Iterator[Diagnostic]:
    lines = sheet.file.lines
    if lines[-1]:
        yield sheet.at_line("L105", len(lines), "the last line does not end", length=len(lines[-1]))


def _length(sheet: Sheet) -> Iterator[Diagnostic]:
    if max(map(len, sheet.file.lines)) <= LINE_LENGTH:
        return
    for number, line in enumerate(sheet.file.lines, 1):
        if len(line) > LINE_LENGTH:
            message = f"the line has {len(line)} characters, {LINE_LENGTH} are allowed"
            yield sheet.at_line("L106", number, message, column=LINE_LENGTH + 1, length=len(line) - LINE_LENGTH)


def _comments(sheet: Sheet) -> Iterator[Diagnostic]:
    """What stands before the first section is no matter of this rule but of L102."""
    start = sheet.file.sections[0].line if sheet.file.sections else 0
    for number in sheet.file.comments:
        if number > start:
            length = len(sheet.file.lines[number - 1])
            yield sheet.at_line(
                "L107", number, "a comment outside [Comments]", length=length, fix=Fix(number, number, ())
            )


def _strays(sheet: Sheet) -> Iterator[Diagnostic]:
    for number in sheet.file.strays:
        line = sheet.file.lines[number - 1]
        yield sheet.at_line("L108", number, f"{quoted(line.strip())} is neither a section nor a key", length=len(line))


def _blanks(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.file.sections:
        line = sheet.file.lines[section.line - 1]
        if line != line.strip():
            yield sheet.at_line("L109", section.line, "blanks around a section", fix=_line(section.line, line.strip()))
        for key in section.keys:
            spelt = f"{key.name}={key.value}"
            if sheet.file.lines[key.line - 1] != spelt:
                yield sheet.at_key("L109", key, "blanks around the key or its value", fix=_line(key.line, spelt))


def _headings(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.file.sections:
        line = sheet.file.lines[section.line - 1].strip()
        if line != f"[{section.name}]":
            what = "is followed by other text" if "]" in line else "is not closed"
            name = quoted(f"[{section.name}")
            yield sheet.at_section(
                "L110", section, f"the section {name} {what}", fix=_line(section.line, f"[{section.name}]")
            )


def _comment_signs(sheet: Sheet) -> Iterator[Diagnostic]:
    if b";" not in sheet.file.data and b"#" not in sheet.file.data:
        return
    for key in _keys(sheet, but="Comments"):
        if _COMMENT_SIGN.search(key.value):
            yield sheet.at_value("L111", key, "some readers take the rest of the value for a comment")


def _equals_signs(sheet: Sheet) -> Iterator[Diagnostic]:
    for key in _keys(sheet):
        if "=" in key.value:
            yield sheet.at_value("L112", key, "a second equals sign")


def _keys(sheet: Sheet, but: str = "") -> Iterator[Key]:
    for section in sheet.file.sections:
        if not but or plain_name(section.name) != but.lower():
            yield from section.keys


def _keys_once(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.file.sections:
        for key in section.keys if section.repeats else ():
            first = section.get(key.name)
            if first and first is not key:
                note = (sheet.place_of(first), "first given here")
                yield sheet.at_key("L113", key, f"{quoted(key.name)} is given twice", notes=(note,))


def _sections_once(sheet: Sheet) -> Iterator[Diagnostic]:
    for section in sheet.file.sections:
        first = sheet.file.section(section.name)
        if first and first is not section:
            note = (sheet.place_of(first), "first given here")
            yield sheet.at_section("L114", section, f"the section {quoted(section.name)} is given twice", notes=(note,))


def _line(number: int, text: str) -> Fix:
    return Fix(number, number, (text,))


RULES = (
    _byte_order_mark,
    _beginning,
    _characters,
    _line_ends,
    _last_line,
    _length,
    _comments,
    _strays,
    _blanks,
    _headings,
    _comment_signs,
    _equals_signs,
    _keys_once,
    _sections_once,
)
