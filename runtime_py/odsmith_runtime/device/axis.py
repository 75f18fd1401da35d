"""An axis: its parts, and the order in which a tick goes through them; the twin of `ods_axis.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import ModeCode
from odsmith_cia.words import Condition, Effect, Reaction

from . import units
from .encoder import Encoder
from .fsa import Fsa
from .limits import Limits
from .mode import Modes
from .motion import Motion
from .motor import Motor
from .port import MotorAnswer
from .work import Work

if TYPE_CHECKING:
    from .node import Node
    from .od import Cell
    from .tables import Tables

# Bits of the statusword 6041h that no mode owns (CiA 402; bits 14 and 15: manual, section 6.1.2).
_VOLTAGE_ENABLED = 0x0010
_WARNING = 0x0080
_REMOTE = 0x0200
_INTERNAL_LIMIT = 0x0800
_MOTOR_ACTIVITY = 0x4000
_DIRECTION = 0x8000

# Conditions that the axis finds itself, and that it has to look at until they end.
_OWN = {Condition.STALL, Condition.FOLLOWING_ERROR}


class Axis:
    """Axis `number`."""

    def __init__(self, node: Node, number: int, tables: Tables) -> None:
        self.node = node
        self.number = number
        self.instance = node.od.instances[node.od.first["axis"] + number]
        self.values = node.od.axes[number]
        self.faults: set[str] = set()  # hardware conditions as they are
        self.answer = MotorAnswer()  # what the hardware said last
        self.conditions: set[str] = set()  # those that hold since the last tick
        self.motion = Motion(self)
        self.motor = Motor(self)
        self.limits = Limits(self)
        self.encoder = Encoder(self)
        self.mode = Modes(self, tables.modes, tables.homing_methods)
        self.fsa = Fsa(self, tables.state_machine)
        self._found: set[str] = set()  # conditions but for limits
        self._is_called = False  # the hardware has spoken since the last tick
        self._shown: tuple[int, ...] = ()  # values that TPDOs may carry, as they were last

    @property
    def state(self) -> str:
        """The name of the PDS state."""
        return self.fsa.state

    # ---- events ------------------------------------------------------------------------------------------------------

    def reset(self) -> None:
        """As at power-on. The values of the axis have just been set."""
        self.conditions = set()
        for part in (self.fsa, self.motion, self.encoder, self.motor, self.limits, self.mode):
            part.reset()
        self.motor.set_all()
        self.update()

    def written(self, cell: Cell) -> None:
        """A value of the axis was written."""
        effect = cell.entry.effect
        shows = False  # before the next tick
        if effect == Effect.CONTROLWORD:
            self.fsa.command(self.values.controlword)
            shows = True
        elif effect == Effect.BRAKE:
            self.node.work |= Work.OUTPUT
        elif effect == Effect.TARGET_POSITION:
            shows = self.mode.target_written(ModeCode.CYCLIC_SYNCHRONOUS_POSITION)
        elif effect == Effect.TARGET_VELOCITY:
            shows = self.mode.target_written(ModeCode.CYCLIC_SYNCHRONOUS_VELOCITY)
        elif effect == Effect.SET_POINT_OFFSET:
            self.mode.offset_written()
        elif effect == Effect.POSITION_WINDOW:
            self.mode.window_written()
            shows = True
        else:
            if effect in (Effect.ENCODER_PARAMETER, Effect.MICROSTEP_RESOLUTION):
                self.encoder.parameter_written()
            self.motor.set(cell)
        self.node.timers.arm_tick()
        if shows:
            self.update()

    def react(self, reaction: str) -> None:
        """What an emergency does to the axis."""
        if reaction == Reaction.FAULT_RAMP:
            self.fsa.fault(off=False)
        elif reaction == Reaction.FAULT_OFF:
            self.fsa.fault(off=True)
        self.update()

    def network_stopped(self) -> None:
        """The network is STOPPED: an axis in operation has to come to rest."""
        self.fsa.network_stopped()
        self.update()

    # ---- time --------------------------------------------------------------------------------------------------------

    def tick(self) -> None:
        """One millisecond."""
        self.limits.sample()
        self.encoder.sample()
        self._find_conditions()
        self._put_conditions()
        self.fsa.tick()
        self.mode.tick()
        self.motion.show()
        self.motion.show_velocity()
        self.limits.check()
        self._put_conditions()
        self.motor.tick()
        self._show()
        self.update()

    def drive(self) -> None:
        """Have the hardware make the steps of this tick, and hear what it has to say to the next one."""
        self._is_called = self.motor.drive()

    @property
    def is_armed(self) -> bool:
        """Whether the next tick can change anything."""
        return bool(
            self._is_called
            or self.encoder.velocity
            or self.motion.velocity
            or self.fsa.phase
            or (self.conditions - self.faults - self.answer.faults) & _OWN
            or self.mode.is_armed
            or self.motor.is_armed
        )

    # ---- conditions --------------------------------------------------------------------------------------------------

    def _find_conditions(self) -> None:
        """Those that the hardware reports, and those that the axis finds itself."""
        self._found = self.faults | self.answer.faults
        if self.motor.is_powered and self._is_stalled():
            self._found.add(Condition.STALL)
        if self.motor.is_powered and self._is_behind():
            self._found.add(Condition.FOLLOWING_ERROR)

    def _put_conditions(self) -> None:
        self.node.emcy.set_axis(self.number, self._found | self.limits.conditions)

    def _is_stalled(self) -> bool:
        """Stop on stall: faster than 20A4h, and the load has stopped the motor."""
        threshold = self.values.stop_on_stall
        speed = abs(self.motion.velocity)
        return bool(threshold) and speed > units.velocity(self.values, threshold) and not self.answer.load

    def _is_behind(self) -> bool:
        """Following error: the encoder lags the ramp by more than 6065h."""
        window = self.values.following_error_window
        lag = units.int32(self.motion.demand - self.motion.actual)  # positions wrap
        return bool(window) and abs(lag) > window

    # ---- what is shown -----------------------------------------------------------------------------------------------

    def _show(self) -> None:
        """Displays that follow in each tick."""
        values, answer = self.values, self.answer
        values.actual_load_value = answer.load
        values.driver_error_flags = self.node.emcy.driver_flags(self.conditions)
        values.pwm_scale_value = answer.pwm_scale
        values.measured_velocity = units.velocity_number(values, answer.velocity * units.PER_PPS)
        values.microstep_resolution_display = values.microstep_resolution
        values.acceleration_dimension_index = units.acceleration_index(values)

    def update(self) -> None:
        """Statusword, positions and outputs follow the state of the axis and of the module."""
        values = self.values
        self.motion.show()
        values.statusword = self._status()
        shown = (
            *(values.statusword, values.modes_of_operation_display, values.digital_inputs),
            *(values.position_demand_value, values.position_actual_value, values.velocity_actual_value),
        )
        if shown != self._shown:
            self._shown = shown
            self.node.value_changed(self.instance)
        self.motor.update()

    def _status(self) -> int:
        node = self.node
        status = node.pds_states[self.state].value | self.mode.status
        if Condition.SHUTDOWN_SWITCH not in node.emcy.conditions and Condition.UNDERVOLTAGE not in self.conditions:
            status |= _VOLTAGE_ENABLED
        if node.emcy.is_warned(self.conditions):
            status |= _WARNING
        if not node.values.tmcl_mode:
            status |= _REMOTE
        if self.limits.is_active:
            status |= _INTERNAL_LIMIT
        if self.motion.velocity:
            status |= _MOTOR_ACTIVITY
        if self.motion.is_backwards:
            status |= _DIRECTION
        return status
