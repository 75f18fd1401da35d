"""Velocities and accelerations as a tick adds them up; the twin of `ods_units.h`.

Inside an axis a velocity counts 1/1000 microstep per second, a position 1/1,000,000 microstep. So in a tick of 1 ms a
velocity is added to the position as it is, and an acceleration in microsteps per second squared to the velocity. On the
bus the numbers have the unit that 208Ch selects.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.units import UNITS

if TYPE_CHECKING:
    from odsmith_cia.values import AxisValues

PER_MICROSTEP = 1_000_000
PER_PPS = 1_000

_INTERNAL = 0  # 208Ch and 208Eh: as the ramp generator counts
_PPS_PER_SECOND = 179  # 208Eh
_VELOCITY = UNITS["velocity_internal"].scale
_ACCELERATION = UNITS["acceleration_internal"].scale


def truncate(dividend: int, divisor: int) -> int:
    """The quotient without its fraction, as C divides; the divisor is positive."""
    quotient = abs(dividend) // divisor
    return -quotient if dividend < 0 else quotient


def int32(number: int) -> int:
    """A position, which wraps."""
    return (number + (1 << 31)) % (1 << 32) - (1 << 31)


def velocity(values: AxisValues, number: int) -> int:
    """A velocity on the bus, in 1/1000 microstep per second."""
    if values.velocity_dimension_index == _INTERNAL:
        return truncate(number * PER_PPS * _VELOCITY.numerator, _VELOCITY.denominator)
    return number * PER_PPS


def acceleration(values: AxisValues, number: int) -> int:
    """An acceleration on the bus, in 1/1000 microstep per second and tick."""
    if values.velocity_dimension_index == _INTERNAL:
        return truncate(number * _ACCELERATION.numerator, _ACCELERATION.denominator)
    return number


def velocity_number(values: AxisValues, velocity: int) -> int:
    """How the bus says a velocity in 1/1000 microstep per second."""
    if values.velocity_dimension_index == _INTERNAL:
        return truncate(velocity * _VELOCITY.denominator, PER_PPS * _VELOCITY.numerator)
    return truncate(velocity, PER_PPS)


def acceleration_index(values: AxisValues) -> int:
    """What 208Eh says of the unit that 208Ch selects."""
    return _INTERNAL if values.velocity_dimension_index == _INTERNAL else _PPS_PER_SECOND
