"""The account: for each section and table of a manual the elements that model it, or the reason why none does."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeVar

from odsmith.canopen_types import Source
from odsmith.coverage.elements import Element, elements
from odsmith.errors import Diagnostic
from odsmith.manual import Manual, WithoutFacts, section_numbers
from odsmith.model import Device
from odsmith.rules import diagnose

K = TypeVar("K", str, int)

FEW = 3
"""So many elements of a kind are named, of more it is said how many there are."""


class Status(StrEnum):
    """What became of a section or table."""

    MODELLED = "modelled"
    WITHOUT_FACTS = "without facts"
    BELOW = "in its sections"
    """A heading: all sections below it are accounted for."""
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Line:
    """A section or table of the manual. Errata stand apart: they say what the manual does not.

    `listed` is the entry of the manual's list that says why it holds no facts, if there is one.
    """

    number: str
    title: str
    status: Status
    elements: tuple[Element, ...]
    errata: tuple[Element, ...]
    listed: WithoutFacts | None = None


@dataclass(frozen=True, slots=True)
class Account:
    """A manual held against the model. `elements` are all that there are, `unsourced` those that cite nobody."""

    manual: Manual
    sections: tuple[Line, ...]
    tables: tuple[Line, ...]
    elements: tuple[Element, ...]
    unsourced: tuple[Element, ...]
    findings: tuple[Diagnostic, ...]


def covered(lines: Iterable[Line]) -> int:
    """How many are accounted for."""
    return sum(line.status is not Status.OPEN for line in lines)


def share(lines: Sequence[Line]) -> str:
    """`348 of 348 accounted for (100 %): 343 modelled, 5 without facts`."""
    counts = Counter(line.status for line in lines)
    parts = ", ".join(f"{counts[status]} {status}" for status in Status if counts[status])
    done = covered(lines)
    percent = 100 * done // len(lines) if lines else 100  # rounded down: 100 means all
    return f"{done} of {len(lines)} accounted for ({percent} %)" + (f": {parts}" if parts else "")


def account(device: Device, manual: Manual) -> Account:
    """Hold the sources of a device against the contents of its own manual."""
    found = tuple(elements(device))
    own = _Book(manual, own=True)
    family = _Book(device.manuals[manual.family], own=False) if manual.family else own
    books = {"own_manual": own, "manual": family}
    for item in found:
        for source in item.source:
            if source.kind in books:
                books[source.kind].cite(item, source)
    both = dict.fromkeys(books.values())
    restated = {item.path for book in both for item in book.restate(found)}
    sections = _headings(_lines(manual.sections, own.sections, manual.sections_there, family.sections))
    untitled = dict.fromkeys(range(1, manual.tables + 1), "")
    tables = tuple(_lines(untitled, own.tables, manual.tables_there, family.tables))
    unsourced = tuple(item for item in found if not item.source and item.path not in restated)
    findings = [
        *(finding for book in both for finding in book.findings),
        *_judge(manual, "table", tables, "E701"),
        *_judge(manual, "section", sections, "W702"),
        *(diagnose("W703", item.place, f"`{item.path}` does not say where it comes from") for item in unsourced),
    ]
    return Account(manual, sections, tables, found, unsourced, tuple(findings))


class _Entry:
    """What is known of one section or table: who cites it, and whether it is listed as without facts."""

    def __init__(self) -> None:
        self.citing: list[Element] = []
        self.listed: WithoutFacts | None = None


class _Book:
    """One manual with everybody who cites it, by the numbers that it has itself."""

    def __init__(self, manual: Manual, own: bool) -> None:
        self.manual = manual
        self.own = own  # else it is that of the family, not all of which every device has
        self.sections: defaultdict[str, _Entry] = defaultdict(_Entry)
        self.tables: defaultdict[int, _Entry] = defaultdict(_Entry)
        self.findings: list[Diagnostic] = []
        for listed in manual.without_facts:
            for entry in self._entries(listed.sections, listed.tables):
                entry.listed = listed

    def cite(self, item: Element, source: Source) -> None:
        """Take down that an element cites sections and tables of this manual."""
        try:
            sections = section_numbers(source.section)
        except ValueError as error:
            self._report(item, f"`{item.path}` cites a section of the manual: {error}")
            return
        for number in sections:
            if number not in self.manual.sections:
                self._report(item, f"`{item.path}` cites section {number}, which the manual does not have")
        for table in source.tables:
            if table > self.manual.tables and not self.manual.cut_off:
                self._report(item, f"`{item.path}` cites table {table}, which the manual does not have")
        for entry in self._entries(sections, source.tables):
            entry.citing.append(item)

    def restate(self, found: Iterable[Element]) -> Iterator[Element]:
        """Take down the elements that the manual's own list names, and return them."""
        for restated in self.manual.restated:
            for path in restated.paths:
                inside = [item for item in found if item.within(path)]
                if not inside and self.own:
                    message = f"`{path}` restates the manual, and there is no such element"
                    self.findings.append(diagnose("E702", restated.place, message))
                for entry in self._entries(restated.sections, restated.tables):
                    entry.citing += inside
                yield from inside

    def _entries(self, sections: Iterable[str], tables: Iterable[int]) -> Iterator[_Entry]:
        yield from (self.sections[number] for number in sections)
        yield from (self.tables[number] for number in tables)

    def _report(self, item: Element, message: str) -> None:
        self.findings.append(diagnose("E702", item.place, message))


def _lines(
    titles: Mapping[K, str], own: Mapping[K, _Entry], there: Mapping[K, K], family: Mapping[K, _Entry]
) -> Iterator[Line]:
    """A line for each number, from who cites it here, and who cites what is the same in the family's manual."""
    for number, title in titles.items():
        entries = [own[number]] if number in own else []
        if number in there and there[number] in family:
            entries.append(family[there[number]])
        models: dict[Element, None] = {}
        errata: dict[Element, None] = {}
        for entry in entries:
            for item in entry.citing:
                (errata if item.kind == "errata" else models)[item] = None
        listed = next((entry.listed for entry in entries if entry.listed), None)
        status = Status.MODELLED if models else Status.WITHOUT_FACTS if listed else Status.OPEN
        yield Line(str(number), title, status, tuple(models), tuple(errata), listed)


def _headings(lines: Iterable[Line]) -> tuple[Line, ...]:
    """A section that nobody cites is accounted for if it has sections and all of them are."""
    settled: list[Line] = []
    below: defaultdict[str, list[Line]] = defaultdict(list)
    for line in reversed(list(lines)):  # in the order of the document, so what is below comes before
        inside = below[line.number]
        if line.status is Status.OPEN and inside and covered(inside) == len(inside):
            line = replace(line, status=Status.BELOW)
        below[line.number.rpartition(".")[0]].append(line)
        settled.append(line)
    return tuple(reversed(settled))


def _judge(manual: Manual, what: str, lines: Iterable[Line], rule: str) -> Iterator[Diagnostic]:
    for line in lines:
        if line.status is Status.OPEN:
            yield diagnose(rule, manual.place, f"{what} {line.number} is neither modelled nor listed as without facts")
        if line.listed and line.elements:
            named = line.elements[0].path
            message = f"{what} {line.number} is listed as without facts, and `{named}` comes from it"
            yield diagnose("W701", line.listed.place, message, notes=((line.elements[0].place, "here"),))
