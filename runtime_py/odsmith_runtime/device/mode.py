"""Modes of operation: what an axis in operation does in a tick; the twin of `ods_mode.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import ModeCode
from odsmith_cia.words import Condition

from . import ramp, units
from .cyclic import Cyclic
from .fsa import Stop
from .homing import Homing
from .ramp import Ramp
from .units import PER_MICROSTEP

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..modes import HomingMethodInfo, ModeInfo
    from .axis import Axis

# Bits of the controlword and of the statusword that belong to modes (CiA 402).
_NEW_SET_POINT = 0x0010
_RELATIVE = 0x0040
_HALT = 0x0100
_TARGET_REACHED = 0x0400
_INTERNAL_LIMIT = 0x0800
_ACKNOWLEDGE = 0x1000  # in the cyclic modes: a set-point is followed
_FOLLOWING_ERROR = 0x2000

_NO_WINDOWS = (0, 0xFFFFFFFF)  # 6067h: the window is not used

# 60F2h: what a relative target counts from.
_FROM_DEMAND = 1
_FROM_ACTUAL = 2

_US_PER_WAIT = 32  # 2015h
_US_PER_TICK = 1000


class Modes:
    """The mode in force, and what it remembers: `target` in microsteps is where profile position goes."""

    def __init__(self, axis: Axis, modes: Mapping[int, ModeInfo], methods: Mapping[int, HomingMethodInfo]) -> None:
        self._axis = axis
        self._modes = modes
        self._homing = Homing(axis, methods)
        self._cyclic = Cyclic(axis)
        self.reset()

    def reset(self) -> None:
        self._slow_down_ramp = ""  # the object of the last mode that has one
        self._wait = 0  # ticks of the pause at standstill
        self._homing.reset()
        self._forget()
        self._fresh: int | None = None  # the mode of a set-point that was taken since the last tick

    @property
    def is_armed(self) -> bool:
        """Whether the mode has something to do in the next tick."""
        axis = self._axis
        if axis.values.modes_of_operation != axis.values.modes_of_operation_display:
            return True
        if not axis.fsa.is_enabled:
            return False
        if self._wait:
            return True
        match axis.values.modes_of_operation_display:
            case ModeCode.PROFILE_POSITION:
                return self._has_target and not (self._is_reached and self._is_at_target)
            case ModeCode.PROFILE_VELOCITY:
                return not self._is_reached
            case ModeCode.HOMING:
                return self._homing.phase != 0
            case ModeCode.CYCLIC_SYNCHRONOUS_POSITION | ModeCode.CYCLIC_SYNCHRONOUS_VELOCITY:
                return self._cyclic.is_following
        return False

    # ---- events ------------------------------------------------------------------------------------------------------

    def enabled(self) -> None:
        """The axis is in operation: old set-points are forgotten."""
        self._forget()
        self._homing.enabled()
        self._wait = 0

    def control(self, word: int, before: int) -> None:
        """The bits of the controlword that belong to the mode asked for."""
        if self._axis.values.modes_of_operation == ModeCode.HOMING:
            self._homing.control(word, before)
        if not word & _NEW_SET_POINT:
            self._is_acknowledged = False
        elif not before & _NEW_SET_POINT:
            values = self._axis.values
            if self._axis.fsa.is_enabled and values.modes_of_operation == ModeCode.PROFILE_POSITION:
                self._set_point(values.target_position, bool(word & _RELATIVE))

    def _set_point(self, target: int, is_relative: bool) -> None:
        """An edge of new set-point replaces the target of a running move."""
        values = self._axis.values
        if is_relative:
            target += self._base(values.positioning_option_code)
        self._target = self._axis.limits.clamp(target)
        self._is_clamped = self._target != target
        self._has_target = True
        self._is_acknowledged = True
        self._is_reached = False
        self._inside = 0
        self._fresh = ModeCode.PROFILE_POSITION

    def _base(self, option: int) -> int:
        """What a relative target counts from (60F2h)."""
        values = self._axis.values
        if option == _FROM_ACTUAL:
            return values.position_actual_value
        if option == _FROM_DEMAND or not self._has_target:
            return values.position_demand_value
        return self._target

    def target_written(self, mode: ModeCode) -> bool:
        """A set-point of a cyclic mode: the axis follows it if that mode is asked for. Whether that is new."""
        if not self._axis.fsa.is_enabled or self._axis.values.modes_of_operation != mode:
            return False
        was_following = self._cyclic.is_following
        self._cyclic.written()
        self._fresh = mode
        return not was_following

    def offset_written(self) -> None:
        """The sum of target and offset has to be reached anew."""
        if self._cyclic.is_following:
            self._cyclic.restart()

    def window_written(self) -> None:
        """Whether the target is reached is judged anew."""
        self._inside = 0
        self._is_reached = False

    def _forget(self) -> None:
        self._target = 0
        self._has_target = False
        self._is_clamped = False
        self._is_acknowledged = False
        self._is_reached = False
        self._inside = 0  # ticks in the position window without a break
        self._cyclic.reset()

    # ---- a tick ------------------------------------------------------------------------------------------------------

    def tick(self) -> None:
        self._change()
        axis = self._axis
        if axis.values.modes_of_operation_display == ModeCode.HOMING:
            self._homing.begin()
        velocity = axis.motion.velocity
        distance = None
        is_pausing = not velocity and self._wait > 0
        if is_pausing:
            self._wait -= 1
        if axis.fsa.stop == Stop.QUICK_STOP_RAMP:
            velocity = ramp.slow_down(velocity, self._deceleration("quick_stop_deceleration"))
        elif axis.fsa.stop == Stop.MODE_RAMP or self._is_halted:
            velocity = self._slow_down(velocity)
        elif axis.fsa.is_enabled and not (is_pausing and self._is_profile):
            velocity, distance = self._step(velocity)
        if not axis.fsa.is_enabled or self._is_halted:
            self._cyclic.restart()
        if distance is None:
            distance = velocity
        if axis.limits.blocks(distance):
            velocity = distance = 0
        if axis.motion.velocity and not velocity:
            self._wait = -(-axis.values.ramp_wait_time * _US_PER_WAIT // _US_PER_TICK)
        axis.motion.move(velocity, distance)
        self._judge()
        self._fresh = None
        self._homing.is_requested = False

    @property
    def _is_halted(self) -> bool:
        """Bit 8, which homing ignores (manual, section 8.2.1)."""
        values = self._axis.values
        return bool(values.controlword & _HALT) and values.modes_of_operation_display != ModeCode.HOMING

    @property
    def _is_profile(self) -> bool:
        """Whether the mode is one whose moves wait for the end of a pause."""
        mode = self._axis.values.modes_of_operation_display
        return mode in (ModeCode.PROFILE_POSITION, ModeCode.PROFILE_VELOCITY)

    def _change(self) -> None:
        """A mode that was asked for takes over."""
        values = self._axis.values
        if values.modes_of_operation != values.modes_of_operation_display:
            values.modes_of_operation_display = values.modes_of_operation
            self._homing.forget()
            if self._fresh != values.modes_of_operation:
                self._forget()
        mode = self._modes.get(values.modes_of_operation_display)
        if mode is not None and mode.slow_down_ramp:
            self._slow_down_ramp = mode.slow_down_ramp

    def _step(self, velocity: int) -> tuple[int, int | None]:
        """The velocity of this tick, and the way where it is another one."""
        values = self._axis.values
        match values.modes_of_operation_display:
            case ModeCode.PROFILE_POSITION if self._has_target:
                way = self._target * PER_MICROSTEP - self._axis.motion.position
                velocity, arrives = ramp.advance(self._ramp(), velocity, way)
                return velocity, way if arrives else None
            case ModeCode.PROFILE_VELOCITY:
                return ramp.turn(
                    velocity,
                    units.velocity(values, values.target_velocity),
                    units.acceleration(values, values.profile_acceleration),
                    units.velocity(values, values.profile_start_velocity),
                    units.velocity(values, values.end_velocity),
                ), None
            case ModeCode.HOMING if self._homing.phase:
                return self._homing.step(velocity), None
            case ModeCode.CYCLIC_SYNCHRONOUS_POSITION if self._cyclic.is_following:
                target = self._cyclic.target_position
                self._target = self._axis.limits.clamp(target)
                self._is_clamped = self._target != target
                return self._cyclic.position(self._target), None
            case ModeCode.CYCLIC_SYNCHRONOUS_VELOCITY if self._cyclic.is_following:
                return self._cyclic.velocity(self._cyclic.target_velocity, velocity), None
        return self._slow_down(velocity), None

    def _slow_down(self, velocity: int) -> int:
        if not self._slow_down_ramp:
            return 0
        return ramp.slow_down(velocity, self._deceleration(self._slow_down_ramp))

    def _deceleration(self, name: str) -> int:
        return units.acceleration(self._axis.values, getattr(self._axis.values, name))

    def _ramp(self) -> Ramp:
        values = self._axis.values

        def velocity(number: int) -> int:
            return units.velocity(values, number)

        def acceleration(number: int) -> int:
            return units.acceleration(values, number)

        return Ramp(
            v_start=velocity(values.profile_start_velocity),
            a1=acceleration(values.profile_a1),
            v1=velocity(values.profile_v1),
            a2=acceleration(values.profile_acceleration),
            v_max=velocity(values.profile_velocity),
            d2=acceleration(values.profile_deceleration),
            d1=acceleration(values.profile_d1),
            v_stop=velocity(values.end_velocity),
        )

    # ---- what the mode has to report ---------------------------------------------------------------------------------

    def _judge(self) -> None:
        """Whether the target is reached."""
        values = self._axis.values
        match values.modes_of_operation_display:
            case ModeCode.PROFILE_POSITION if self._has_target:
                self._is_reached = self._is_in_position()
            case ModeCode.PROFILE_POSITION:
                self._is_reached = not self._axis.motion.velocity
            case ModeCode.PROFILE_VELOCITY:
                self._is_reached = self._axis.motion.velocity == units.velocity(values, values.target_velocity)
            case _:
                self._is_reached = False

    def _is_in_position(self) -> bool:
        """6067h and 6068h, or the ramp has arrived where no window is in use."""
        values, motion = self._axis.values, self._axis.motion
        if values.position_window in _NO_WINDOWS:
            return not motion.velocity and self._is_at_target
        if abs(motion.actual - self._target) > values.position_window:
            self._inside = 0
            return False
        if self._inside < values.position_window_time:
            self._inside += 1
            return False
        return True

    @property
    def _is_at_target(self) -> bool:
        return self._axis.motion.position == self._target * PER_MICROSTEP

    @property
    def status(self) -> int:
        """The bits of the statusword that tell of the mode."""
        values = self._axis.values
        if values.modes_of_operation_display == ModeCode.HOMING:
            return self._homing.status
        status = 0
        if self._axis.fsa.is_enabled:
            status |= _TARGET_REACHED if self._is_reached else 0
            status |= _ACKNOWLEDGE if self._is_acknowledged or self._cyclic.is_following else 0
            status |= _INTERNAL_LIMIT if self._is_clamped else 0
        if (
            values.modes_of_operation_display == ModeCode.CYCLIC_SYNCHRONOUS_POSITION
            and Condition.FOLLOWING_ERROR in self._axis.conditions
        ):
            status |= _FOLLOWING_ERROR
        return status
