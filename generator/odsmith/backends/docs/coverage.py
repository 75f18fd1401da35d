"""What the reference says about its own sources: where each section and table of the manual went."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from odsmith.backends.docs.text import Piece, Reader, Rich, code, joined, plain
from odsmith.coverage.account import FEW, Line, Status, account, share
from odsmith.coverage.elements import Element
from odsmith.model import Device


class LineView(NamedTuple):
    """A section, or tables in a row that went the same way. `title` is empty for tables."""

    number: str
    title: str
    model: Rich
    errata: Rich


class CoverageView(NamedTuple):
    cut_off: Rich
    section_share: str
    table_share: str
    sections: tuple[LineView, ...]
    tables: tuple[LineView, ...]
    elements: int
    unsourced: Rich


def coverage_view(device: Device, links: Mapping[str, str], read: Reader) -> CoverageView:
    """The coverage of the device's own manual; empty where the spec does not say what it contains."""
    if device.manual is None:
        return CoverageView((), "", "", (), (), 0, ())
    found = account(device, device.manual)
    writer = _Writer(links, read)
    return CoverageView(
        cut_off=read(device.manual.cut_off),
        section_share=share(found.sections),
        table_share=share(found.tables),
        sections=tuple(writer.line(line.number, line) for line in found.sections),
        tables=tuple(writer.line(_span(lines), lines[0]) for lines in _runs(found.tables)),
        elements=len(found.elements),
        unsourced=joined(writer.element(item) for item in found.unsourced),
    )


def _runs(lines: Iterable[Line]) -> Iterator[list[Line]]:
    """Neighbours that went the same way together."""
    run: list[Line] = []
    for line in lines:
        if run and (line.elements, line.errata, line.listed) != (run[0].elements, run[0].errata, run[0].listed):
            yield run
            run = []
        run.append(line)
    if run:
        yield run


def _span(lines: Sequence[Line]) -> str:
    return lines[0].number if len(lines) == 1 else f"{lines[0].number} to {lines[-1].number}"


class _Writer:
    def __init__(self, links: Mapping[str, str], read: Reader) -> None:
        self.links = links
        self.read = read

    def line(self, number: str, line: Line) -> LineView:
        errata = joined(((Piece(item.name, self.links.get(item.path, "")),) for item in line.errata), " ")
        return LineView(number, line.title, self._model(line), errata)

    def _model(self, line: Line) -> Rich:
        if line.elements:
            return self._elements(line.elements)
        if line.listed:
            return (Piece("no facts: "), *self.read(line.listed.reason))
        return plain("see its sections" if line.status is Status.BELOW else "open")

    def _elements(self, found: Iterable[Element]) -> Rich:
        """Elements one by one; of many of a kind how many there are, with a link to their page."""
        kinds: defaultdict[str, list[Element]] = defaultdict(list)
        for item in found:
            kinds[item.kind].append(item)
        parts: list[Rich] = []
        for kind, items in kinds.items():
            if len(items) > FEW:
                page = self.links.get(items[0].path, "").partition("#")[0]
                parts.append((*code(kind, page), Piece(f" ({len(items)})")))
            else:
                parts += map(self.element, items)
        return joined(parts)

    def element(self, item: Element) -> Rich:
        return code(item.path, self.links.get(item.path, ""))
