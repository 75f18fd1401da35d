"""Members of enumerations that know what they mean."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime.choices import Bits, Choice, Word


class Colour(Choice):
    RED = 1, "Stop."
    GREEN = -2, "Go."
    GREY = 3


class Outputs(Bits):
    READY = 1 << 0, "Ready."
    SPEED = 0x00F0, "Speed in steps."
    OLD = 1 << 8, "Not used.", False


class Verb(Word):
    GO = "go", "Moves."


def test_a_choice_is_its_number() -> None:
    assert 1 + Colour.RED == 2
    assert Colour(-2) is Colour.GREEN
    assert (Colour.RED.text, Colour.GREY.text) == ("Stop.", "")
    assert f"{Colour.RED}" == "1"
    with pytest.raises(ValueError, match="7 is not a valid Colour"):
        Colour(7)


def test_bits_combine() -> None:
    value = Outputs.READY | Outputs.OLD
    assert value == 0x101
    assert value & Outputs.READY
    assert (Outputs.READY.text, Outputs.READY.supported, Outputs.OLD.supported) == ("Ready.", True, False)
    assert value.text == "Ready. Not used."
    assert value.supported


def test_positions() -> None:
    assert [(bit.low, bit.high) for bit in (Outputs.READY, Outputs.SPEED, Outputs.OLD)] == [(0, 0), (4, 7), (8, 8)]
    assert (Outputs(0).low, Outputs(0).high) == (-1, -1)


@given(st.integers(0, 0xFFFF))
def test_any_value_is_kept(value: int) -> None:
    assert int(Outputs(value)) == value
    assert Outputs(value).field(Outputs.SPEED) == value >> 4 & 15
    assert Outputs(value).text == " ".join(
        bit.text for bit in (Outputs.READY, Outputs.SPEED, Outputs.OLD) if value & bit
    )


@given(st.integers(0, 0xFFFF), st.integers(0, 15))
def test_a_field_is_replaced(value: int, speed: int) -> None:
    changed = Outputs(value).with_field(Outputs.SPEED, speed)
    assert changed.field(Outputs.SPEED) == speed
    assert changed & ~0xF0 == value & ~0xF0


@pytest.mark.parametrize("number", [16, -1])
def test_a_number_that_does_not_fit(number: int) -> None:
    with pytest.raises(ValueError, match=r"does not fit into SPEED, bits 4\.\.7"):
        Outputs(0).with_field(Outputs.SPEED, number)


def test_a_word_is_its_text() -> None:
    assert {"go": 1}[Verb.GO] == 1
    assert Verb("go") is Verb.GO
    assert Verb.GO.text == "Moves."
    assert f"{Verb.GO}" == "go"
