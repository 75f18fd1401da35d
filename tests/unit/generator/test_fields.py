"""The little languages inside YAML values."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.canopen_types import DataType
from odsmith.fields import FieldError, parse_bits, parse_default, parse_number, parse_pattern, parse_range, parse_scale
from odsmith.model import Default


@pytest.mark.parametrize(
    ("text", "intervals"),
    [
        ("0..63", ((0, 63),)),
        ("0, 2..15", ((0, 0), (2, 15))),
        ("2..15, 0", ((0, 0), (2, 15))),
        ("-3..12", ((-3, 12),)),
        ("0x10..0x1F", ((16, 31),)),
        ("1, 2, 3, 5", ((1, 3), (5, 5))),
        (7, ((7, 7),)),
    ],
)
def test_range(text: str | int, intervals: tuple[tuple[int, int], ...]) -> None:
    assert parse_range(text).intervals == intervals


@pytest.mark.parametrize(
    ("text", "listed"), [("0..63", False), ("0, 2..15", True), ("0, 1", True), ("5", True), (5, True)]
)
def test_a_list_is_not_a_range_even_where_its_members_touch(text: str | int, listed: bool) -> None:
    assert parse_range(text).listed == listed


@pytest.mark.parametrize("text", ["", "a..b", "1...2", "5..1", "1,,2", "0..", "1.5..2"])
def test_range_that_is_none(text: str) -> None:
    with pytest.raises(FieldError) as caught:
        parse_range(text)
    assert caught.value.hint


@given(st.lists(st.tuples(st.integers(-99, 99), st.integers(0, 20)), min_size=1, max_size=6), st.integers(-120, 140))
def test_range_holds_exactly_what_its_pieces_hold(pieces: list[tuple[int, int]], value: int) -> None:
    allowed = parse_range(", ".join(f"{low}..{low + length}" for low, length in pieces))
    assert (value in allowed) == any(low <= value <= low + length for low, length in pieces)
    assert all(a[1] + 1 < b[0] for a, b in zip(allowed.intervals, allowed.intervals[1:], strict=False))


def test_default() -> None:
    assert parse_default(5, DataType.UNSIGNED8) == Default(5)
    assert parse_default("$NODEID+0x80", DataType.UNSIGNED32) == Default(0x80, node_id=True)
    assert parse_default("$NODEID", DataType.UNSIGNED8).value(7) == 7
    assert parse_default("TMCM", DataType.VISIBLE_STRING).value(7) == "TMCM"
    with pytest.raises(FieldError, match="no default for UNSIGNED8"):
        parse_default("0x80+$NODEID", DataType.UNSIGNED8)


def test_pattern() -> None:
    assert parse_pattern("xxxx xxxx x01x 0111") == (0x6F, 0x27, 0)
    assert parse_pattern("0xxx x110") == (0x87, 0x06, 0)
    assert parse_pattern("^xxx xxxx") == (0, 0, 0x80)
    for wrong in ("xxxx", "2xxx xxxx", "xxxx xxxx xxxx xxxx x"):
        with pytest.raises(FieldError):
            parse_pattern(wrong)


@given(st.integers(0, 0xFFFF), st.integers(0, 0xFFFF))
def test_pattern_matches_the_words_it_draws(mask: int, word: int) -> None:
    text = "".join(str(word >> bit & 1) if mask >> bit & 1 else "x" for bit in range(15, -1, -1))
    assert parse_pattern(text) == (mask, word & mask, 0)


def test_bits_scale_and_number() -> None:
    assert parse_bits("5") == (5, 5)
    assert parse_bits("16..23") == (16, 23)
    assert parse_scale("1/1000") == (1, 1000)
    assert parse_scale(5) == (5, 1)
    assert parse_number("-1") == -1
    assert parse_number("0x1F") == 31
    for parse, wrong in ((parse_bits, "x"), (parse_bits, "7..3"), (parse_scale, "1/0"), (parse_number, "1.5")):
        with pytest.raises(FieldError):
            parse(wrong)
