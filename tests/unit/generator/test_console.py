"""Tables for people: aligned text in a pipe, rich on a terminal, and never a control character of a spec."""

from __future__ import annotations

import sys

import pytest

from odsmith.console import LABEL_WIDTH, PLAIN_WIDTH, print_explanations, print_table
from odsmith.explain import Explanation, explain
from odsmith.model import Device

ROWS = [{"name": "a", "count": 1}, {"name": "longer name", "count": 20}]


def pretend_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Standard output says that it is a terminal of 90 columns."""
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "90")
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)


def test_a_plain_table(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(ROWS)
    assert capsys.readouterr().out == "name         count\na            1\nlonger name  20\n"


def test_an_empty_table_is_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    print_table([])
    assert capsys.readouterr().out == ""


def test_a_rich_table(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    pretend_a_terminal(monkeypatch)
    print_table([*ROWS, {"name": "[bold]", "count": 3}])
    out = capsys.readouterr().out
    assert "┃" in out
    assert "longer name" in out
    assert "[bold]" in out  # no mark-up of rich in it


def test_cells_stay_on_their_line(capsys: pytest.CaptureFixture[str]) -> None:
    print_table([{"name": "two\nlines\x1b[31m", "count": 1}])
    assert capsys.readouterr().out == "name           count\ntwo lines[31m  1\n"


ANSWER = Explanation(
    "object",
    "Target position",
    "TOY-2",
    (("Object", "607Ah"), ("Meaning", "word " * 40)),
    (("Bits of it", (("bit 0", "first: \x1b[2Jcleared"), ("bit 1", "[red]no mark-up[/red]"))),),
)


def test_a_plain_answer(capsys: pytest.CaptureFixture[str]) -> None:
    print_explanations([ANSWER, ANSWER])
    out = capsys.readouterr().out
    first, second = out.split("\n\n")
    assert first == second.rstrip("\n")
    lines = first.splitlines()
    assert lines[0] == "Target position (object, TOY-2)"
    assert lines[1] == f"    {'Object':<{LABEL_WIDTH}}607Ah"
    assert lines[2].startswith(f"    {'Meaning':<{LABEL_WIDTH}}word word")
    assert lines[3].startswith(" " * (4 + LABEL_WIDTH) + "word")
    assert max(map(len, lines)) <= PLAIN_WIDTH
    assert lines[-3:] == [
        "  Bits of it",
        f"    {'bit 0':<{LABEL_WIDTH}}first: [2Jcleared",
        f"    {'bit 1':<{LABEL_WIDTH}}[red]no mark-up[/red]",
    ]


def test_a_property_without_a_value_has_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    print_explanations([Explanation("object", "T", "D", (("Meaning", ""),))])
    assert capsys.readouterr().out.splitlines()[1].strip() == "Meaning"


def test_no_label_runs_into_its_value(tmcm3230: Device, capsys: pytest.CaptureFixture[str]) -> None:
    for term in ("1840", "6040", "607D", "EMCY 8611", "06090030", "pp", "operation enabled", "method 17", "E20"):
        for answer in explain(tmcm3230, term):
            labels = [label for rows in (answer.rows, *(rows for _, rows in answer.tables)) for label, _ in rows]
            assert max(map(len, labels)) < LABEL_WIDTH


def test_a_rich_answer(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    pretend_a_terminal(monkeypatch)
    print_explanations([ANSWER])
    out = capsys.readouterr().out
    assert "╭" in out
    assert "Target position (object, TOY-2)" in out
    assert "\x1b[36mObject" in out  # coloured
    assert "\x1b[2J" not in out
    assert "[red]no mark-up[/red]" in out
