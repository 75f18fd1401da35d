"""What the rules look at: a file, its dictionary and its axes, and how a finding about them is written."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from odsmith.canopen_types import Place
from odsmith.eds_axes import Axes, find_axes
from odsmith.eds_dictionary import EdsDictionary, EdsEntry, EdsObject, dictionary
from odsmith.eds_file import EdsFile, Key, Section
from odsmith.errors import Diagnostic, Fix
from odsmith.rules import diagnose

Note = tuple[Place, str]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A data sheet under examination."""

    file: EdsFile
    dictionary: EdsDictionary
    axes: Axes

    @property
    def dcf(self) -> bool:
        """The file configures one device instead of describing a type of devices."""
        return self.file.path.lower().endswith(".dcf") or self.file.section("DeviceComissioning") is not None

    # ---- paths and names ---------------------------------------------------------------------------------------

    def path(self, index: int, sub: int | None = None) -> str:
        """The path of an object or entry: `6212.axes.607D:1` whichever axis it is on, `6212.1018:2` for the device."""
        first, axis = self.axes.fold(index)
        parts = [self.dictionary.device, *(["axes"] if axis is not None else []), f"{first:04X}"]
        return ".".join(part for part in parts if part) + (f":{sub:X}" if sub is not None else "")

    def path_of(self, item: EdsEntry | EdsObject | None) -> str:
        if item is None:
            return ""
        if isinstance(item, EdsObject) or self.dictionary.objects[item.index].variable:
            return self.path(item.index)
        return self.path(item.index, item.sub)

    def name_of(self, item: EdsEntry | EdsObject) -> str:
        """How a message calls it: `787Dh:1`."""
        if isinstance(item, EdsObject) or self.dictionary.objects[item.index].variable:
            return f"{item.index:04X}h"
        return f"{item.index:04X}h:{item.sub:X}"

    # ---- findings ------------------------------------------------------------------------------------------------

    def at_value(
        self,
        rule: str,
        key: Key,
        message: str,
        about: EdsEntry | EdsObject | None = None,
        *,
        value: str | None = None,
        hint: str = "",
        notes: tuple[Note, ...] = (),
        fix: Fix | None = None,
    ) -> Diagnostic:
        """A finding at the value of a key, or at the key if the value is empty. `value` is what it ought to be."""
        column, length = (key.value_column, len(key.value)) if key.value else (key.column, len(key.name))
        if value is not None:
            fix = replace(key, value)
        place = self.file.place(key.line, column)
        return diagnose(rule, place, message, hint, length, notes, self.path_of(about), fix)

    def at_key(
        self,
        rule: str,
        key: Key,
        message: str,
        about: EdsEntry | EdsObject | None = None,
        *,
        hint: str = "",
        notes: tuple[Note, ...] = (),
        fix: Fix | None = None,
    ) -> Diagnostic:
        """A finding at the name of a key."""
        place = self.file.place(key.line, key.column)
        return diagnose(rule, place, message, hint, len(key.name), notes, self.path_of(about), fix)

    def at_section(
        self,
        rule: str,
        section: Section | None,
        message: str,
        about: EdsEntry | EdsObject | str | None = None,
        *,
        hint: str = "",
        notes: tuple[Note, ...] = (),
        fix: Fix | None = None,
    ) -> Diagnostic:
        """A finding at the heading of a section, or about the whole file. `about` may be a path already."""
        place = self.file.place(section.line, section.column) if section else self.file.place(0, 0)
        subject = about if isinstance(about, str) else self.path_of(about)
        return diagnose(rule, place, message, hint, len(section.name) + 2 if section else 0, notes, subject, fix)

    def at_line(
        self, rule: str, line: int, message: str, *, column: int = 1, length: int = 1, fix: Fix | None = None
    ) -> Diagnostic:
        """A finding at a place in a line."""
        return diagnose(rule, self.file.place(line, column), message, length=length, fix=fix)

    def place_of(self, item: Key | Section) -> Place:
        return self.file.place(item.line, item.value_column if isinstance(item, Key) else item.column)


Rule = Callable[[Sheet], Iterator[Diagnostic]]
"""Looks at a sheet for one thing that may be wrong with it."""


def sheet(file: EdsFile) -> Sheet:
    """The sheet that a file is."""
    objects = dictionary(file)
    return Sheet(file, objects, find_axes(objects.objects))


# ---- proposals ---------------------------------------------------------------------------------------------------


def replace(key: Key, value: str) -> Fix:
    """The line of a key with another value."""
    return Fix(key.line, key.line, (f"{key.name}={value}",))


def delete(key: Key) -> Fix:
    return Fix(key.line, key.line, ())


def append(section: Section, line: str) -> Fix:
    """One more line at the end of a section."""
    return Fix(section.end + 1, section.end, (line,))
