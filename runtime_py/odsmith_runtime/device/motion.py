"""Where an axis is and how fast; the twin of `ods_motion.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import units
from .units import PER_MICROSTEP, PER_PPS, int32, truncate

if TYPE_CHECKING:
    from .axis import Axis

_WRAP = 1 << 32
_ENCODER = 0  # 606Ah: the velocity is that of the encoder
_HIGHEST = (1 << 31) - 1
_LOWEST = -(1 << 31)


class Motion:
    """`position` counts 1/1,000,000 microstep, `velocity` 1/1000 microstep per second; `steps` are those of a tick."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self.reset()

    def reset(self) -> None:
        self.position = 0
        self.velocity = 0
        self.steps = 0
        self.is_backwards = False  # the last movement was
        self._is_measured = False  # 606Ch shows the velocity of the encoder

    @property
    def demand(self) -> int:
        """The position in whole microsteps."""
        return truncate(self.position, PER_MICROSTEP)

    def halt(self) -> None:
        """The power is off, nothing is demanded of the motor any more."""
        self.velocity = 0

    def move(self, velocity: int, distance: int) -> None:
        """A tick at a velocity; the distance is another one where a target is reached in it."""
        before = self.demand
        self.velocity = velocity
        self.position += distance
        if self.demand > _HIGHEST:
            self.position -= _WRAP * PER_MICROSTEP
        elif self.demand < _LOWEST:
            self.position += _WRAP * PER_MICROSTEP
        # the difference of what is shown, so that motor and position stay together over the wrap, too
        self.steps = int32(self.demand - before)
        if distance:
            self.is_backwards = distance < 0
        self._axis.encoder.follow(self.demand)
        values = self._axis.values
        counter = (values.step_counter_value + abs(self.steps)) & ((1 << 64) - 1)
        values.step_counter_value = counter
        values.step_counter_low = counter & 0xFFFFFFFF
        values.step_counter_high = counter >> 32

    def set_position(self, position: int) -> None:
        """Count from another position in microsteps, without moving."""
        self.position = position * PER_MICROSTEP
        self._axis.encoder.set_position(position)

    def start_from_encoder(self) -> None:
        """The shaft may have been turned while the motor had no power."""
        if self._axis.encoder.is_used:
            self.position = self._axis.encoder.position * PER_MICROSTEP

    @property
    def actual(self) -> int:
        """Where the shaft is, in microsteps. Without an encoder the ramp tells."""
        return self._axis.encoder.position

    def show(self) -> None:
        """The values that say where the axis is, and how fast.

        Parameters act only at a tick; what may come between two of them is that the power goes off.
        """
        values = self._axis.values
        values.position_demand_value = self.demand
        values.position_actual_internal_value = self.actual
        values.position_actual_value = self.actual
        if not self._is_measured and not self.velocity:
            values.velocity_actual_value = 0

    def show_velocity(self) -> None:
        """At a tick, by the parameters that then hold."""
        values, encoder = self._axis.values, self._axis.encoder
        self._is_measured = encoder.is_used and values.sensor_selection_code == _ENCODER
        velocity = encoder.velocity if self._is_measured else self.velocity
        values.velocity_actual_value = units.velocity_number(values, velocity)

    @property
    def velocity_in_pps(self) -> int:
        return int32(truncate(self.velocity, PER_PPS))
