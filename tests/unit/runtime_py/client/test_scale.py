"""Positions and velocities in the units of people."""

from __future__ import annotations

from fractions import Fraction

import pytest

from odsmith_runtime.client import Scale

SCALE = Scale(256, 200)


def test_lengths() -> None:
    assert SCALE.microsteps(1, "revolutions") == 51_200
    assert SCALE.microsteps(Fraction(1, 3), "revolutions") == 17_067
    assert SCALE.microsteps(0.5, "steps") == 128
    assert SCALE.length(17_067, "revolutions") == Fraction(17_067, 51_200)
    assert SCALE.length(-3, "steps") == Fraction(-3, 256)


def test_speeds() -> None:
    assert SCALE.pps(2, "rev/s") == 102_400
    assert SCALE.speed(Fraction(128), "steps/s") == Fraction(1, 2)


def test_words_that_are_no_units() -> None:
    with pytest.raises(ValueError, match="'mm' is no unit of length: microsteps, steps, revolutions"):
        SCALE.microsteps(1, "mm")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'rpm' is no unit of velocity: pps, steps/s, rev/s"):
        SCALE.pps(1, "rpm")  # type: ignore[arg-type]
