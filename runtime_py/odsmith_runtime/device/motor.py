"""Power stage, brake, current and driver of an axis; the twin of `ods_motor.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.words import Effect

from . import units
from .port import DriverFlags, MotorDemand, Output
from .timing import TICK_US
from .work import Work

if TYPE_CHECKING:
    from .axis import Axis
    from .od import Cell

_OUTPUTS = (Output.POWER, Output.BRAKE, Output.CURRENT, Output.DRIVER)
_TO_DRIVER = frozenset(effect for effect in Effect if effect.to_driver)
_CURRENT_STEP = 8  # 2003h and 2004h: the driver knows 32 steps of 8 each
_TICKS_PER_SETTING_DELAY = 10  # 2089h counts 10 ms
_FADE_STEP_US = 16384  # 2^18 clocks of 16 MHz: a unit of 20B9h, the time in which the current falls by one step


class Motor:
    """`is_released` is about the brake."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self.power_up()
        self.reset()

    def power_up(self) -> None:
        """All outputs are 0 without being told."""
        self._told = (0,) * len(_OUTPUTS)

    def reset(self) -> None:
        """As at power-on: no power, the brake holds."""
        self.is_powered = False
        self.is_released = False
        self._is_driven = False  # the motor does not turn freely
        self._current = 0  # in steps of the driver
        self._still = 0  # ticks at standstill
        self._faded = 0  # microseconds since the current last fell
        self._flags = DriverFlags(0)

    @property
    def has_brake(self) -> bool:
        """Whether the brake is controlled automatically (200Ch)."""
        values = self._axis.values
        return bool(values.brake_current_feed_apply or values.brake_current_feed_release)

    @property
    def is_armed(self) -> bool:
        """Whether the current is not yet that of standstill."""
        return self.is_powered and (self._still <= self._settling or self._current != self._standby)

    # ---- parameters --------------------------------------------------------------------------------------------------

    def set(self, cell: Cell) -> None:
        """Hand a value to the driver if it is one of its parameters."""
        if cell.entry.effect not in _TO_DRIVER:
            return
        value = cell.value
        assert isinstance(value, int)
        node = self._axis.node
        node.port.motor_set(self._axis.number, node.od.dictionary[cell.entry.index].base_index, value)

    def set_all(self) -> None:
        """Hand all of them over, as after a reset."""
        for cell in self._axis.instance.cells:
            self.set(cell)

    # ---- power -------------------------------------------------------------------------------------------------------

    def power_on(self) -> None:
        self.is_powered = True
        self._still = 0
        self._faded = 0
        self._current = self._running
        self._is_driven = bool(self._axis.values.chopper_off_time)

    def power_off(self) -> None:
        """Also the brake falls."""
        self.is_powered = False
        self.is_released = False
        self._is_driven = False
        self._flags = DriverFlags(0)

    def tick(self) -> None:
        if self.is_powered:
            self._choose_current()
            self._choose_flags()
            self._is_driven = bool(self._axis.values.chopper_off_time)

    @property
    def _running(self) -> int:
        return self._axis.values.maximum_current // _CURRENT_STEP + 1

    @property
    def _standby(self) -> int:
        return self._axis.values.standby_current // _CURRENT_STEP + 1

    @property
    def _settling(self) -> int:
        return self._axis.values.setting_delay * _TICKS_PER_SETTING_DELAY

    def _choose_current(self) -> None:
        """That of motion; some time after it that of standstill, to which it falls step by step (2089h, 20B9h)."""
        values = self._axis.values
        if self._axis.motion.velocity:
            self._still = 0
        elif self._still <= self._settling:
            self._still += 1
        if self._still <= self._settling:
            self._current = self._running
            self._faded = 0
        elif self._current > self._standby and values.power_down_ramp:
            self._faded += TICK_US
            if self._faded >= _FADE_STEP_US * values.power_down_ramp:
                self._faded -= _FADE_STEP_US * values.power_down_ramp
                self._current -= 1
        else:
            self._current = self._standby

    def _choose_flags(self) -> None:
        values = self._axis.values
        speed = abs(self._axis.motion.velocity)

        def threshold(number: int) -> int:
            return units.velocity(values, number)

        flags = DriverFlags(0)
        if speed > threshold(values.smart_energy_threshold_speed):
            flags |= DriverFlags.COOL_STEP
        if speed < threshold(values.pwm_threshold_speed):
            flags |= DriverFlags.STEALTH_CHOP
        if values.dcstep_minimum_speed and speed >= threshold(values.dcstep_minimum_speed):
            flags |= DriverFlags.DC_STEP
        if speed > threshold(values.fullstep_threshold_speed):
            flags |= DriverFlags.HIGH_SPEED
        self._flags = flags

    # ---- the port ----------------------------------------------------------------------------------------------------

    def drive(self) -> bool:
        """Have the steps of this tick made. Whether the hardware has something new to say."""
        axis = self._axis
        before = axis.answer
        axis.answer = axis.node.port.motor(
            axis.number, MotorDemand(axis.motion.steps, axis.motion.velocity_in_pps), before
        )
        axis.motion.steps = 0
        return axis.answer != before

    def update(self) -> None:
        """Have the outputs told at the end of the turn if one has changed."""
        if self._outputs() != self._told:
            self._axis.node.work |= Work.OUTPUT

    def put(self) -> None:
        """Tell the outputs that have changed. They are 0 at power-on without being told."""
        outputs = self._outputs()
        for output, value, told in zip(_OUTPUTS, outputs, self._told, strict=True):
            if value != told:
                self._axis.node.port.output(output, self._axis.number, value)
        self._told = outputs

    def _outputs(self) -> tuple[int, ...]:
        values = self._axis.values
        brake = 0
        if self.has_brake:
            brake = values.brake_current_feed_release if self.is_released else values.brake_current_feed_apply
        return int(self.is_powered), brake, self._current if self._is_driven else 0, int(self._flags)
