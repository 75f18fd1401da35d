"""The cyclic modes: set-points in a fixed cycle (manual, sections 9 and 10); the twin of `ods_cyclic.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import units
from .units import PER_MICROSTEP, truncate

if TYPE_CHECKING:
    from .axis import Axis

_HALF = (1 << 31) * PER_MICROSTEP
_WRAP = (1 << 32) * PER_MICROSTEP


class Cyclic:
    """`is_following` is true from the first set-point on; `ticks` remain until the last one has to be reached."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self.reset()

    def reset(self) -> None:
        self.is_following = False
        self.ticks = 0

    def written(self) -> None:
        """A set-point came: the cycle starts."""
        self.is_following = True
        self.restart()

    def restart(self) -> None:
        """The set-point has to be reached within one cycle from now on (60C2h); 0 is one tick."""
        values = self._axis.values
        ticks: int = values.interpolation_time_period_value * 10 ** (values.interpolation_time_period_index + 3)
        self.ticks = max(ticks, 1)

    def position(self, goal: int) -> int:
        """The velocity that reaches a position in microsteps in time; positions wrap, the shorter way counts."""
        way = (goal * PER_MICROSTEP - self._axis.motion.position + _HALF) % _WRAP - _HALF
        return self._share(way)

    def velocity(self, goal: int, velocity: int) -> int:
        """The velocity on the way to a velocity in 1/1000 microstep per second."""
        return velocity + self._share(goal - velocity) if self.ticks else goal

    def _share(self, rest: int) -> int:
        """What of it falls to this tick."""
        if not self.ticks:
            return 0
        share = truncate(rest, self.ticks)
        self.ticks -= 1
        return share

    @property
    def target_position(self) -> int:
        values = self._axis.values
        return values.target_position + values.position_offset

    @property
    def target_velocity(self) -> int:
        values = self._axis.values
        return units.velocity(values, values.target_velocity) + units.velocity(values, values.velocity_offset)
