"""Diagnostics: order, text, caret, and that hostile text cannot get at the terminal."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.canopen_types import NOWHERE, Place
from odsmith.errors import (
    WINDOW,
    Diagnostic,
    Fix,
    SourceLines,
    SpecError,
    did_you_mean,
    format_diagnostic,
    listed,
    quoted,
    shown_path,
    visible,
)


def shown(line: str, column: int = 1, length: int = 0) -> list[str]:
    """The source line and the caret line of a diagnostic in a file of one line."""
    found = Diagnostic("E201", "error", "sentence", Place("a.yaml", 1, column), length)
    return format_diagnostic(found, SourceLines({"a.yaml": line})).split("\n")[1:]


def test_all_parts_in_their_order() -> None:
    found = Diagnostic(
        "E113",
        "error",
        "the key `b` is given twice",
        Place("a.yaml", 2, 3),
        hint="delete one",
        notes=((Place("a.yaml", 1, 1), "first given here"),),
    )
    assert format_diagnostic(found, SourceLines({"a.yaml": "b: 1\n  bb: 2\n"})) == (
        "a.yaml:2:3: error[E113]: the key `b` is given twice\n"
        "      bb: 2\n"
        "      ^~\n"
        "hint: delete one\n"
        "a.yaml:1:1: note: first given here\n"
        "    b: 1\n"
        "    ^"
    )


@pytest.mark.parametrize("severity", ["error", "warning", "note"])
def test_severity_is_told(severity: str) -> None:
    found = Diagnostic("W501", severity, "sentence", Place("a.yaml", 1, 1))  # type: ignore[arg-type]
    assert format_diagnostic(found, SourceLines({})) == f"a.yaml:1:1: {severity}[W501]: sentence"


def test_a_place_without_line_is_the_file() -> None:
    found = Diagnostic("E105", "error", "the file is empty", Place("a.yaml", 0, 0))
    assert format_diagnostic(found, SourceLines({"a.yaml": ""})) == "a.yaml: error[E105]: the file is empty"


@pytest.mark.parametrize(
    ("line", "column", "token"),
    [
        ("key: value", 1, "key"),
        ("key: two words # comment", 6, "two words"),
        ("key: {a: one two, b: 3}", 10, "one two"),
        ('key: "quoted, text" ', 6, '"quoted, text"'),
        ("key: 'it''s' # x", 6, "'it''s'"),
        ("key: [a, b]", 6, "["),
        ("a: 09:00", 4, "09:00"),
        ("key:", 5, "?"),
        ("key:", 99, "?"),
    ],
)
def test_the_token_at_the_place_is_underlined(line: str, column: int, token: str) -> None:
    indent = " " * (min(column, len(line) + 1) - 1)
    assert shown(line, column) == [f"    {line.rstrip()}", f"    {indent}^{'~' * (len(token) - 1)}"]


def test_a_given_length_is_underlined_within_the_line() -> None:
    assert shown("abcdef", 2, 3)[1] == "     ^~~"
    assert shown("abcdef", 5, 30)[1] == "        ^~"


def test_tabs_and_control_characters_are_shown_as_escapes() -> None:
    assert shown("\ta: \x1b[31mred\u202e", 5) == [r"    \ta: \x1b[31mred\u202e", "         ^~~~"]


def test_wide_and_combining_characters_do_not_shift_the_caret() -> None:
    assert shown("日本: x", 5) == ["    日本: x", "          ^"]
    assert shown("e\u0301: x", 5) == ["    e\u0301: x", "       ^"]


@pytest.mark.parametrize("column", [1, 50, 101, 250, 399, 400])
def test_a_long_line_is_cut_around_the_caret(column: int) -> None:
    line = "".join(chr(ord("a") + i % 26) for i in range(400))
    source, caret = shown(line, column, 1)
    assert len(source) <= 4 + WINDOW + 6
    assert caret.strip() == "^"
    assert source[caret.index("^")] == line[column - 1]


def test_a_long_underline_ends_with_the_window() -> None:
    source, caret = shown("x" * 1000, 1, 1000)
    assert len(caret) <= len(source)


@given(st.text(min_size=1, max_size=300), st.integers(1, 310), st.integers(0, 310))
def test_any_text_gives_printable_lines(line: str, column: int, length: int) -> None:
    found = Diagnostic("E201", "error", line, Place("a.yaml", 1, column), length, hint=line)
    text = format_diagnostic(found, lambda path: [line])
    assert all(part.isprintable() for part in text.split("\n"))
    assert len(text.split("\n")) == (4 if line.strip() else 2)  # heading, source, caret, hint


def test_messages_paths_and_hints_cannot_garble_a_terminal() -> None:
    found = Diagnostic("E201", "error", "a\nb\x1b", Place("x\x07.yaml", 1, 1), hint="\u2028")
    assert format_diagnostic(found, SourceLines({})) == (
        r"x\x07.yaml:1:1: error[E201]: a\nb\x1b" + "\n" + r"hint: \u2028"
    )


def test_lines_are_those_of_the_yaml_reader() -> None:
    lines = SourceLines({"a": "1\r\n2\r3\n4\x854b\u20286\x0b6\x1c6"})
    assert lines("a") == ["1", "2", "3", "4", "4b", "6\x0b6\x1c6"]
    assert lines("unknown") == ()


def test_errors_are_sorted_and_said_once() -> None:
    def at(path: str, line: int, column: int, rule: str = "E201") -> Diagnostic:
        return Diagnostic(rule, "error", "sentence", Place(path, line, column))

    expected = [at("a", 1, 2), at("a", 2, 1, "E105"), at("a", 2, 1), at("a", 10, 1), at("b", 1, 1)]
    error = SpecError([*reversed(expected), *expected], {"a": "one\ntwo"})
    assert error.diagnostics == tuple(expected)
    assert str(error).startswith(
        "a:1:2: error[E201]: sentence\n    one\n     ^~\na:2:1: error[E105]: sentence\n    two"
    )


def test_json_form() -> None:
    found = Diagnostic("E1", "error", "m", Place("a", 1, 2), 3, "h", ((Place("b", 4, 5), "n"),))
    assert json.loads(json.dumps(found.to_json())) == {
        "rule": "E1",
        "severity": "error",
        "message": "m",
        "path": "a",
        "line": 1,
        "column": 2,
        "length": 3,
        "object": "",
        "hint": "h",
        "fix": None,
        "notes": [{"path": "b", "line": 4, "column": 5, "message": "n"}],
    }


def test_object_and_fix_are_shown_and_in_json() -> None:
    fix = Fix(3, 3, ("Default=1",))
    found = Diagnostic("L1", "error", "m", Place("a", 0, 0), hint="h", subject="6212.axes.607D:1", fix=fix)
    assert format_diagnostic(found, SourceLines({})).split("\n")[1:] == [
        "object: 6212.axes.607D:1",
        "hint: h",
        "fix: Default=1",
    ]
    assert found.to_json()["object"] == "6212.axes.607D:1"
    assert found.to_json()["fix"] == {"first": 3, "last": 3, "lines": ["Default=1"]}
    assert str(Fix(3, 3, ())) == "delete the line"
    assert str(Fix(4, 3, ("a", "b"))) == "insert a / b"


def test_paths_below_the_current_directory_are_relative(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert shown_path(str(tmp_path / "spec" / "a.yaml")) == "spec/a.yaml"
    assert shown_path("spec/a.yaml") == "spec/a.yaml"
    assert shown_path("../a.yaml") == "../a.yaml"
    assert shown_path("/elsewhere/a.yaml") == "/elsewhere/a.yaml"
    assert shown_path(NOWHERE.path) == NOWHERE.path


def test_values_in_sentences() -> None:
    assert quoted(None) == "`null`"
    assert quoted(True) == "`true`"
    assert quoted(12) == "`12`"
    assert quoted("a\nb") == r"`a\nb`"
    assert quoted("x" * 100) == "`" + "x" * 57 + "...`"
    assert listed([]) == "nothing"
    assert listed(["a"]) == "`a`"
    assert listed(["a", "b", "c"], "and") == "`a`, `b` and `c`"
    assert visible("äß日") == "äß日"


def test_did_you_mean() -> None:
    assert did_you_mean("acess", ["index", "access"]) == "did you mean `access`?"
    assert did_you_mean("colour", ["index", "access"]) == ""
    assert did_you_mean("a" * 61, ["a" * 61]) == ""
