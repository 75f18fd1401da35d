"""Numbers and comments in C."""

from __future__ import annotations

import pytest

from odsmith.backends.c.text import (
    Constant,
    Group,
    beside,
    comment,
    distinct,
    hexadecimal,
    number,
    rows,
    signed,
    unsigned,
)
from odsmith.canopen_types import DataType, Place
from odsmith.errors import SpecError


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (-3, "-3"),
        (2**31 - 1, "2147483647"),
        (-(2**31) + 1, "-2147483647"),
        (-(2**31), "-2147483647 - 1"),  # 2147483648 is no int, so that its negative is none either
        (2**31, "2147483648ll"),
        (-(2**63), "-9223372036854775807ll - 1"),
    ],
)
def test_signed(value: int, text: str) -> None:
    assert signed(value) == text
    assert eval(text.replace("ll", "")) == value


def test_unsigned() -> None:
    assert [unsigned(0), unsigned(2**32 - 1), unsigned(2**64 - 1)] == ["0u", "4294967295u", "18446744073709551615ull"]
    assert [hexadecimal(5), hexadecimal(5, 4), hexadecimal(2**40)] == ["0x5u", "0x0005u", "0x10000000000ull"]


def test_number_follows_the_type() -> None:
    types = (DataType.INTEGER16, DataType.UNSIGNED16, DataType.BOOLEAN, DataType.REAL32, DataType.REAL64)
    assert [number(1, data_type) for data_type in types] == ["1", "1u", "1u", "1.0f", "1.0"]


def test_a_short_comment_takes_one_line() -> None:
    assert comment("Some text.", 4) == "    /* Some text. */"
    assert comment("x" * 110) == f"/* {'x' * 110} */"


def test_a_long_comment_takes_several() -> None:
    lines = comment("word " * 60, 4).splitlines()
    assert (lines[0], lines[-1]) == ("    /*", "     */")
    assert all(line.startswith("     * word") and len(line) <= 120 for line in lines[1:-1])


@pytest.mark.parametrize("text", ["*/ int x;", "/* nested", "a\nb", "ends with \\", "??/", "\u2028int x;", "\x1b[31m"])
def test_nothing_leaves_a_comment(text: str) -> None:
    made = comment(text)
    inside = made.removeprefix("/*").removesuffix("*/")
    assert "*/" not in inside
    assert "/*" not in inside
    assert "??" not in inside
    assert made.isprintable()


def test_a_comment_beside_code() -> None:
    """Behind it where there is room."""
    assert beside("int x;", "Some text.", 4) == "    int x; /* Some text. */"
    assert beside("int x;", "") == "int x;"
    assert beside("int x;", "x" * 110) == f"/* {'x' * 110} */\nint x;"


def test_rows() -> None:
    assert rows("abcde", 2) == ["a, b", "c, d", "e"]


def test_distinct() -> None:
    first = Constant("X_BIT_A_B", "1u", place=Place("a.yaml", 3, 1))
    second = Constant("X_BIT_A_B", "2u", place=Place("a.yaml", 9, 1))
    distinct([Group("", (first,)), Group("", (Constant("X_BIT_A", "2u"),))])
    with pytest.raises(SpecError) as error:
        distinct([Group("", (first,)), Group("", (second,))])
    (diagnostic,) = error.value.diagnostics
    assert (diagnostic.rule, diagnostic.place.line, diagnostic.notes[0][0].line) == ("E472", 9, 3)
    assert "X_BIT_A_B" in diagnostic.message
