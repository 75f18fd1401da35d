"""What coverage found, for machines as plain data and for people as tables."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from odsmith.console import print_table
from odsmith.coverage.account import FEW, Account, Line, covered, share
from odsmith.coverage.cells import Cell
from odsmith.coverage.compare import Comparison
from odsmith.coverage.elements import Element
from odsmith.errors import Diagnostic, shown_path
from odsmith.model import Device


@dataclass(frozen=True, slots=True)
class Coverage:
    """Everything about one device; `comparison` where the manual's text was at hand."""

    device: Device
    account: Account
    comparison: Comparison | None = None

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        return (*self.account.findings, *(self.comparison.findings if self.comparison else ()))

    @property
    def title(self) -> str:
        """The manual by its title, firmware and edition."""
        identity = self.device.identity
        return identity.own_manual or identity.manual or self.account.manual.name


def print_tables(coverage: Coverage) -> None:
    """Print every section and table, and each cell that differs by an erratum."""
    print(f"{coverage.device.identity.name}: {coverage.title}\n")
    print_table(line_rows("section", coverage.account.sections))
    print()
    print_table(line_rows("table", coverage.account.tables))
    if coverage.comparison and coverage.comparison.explained:
        print("\nWhere the model differs from the manual, and the errata that say why\n")
        print_table(difference_rows(coverage.comparison.explained))
    print()


def print_summary(coverage: Coverage) -> None:
    """Print the figures."""
    for name, text in summary(coverage):
        print(f"{name:<13} {text}")


def summary(coverage: Coverage) -> list[tuple[str, str]]:
    """The figures, each with its name."""
    account, comparison = coverage.account, coverage.comparison
    sourced = len(account.elements) - len(account.unsourced)
    rows = [
        ("sections", share(account.sections)),
        ("tables", share(account.tables)),
        ("elements", f"{len(account.elements)}, {sourced} of them say where they come from"),
    ]
    if account.manual.cut_off:
        rows.insert(0, ("not at hand", account.manual.cut_off))
    if comparison:
        errata = {name for cell in comparison.explained for name in cell.errata}
        rows.append(
            (
                "cells",
                f"{len(comparison.cells)} in {len(comparison.tables)} tables: {comparison.equal} as the manual prints "
                f"them, {len(comparison.explained)} otherwise by {len(errata)} errata, "
                f"{len(comparison.unexplained)} otherwise without a reason",
            )
        )
        if comparison.skipped:
            rows.append(("not compared", "tables " + ", ".join(map(str, comparison.skipped))))
    return rows


def line_rows(what: str, lines: Iterable[Line]) -> list[dict[str, str]]:
    """The rows of the table of sections or tables; titles where there are any."""
    rows = []
    for line in lines:
        row = {what: line.number}
        if line.title:
            row["title"] = line.title
        row["status"] = line.status.value
        row["errata"] = " ".join(item.name for item in line.errata)
        row["modelled by"] = named(line.elements) or (line.listed.reason if line.listed else "")
        rows.append(row)
    return rows


def difference_rows(cells: Iterable[Cell]) -> list[dict[str, str]]:
    """The rows of the table of cells that differ by an erratum."""
    return [
        {
            "errata": " ".join(cell.errata),
            "place": f"{shown_path(cell.place.path)}:{cell.place.line}",
            "table": str(cell.table),
            "cell": cell.what,
            "printed": cell.printed or "nothing",
            "modelled": cell.modelled,
        }
        for cell in cells
    ]


def named(found: Iterable[Element]) -> str:
    """Elements by their paths; of many of one kind only how many."""
    kinds: defaultdict[str, list[Element]] = defaultdict(list)
    for item in found:
        kinds[item.kind].append(item)
    return ", ".join(
        f"{kind} ({len(items)})" if len(items) > FEW else ", ".join(item.path for item in items)
        for kind, items in kinds.items()
    )


def to_json(coverage: Coverage) -> dict[str, Any]:
    """The whole of it as plain data."""
    account, comparison = coverage.account, coverage.comparison
    answer: dict[str, Any] = {
        "device": coverage.device.identifier,
        "manual": coverage.title,
        "cut_off": account.manual.cut_off,
        "sections": _lines_json(account.sections),
        "tables": _lines_json(account.tables),
        "elements": len(account.elements),
        "without_source": [item.path for item in account.unsourced],
        "findings": [finding.to_json() for finding in coverage.findings],
    }
    if comparison:
        answer["comparison"] = {
            "cells": len(comparison.cells),
            "equal": comparison.equal,
            "by_erratum": [_cell_json(cell) for cell in comparison.explained],
            "unexplained": [_cell_json(cell) for cell in comparison.unexplained],
            "tables": list(comparison.tables),
            "skipped": list(comparison.skipped),
        }
    return answer


def _lines_json(lines: Sequence[Line]) -> dict[str, Any]:
    return {
        "count": len(lines),
        "covered": covered(lines),
        "lines": [
            {
                "number": line.number,
                **({"title": line.title} if line.title else {}),
                "status": line.status.value,
                "elements": [item.path for item in line.elements],
                "errata": [item.name for item in line.errata],
                **({"reason": line.listed.reason} if line.listed else {}),
            }
            for line in lines
        ],
    }


def _cell_json(cell: Cell) -> dict[str, Any]:
    return {
        "table": cell.table,
        "cell": cell.what,
        "path": shown_path(cell.place.path),
        "line": cell.place.line,
        "column": cell.place.column,
        "paths": list(cell.paths),
        "printed": cell.printed,
        "modelled": cell.modelled,
        "errata": list(cell.errata),
    }
