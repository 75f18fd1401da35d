"""Positions and velocities in the units that people think in, exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    Number = Fraction | float

    Length = Literal["microsteps", "steps", "revolutions"]
    """Units of positions."""

    Speed = Literal["pps", "steps/s", "rev/s"]
    """Units of velocities; pps are microsteps per second."""

_LENGTH_OF = {"pps": "microsteps", "steps/s": "steps", "rev/s": "revolutions"}


class Scale(NamedTuple):
    """How far a microstep is, by 2000h and 2001h.

    All results are exact; only `microsteps` rounds, to the nearest one, halves to the even neighbour.
    """

    microsteps_per_step: int
    steps_per_revolution: int

    def size(self, unit: str) -> int:
        """Microsteps of a unit of length. Raises ValueError for a word that is none."""
        sizes = {
            "microsteps": 1,
            "steps": self.microsteps_per_step,
            "revolutions": self.microsteps_per_step * self.steps_per_revolution,
        }
        if unit not in sizes:
            raise ValueError(f"{unit!r} is no unit of length: {', '.join(sizes)}")
        return sizes[unit]

    def microsteps(self, amount: Number, unit: Length) -> int:
        """The microsteps that come nearest to an amount."""
        return round(Fraction(amount) * self.size(unit))

    def length(self, microsteps: int, unit: Length) -> Fraction:
        """Microsteps in another unit."""
        return Fraction(microsteps, self.size(unit))

    def pps(self, amount: Number, unit: Speed) -> Fraction:
        """A velocity in microsteps per second."""
        return Fraction(amount) * self.size(_length_of(unit))

    def speed(self, pps: Fraction, unit: Speed) -> Fraction:
        """A velocity in another unit."""
        return pps / self.size(_length_of(unit))


def _length_of(unit: str) -> str:
    if unit not in _LENGTH_OF:
        raise ValueError(f"{unit!r} is no unit of velocity: {', '.join(_LENGTH_OF)}")
    return _LENGTH_OF[unit]
