"""Homing: how an axis looks for its home position (manual, section 8); the twin of `ods_homing.c`.

The device's table says for each method which switch counts, where the search sets out, and in which direction the axis
travels when it takes the edge, from active to inactive. The switch is found fast, its edge is passed slowly, and there
the axis stands.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

from . import ramp, units
from .limits import HOME, LEFT, RIGHT

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..modes import HomingMethodInfo
    from .axis import Axis

_START = 0x0010  # bit 4 of the controlword
_REACHED = 0x0400  # bits of the statusword
_ATTAINED = 0x1000

_SWITCHES = {"none": 0, "negative_limit": LEFT, "positive_limit": RIGHT, "home": HOME}


class Phase(IntEnum):
    IDLE = 0
    SEARCH = 1  # fast, until the switch is active
    BRAKE = 2  # the switch was found on a way that does not lead over its edge
    EDGE = 3  # slowly over the edge
    BACK = 4  # the edge was passed too fast: slowly back onto the switch
    INDEX = 5  # slowly to the next index pulse
    STOP = 6  # called off by bit 4


class Homing:
    def __init__(self, axis: Axis, methods: Mapping[int, HomingMethodInfo]) -> None:
        self._axis = axis
        self._methods = methods
        self.reset()

    def reset(self) -> None:
        self.is_requested = False
        self.forget()

    def forget(self) -> None:
        """Another mode took over. What is requested stays."""
        self.phase = Phase.IDLE
        self._method = 0
        self._direction = 0  # of the search
        self._was_active = False  # the switch, on the way over its edge
        self._has_reversed = False
        self.status = 0  # bits 10 and 12 of the statusword

    # ---- events ------------------------------------------------------------------------------------------------------

    def enabled(self) -> None:
        """The axis is in operation again: a search from before is over."""
        self.phase = Phase.IDLE

    def control(self, word: int, before: int) -> None:
        """Bit 4 starts and stops."""
        if not word & _START:
            self.is_requested = False
            if self.phase:
                self.phase = Phase.STOP
        elif not before & _START:
            self.is_requested = True

    def begin(self) -> None:
        """What was asked for begins, in a tick in which homing is in force."""
        if not self.is_requested:
            return
        self.is_requested = False
        method = self._methods.get(self._axis.values.homing_method)
        if method is None or (method.needs_power and not self._axis.fsa.is_enabled):
            return
        if method.switch == "none" and not method.index_pulse:
            if method.method:
                self._found(0)
            return
        self._method = method.method
        self._direction = method.direction
        self._has_reversed = False
        self._was_active = False
        self.status = 0
        if method.switch == "none":
            self.phase = Phase.INDEX
        else:
            self.phase = Phase.EDGE if self._is_active(method) else Phase.SEARCH

    # ---- a tick ------------------------------------------------------------------------------------------------------

    def step(self, velocity: int) -> int:
        """The velocity of this tick."""
        method = self._methods[self._method]
        self._look(method, velocity)
        if self.phase == Phase.IDLE:
            return 0
        values = self._axis.values
        acceleration = units.acceleration(values, values.homing_acceleration)
        if self.phase in (Phase.BRAKE, Phase.STOP):
            velocity = ramp.slow_down(velocity, acceleration)
            if not velocity:
                self._rest()
            return velocity
        speed = values.homing_speeds_fast if self.phase == Phase.SEARCH else values.homing_speeds_slow
        return ramp.turn(velocity, self._heading(method) * units.velocity(values, speed), acceleration, 0, 0)

    def _heading(self, method: HomingMethodInfo) -> int:
        """The direction that the phase leads to."""
        if self.phase == Phase.SEARCH:
            return self._direction
        return -method.edge if self.phase == Phase.BACK else method.edge

    def _look(self, method: HomingMethodInfo, velocity: int) -> None:
        """What the switches say to the phase."""
        is_active = self._is_active(method)
        if self.phase == Phase.SEARCH and is_active:
            self.phase = Phase.EDGE if self._direction == method.edge else Phase.BRAKE
        is_turning = velocity * self._heading(method) < 0
        match self.phase:
            case Phase.EDGE if not is_turning:
                if is_active:
                    self._was_active = True
                elif self._was_active:
                    self._passed(method, velocity)
            case Phase.BACK:
                if is_active:
                    self.phase = Phase.BRAKE
            case Phase.INDEX if not is_turning:
                if self._axis.encoder.has_pulse and self._is_slow(velocity):
                    self._found(units.int32(-self._axis.values.home_offset))
        if self.phase in (Phase.SEARCH, Phase.EDGE, Phase.BACK, Phase.INDEX):
            self._mind_limits(method, velocity)

    def _passed(self, method: HomingMethodInfo, velocity: int) -> None:
        """The edge. It counts if the axis was slow."""
        if not self._is_slow(velocity):
            self.phase = Phase.BACK
        elif method.index_pulse:
            self.phase = Phase.INDEX
        else:
            self._found(units.int32(-self._axis.values.home_offset))

    def _is_slow(self, velocity: int) -> bool:
        return abs(velocity) <= units.velocity(self._axis.values, self._axis.values.homing_speeds_slow)

    def _mind_limits(self, method: HomingMethodInfo, velocity: int) -> None:
        """A limit switch ahead turns the search round, or it ends the homing."""
        heading = velocity or self._heading(method)
        ahead = LEFT if heading < 0 else RIGHT if heading else 0
        if not self._axis.values.digital_inputs & ahead:
            return
        if self.phase == Phase.SEARCH and not self._has_reversed and ahead == _SWITCHES[method.reverse_at]:
            self._direction = -self._direction
            self._has_reversed = True
        elif ahead != _SWITCHES[method.switch] and not self._leaves(method, velocity):
            self._end()

    def _leaves(self, method: HomingMethodInfo, velocity: int) -> bool:
        """Whether the axis still moves the way that it is just turning away from."""
        return self.phase in (Phase.SEARCH, Phase.EDGE) and velocity * self._heading(method) < 0

    def _rest(self) -> None:
        """Stopped: the edge comes next, or nothing."""
        if self.phase == Phase.STOP:
            self._end()
        else:
            self.phase = Phase.EDGE
            self._was_active = False

    # ---- the end -----------------------------------------------------------------------------------------------------

    def _found(self, position: int) -> None:
        axis = self._axis
        axis.motion.set_position(position)
        axis.values.home_offset_display = axis.values.home_offset
        self.phase = Phase.IDLE
        self.status = _REACHED | _ATTAINED

    def _end(self) -> None:
        """Stopped without a home position: a homing that failed looks the same (manual, section 8.2.2)."""
        self.phase = Phase.IDLE
        self.status = _REACHED

    def _is_active(self, method: HomingMethodInfo) -> bool:
        return bool(self._axis.values.digital_inputs & _SWITCHES[method.switch])
