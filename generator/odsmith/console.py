"""Tables for people: with rich on a terminal, plain text in a pipe."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Mapping, Sequence

from odsmith.escape import one_line
from odsmith.explain import Explanation

LABEL_WIDTH = 21
PLAIN_WIDTH = 100


def print_table(rows: Sequence[Mapping[str, object]]) -> None:
    """Rows with the same keys; the keys are the heading."""
    if not rows:
        return
    heading = list(rows[0])
    cells = [[one_line(str(row[key])) for key in heading] for row in rows]
    if sys.stdout.isatty():
        from rich.console import Console  # 30 ms, paid only by somebody who looks at it
        from rich.table import Table

        table = Table()
        for key in heading:
            table.add_column(key.replace("_", " "))
        for row in cells:
            table.add_row(*(_literal(cell) for cell in row))
        Console().print(table)
        return
    widths = [max(len(line[i]) for line in [heading, *cells]) for i in range(len(heading))]
    for line in [heading, *cells]:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip())


def _literal(text: str) -> str:
    from rich.markup import escape

    return escape(text)


def print_explanations(answers: Sequence[Explanation]) -> None:
    """Each answer as a heading with its properties below."""
    if sys.stdout.isatty():
        _print_rich(answers)
        return
    for number, answer in enumerate(answers):
        if number:
            print()
        print(_heading(answer))
        _print_rows(answer.rows)
        for title, rows in answer.tables:
            print(f"  {title}")
            _print_rows(rows)


def _heading(answer: Explanation) -> str:
    return f"{answer.title} ({', '.join(filter(None, (answer.kind, answer.device)))})"


def _print_rows(rows: Sequence[tuple[str, str]]) -> None:
    for label, value in rows:
        lines = textwrap.wrap(one_line(value), PLAIN_WIDTH - LABEL_WIDTH - 4) or [""]
        print(f"    {label:<{LABEL_WIDTH}}{lines[0]}")
        for line in lines[1:]:
            print(f"    {'':<{LABEL_WIDTH}}{line}")


def _print_rich(answers: Sequence[Explanation]) -> None:
    from rich.console import Console, Group
    from rich.panel import Panel
    from rich.table import Table
    from rich.text import Text

    def grid(rows: Sequence[tuple[str, str]]) -> Table:
        table = Table.grid(padding=(0, 2))
        table.add_column(style="cyan", no_wrap=True)
        table.add_column()
        for label, value in rows:
            table.add_row(Text(one_line(label)), Text(one_line(value)))
        return table

    console = Console()
    for answer in answers:
        parts: list[Table | Text] = [grid(answer.rows)]
        for title, rows in answer.tables:
            parts += [Text(f"\n{one_line(title)}", style="bold"), grid(rows)]
        title_text = Text(_heading(answer), style="bold")
        console.print(Panel(Group(*parts), title=title_text, title_align="left"))
