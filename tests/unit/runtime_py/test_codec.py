"""Values to octets and back."""

from __future__ import annotations

import math
import struct
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime import codec

INTEGER_TYPES = sorted(codec.INTEGERS)


@st.composite
def typed_integers(draw: st.DrawFn) -> tuple[str, int]:
    data_type = draw(st.sampled_from(INTEGER_TYPES))
    low, high = codec.limits(data_type) or (0, 0)
    return data_type, draw(st.integers(low, high) | st.sampled_from([low, high]))


@given(typed_integers())
def test_integers_come_back(case: tuple[str, int]) -> None:
    data_type, value = case
    data = codec.encode(data_type, value)
    assert len(data) == codec.size(data_type)
    assert codec.decode(data_type, data) == value


@given(typed_integers(), st.integers(1, 2**70))
def test_integers_outside_the_type_are_refused(case: tuple[str, int], beyond: int) -> None:
    low, high = codec.limits(case[0]) or (0, 0)
    for value in (low - beyond, high + beyond):
        with pytest.raises(ValueError, match=case[0]):
            codec.encode(case[0], value)


@pytest.mark.parametrize(
    ("data_type", "value", "octets"),
    [
        ("BOOLEAN", 1, "01"),
        ("INTEGER8", -2, "fe"),
        ("INTEGER16", -2, "fe ff"),
        ("UNSIGNED16", 0x6040, "40 60"),
        ("INTEGER32", -500_000, "e0 5e f8 ff"),
        ("UNSIGNED32", 0x65766173, "73 61 76 65"),
        ("UNSIGNED64", 0x0102030405060708, "08 07 06 05 04 03 02 01"),
        ("REAL32", 1.5, "00 00 c0 3f"),
        ("REAL64", -2.0, "00 00 00 00 00 00 00 c0"),
        ("VISIBLE_STRING", "save", "73 61 76 65"),
        ("OCTET_STRING", b"\x00\xff", "00 ff"),
        ("DOMAIN", b"", ""),
    ],
)
def test_octets_on_the_bus(data_type: str, value: int | float | str | bytes, octets: str) -> None:
    assert codec.encode(data_type, value) == bytes.fromhex(octets)
    assert codec.decode(data_type, bytes.fromhex(octets)) == value


def test_a_boolean_is_a_bool() -> None:
    assert codec.decode("BOOLEAN", b"\x01") is True
    assert codec.decode("BOOLEAN", b"\x00") is False


@given(st.floats(width=32))
def test_reals_come_back(value: float) -> None:
    back = codec.decode("REAL32", codec.encode("REAL32", value))
    assert isinstance(back, float)
    assert back == value or (math.isnan(back) and math.isnan(value))


def test_a_real_that_is_too_large() -> None:
    with pytest.raises(ValueError, match="REAL32"):
        codec.encode("REAL32", 1e300)


@given(st.text(st.characters(min_codepoint=0x20, max_codepoint=0x7E)))
def test_text_comes_back(text: str) -> None:
    assert codec.decode("VISIBLE_STRING", codec.encode("VISIBLE_STRING", text)) == text


def test_text_ends_at_a_zero_and_shows_what_is_not_ascii() -> None:
    assert codec.decode("VISIBLE_STRING", b"ab\0cd") == "ab"
    assert codec.decode("VISIBLE_STRING", b"a\xff") == "a\ufffd"


@given(st.binary())
def test_octets_come_back(data: bytes) -> None:
    assert codec.decode("OCTET_STRING", codec.encode("OCTET_STRING", data)) == data


@pytest.mark.parametrize(
    ("data_type", "value"),
    [
        ("UNSIGNED8", 1.0),
        ("UNSIGNED8", "1"),
        ("UNSIGNED8", None),
        ("UNSIGNED8", Fraction(1)),
        ("REAL32", "1.5"),
        ("VISIBLE_STRING", b"ab"),
        ("VISIBLE_STRING", 5),
        ("OCTET_STRING", "ab"),
        ("DOMAIN", 5),
    ],
)
def test_values_of_another_kind(data_type: str, value: object) -> None:
    with pytest.raises(TypeError):
        codec.encode(data_type, value)  # type: ignore[arg-type]


def test_text_must_be_ascii() -> None:
    with pytest.raises(ValueError, match="ASCII"):
        codec.encode("VISIBLE_STRING", "é")


@pytest.mark.parametrize("data_type", [*INTEGER_TYPES, *codec.REALS])
def test_a_wrong_number_of_octets(data_type: str) -> None:
    for length in {0, 1, 2, 3, 4, 5, 8, 9} - {codec.size(data_type)}:
        with pytest.raises(ValueError, match=f"{length} octets instead of"):
            codec.decode(data_type, bytes(length))


def test_lengths_in_a_mapping() -> None:
    assert [codec.bits(name) for name in ("BOOLEAN", "INTEGER16", "REAL64", "DOMAIN")] == [1, 16, 64, 0]
    assert codec.size("REAL32") == struct.calcsize("<f")
    assert codec.limits("REAL32") is None


def test_any_integer_will_do() -> None:
    class Seven:
        def __index__(self) -> int:
            return 7

    assert codec.encode("UNSIGNED8", Seven()) == b"\x07"  # type: ignore[arg-type]
