"""Python source as ruff lays it out."""

from __future__ import annotations

import ast
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.backends.python.source import (
    WIDTH,
    Call,
    Code,
    Hex,
    assignment,
    declaration,
    docstring,
    literal,
    reexports,
    string,
)

TEXTS = st.text() | st.text("ab \"'\\\n{}%\u00e9\u2028").map(lambda text: text * 20)
VALUES = st.recursive(
    TEXTS | st.integers() | st.booleans() | st.none(),
    lambda inner: st.lists(inner, max_size=4).map(tuple) | st.dictionaries(TEXTS, inner, max_size=4),
    max_leaves=12,
)


@given(VALUES, st.sampled_from([0, 4, 40, 100]))
def test_a_literal_is_its_value(value: Any, indent: int) -> None:
    source = literal(value, indent, "name=")
    assert ast.literal_eval(source) == value
    assert source.isascii()


@given(TEXTS)
def test_a_string_is_on_one_line(text: str) -> None:
    assert ast.literal_eval(string(text)) == text
    assert "\n" not in string(text)


@given(st.lists(TEXTS, min_size=1, max_size=4), st.sampled_from([0, 4]))
def test_a_docstring_is_nothing_but_a_docstring(paragraphs: list[str], indent: int) -> None:
    body = " " * indent + docstring(paragraphs, indent) if indent else docstring(paragraphs)
    source = f"class X:\n{body}\n" if indent else f"{body}\n"
    module = ast.parse(source)
    statements = module.body[0].body if indent else module.body  # type: ignore[attr-defined]
    assert len(statements) == 1
    assert isinstance(statements[0], ast.Expr)
    assert isinstance(statements[0].value, ast.Constant)


@given(st.text("ab \"'\\", max_size=400), st.sampled_from([0, 4, 12]))
def test_no_line_is_too_long(text: str, indent: int) -> None:
    lines = literal(("x" * 5, text), indent).splitlines()
    assert all(len(line) <= WIDTH for line in lines)


@pytest.mark.parametrize(
    ("value", "source"),
    [
        (Hex(0x86, 4), "0x0086"),
        (Hex(0x604001, 6, group=2), "0x6040_01"),
        (Code("1 << 5"), "1 << 5"),
        ((), "()"),
        ((1,), "(1,)"),
        ({}, "{}"),
        ({"a": 1}, '{\n    "a": 1,\n}'),
        (Call("Row", {"a": 1, "b": ()}), "Row(\n    a=1,\n    b=(),\n)"),
        (Call("Row", {}), "Row()"),
        ((Call("Row", {"a": -1}),), "(\n    Row(\n        a=-1,\n    ),\n)"),
        ("it's", '"it\'s"'),
        ('say "so"', "'say \"so\"'"),
        ("it's \"so\"'", '"it\'s \\"so\\"\'"'),
        ("\u00e9\U0001f600\n", '"\\u00e9\\U0001f600\\n"'),
    ],
)
def test_how_it_is_written(value: Any, source: str) -> None:
    assert literal(value) == source


def test_what_is_no_literal() -> None:
    with pytest.raises(TypeError, match="cannot be written"):
        literal((1.5, "x"))


def test_members_and_declarations() -> None:
    assert assignment("A", (0, "Text."), 4) == 'A = 0, "Text."'
    assert declaration("x", ("_Sub", "int"), ("_Sub", "1"), 4) == "x: _Sub[int] = _Sub(1)"


def test_reexports_are_sorted_as_ruff_wants() -> None:
    assert reexports({"b": ["f", "C", "D10", "D9", "UP"], "a": []}, 4) == [
        "from .b import D9 as D9",
        "from .b import D10 as D10",
        "from .b import UP as UP",
        "from .b import C as C",
        "from .b import f as f",
    ]


# ---- what ruff would make of it --------------------------------------------------------------------------------------


def _words(generator: random.Random, letters: str = "abcdefg,.'\"") -> str:
    lengths = (generator.randint(1, 12) for _ in range(generator.randint(1, 40)))
    return " ".join("".join(generator.choices(letters, k=length)) for length in lengths)


def _value(generator: random.Random, depth: int) -> Any:
    kind = generator.randint(0, 9 if depth else 4)
    if kind < 2:
        return _words(generator)
    if kind < 5:
        return generator.choice([generator.randint(-99, 10**9), Hex(generator.randint(0, 65535), 4), None, True, "x"])
    values = [_value(generator, depth - 1) for _ in range(generator.randint(0, 5))]
    if kind < 7:
        return tuple(values)
    if kind < 8:
        return Call("Row", {f"column_{number}": value for number, value in enumerate(values)})
    return {(_words(generator)[:20] if number % 2 else number): value for number, value in enumerate(values)}


def _samples() -> Iterator[str]:
    generator = random.Random(402)
    yield '"""Samples."""\n\nfrom x import Row'
    for number in range(150):
        yield f"SAMPLE_{number}: dict[int, str] = {literal({1: _value(generator, 3)})}"
    for number in range(60):
        members = (
            assignment(f"{'M' * generator.randint(1, 40)}_{member}", (Code("1 << 3"), _words(generator)), 4)
            for member in range(3)
        )
        names = (
            declaration(
                "n" * generator.randint(1, 60) + str(name),
                ("_Variable", generator.choice(["int", f"_enums.{'C' * generator.randint(1, 60)} | int"])),
                ("_Variable", generator.choice(["0x6040", "0x1400, 4, RpdoCommunication"])),
                4,
            )
            for name in range(3)
        )
        paragraphs = [_words(generator) for _ in range(generator.randint(1, 3))]
        body = "\n    ".join([docstring(paragraphs, 4), "", *members, *names])
        yield f"\nclass Class{number}:\n    {body}".replace("\n    \n", "\n\n")
    modules = {"b": ["c" * length for length in range(40, 60)], "a1": ["X"], "a": ["Y"]}
    lines = "\n    ".join(reexports(modules, 4))
    yield f"\nif Row:\n    {lines}"


@pytest.mark.slow
def test_ruff_would_not_change_a_byte(root: Path, tmp_path: Path) -> None:
    path = tmp_path / "samples.py"
    path.write_text("\n\n".join(_samples()) + "\n", encoding="utf-8")
    ruff = [sys.executable, "-m", "ruff", "format", "--isolated", "--line-length", str(WIDTH), "--diff", str(path)]
    run = subprocess.run(ruff, capture_output=True, text=True, check=False)
    assert run.stdout == ""
    assert run.returncode == 0, run.stderr
