"""The state machine of an axis (PDS FSA, CiA 402); the twin of `ods_fsa.c`.

Which command or event leads from where to where is in the device's table. Here is what a transition does, and what
makes it take time: power stage and brake have delays, and an axis that moves has to come to rest before its power goes
off. While a commanded transition takes time, the last controlword written waits for its end (manual, section 6.1).
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

from odsmith_cia.words import Condition, PdsCommand, PdsEvent, PdsState

if TYPE_CHECKING:
    from ..state_machine import StateMachine
    from .axis import Axis


class Phase(IntEnum):
    """What a transition waits for."""

    NONE = 0
    POWERING = 1  # the power stage has to build up its current (200Ah)
    RELEASING = 2  # the brake has to open (2002h:02)
    SLOWING = 3  # the axis has to come to rest
    APPLYING = 4  # the brake has to close (2002h:01)


class Stop(IntEnum):
    """Whether the state machine stops the axis, and on which slope."""

    NONE = 0
    MODE_RAMP = 1  # the slow-down ramp of the mode
    QUICK_STOP_RAMP = 2  # 6085h


# Quick stop option codes (605Ah, CiA 402): those with the ramp of the mode, and those after which the axis stays.
_ON_MODE_RAMP = (1, 5)
_STAYING = (5, 6)


_FROM_ENCODER = 0x01  # 200Bh:03


class Fsa:
    def __init__(self, axis: Axis, machine: StateMachine | None) -> None:
        self._axis = axis
        self._machine = machine
        self._ends = {
            (start, by): transition.end
            for transition in (machine.transitions if machine else ())
            for start in transition.start
            for by in transition.by
        }
        self.reset()

    def reset(self) -> None:
        """As at power-on: transitions 0 and 1."""
        self.state: str = PdsState.SWITCH_ON_DISABLED
        self.phase = Phase.NONE
        self.stop = Stop.NONE
        self._goal = ""  # of transition 5, while it takes time
        self._delay = 0  # ticks that the phase still takes
        self._begun = 0  # the instant at which it began: that tick does not count
        self._quick_stop = 0  # option code of the quick stop that is active
        self._word = 0  # the last controlword
        self._before = 0  # the one before it, while it waits
        self._is_waiting = False

    @property
    def is_enabled(self) -> bool:
        """Whether the axis obeys its mode."""
        return self.state == PdsState.OPERATION_ENABLED and self.phase == Phase.NONE

    # ---- events ------------------------------------------------------------------------------------------------------

    def command(self, word: int) -> None:
        """A controlword was written."""
        before, self._word = self._word, word
        if self.phase and self.state in (PdsState.SWITCHED_ON, PdsState.OPERATION_ENABLED):
            self._before, self._is_waiting = before, True
        else:
            self._decode(word, before)

    def fault(self, off: bool) -> None:
        """Transition 13, for an emergency or the NMT state; `off`: there is no power left to brake with."""
        if self.state == PdsState.FAULT_REACTION_ACTIVE:
            if off:
                self._power_off()
                self._follow(PdsEvent.FAULT_REACTION_DONE)
            return
        if not self._follow(PdsEvent.FAULT):
            return
        self._is_waiting = False
        if off or not self._axis.motor.is_powered:
            self._power_off()
            self._follow(PdsEvent.FAULT_REACTION_DONE)
        else:
            self._slow_down(Stop.QUICK_STOP_RAMP)

    def network_stopped(self) -> None:
        """The NMT state STOPPED makes an axis faulty that is in operation (manual, section 2.2), or on its way there.

        One that is powering up would be enabled when no command reaches it any more.
        """
        if self.state == PdsState.OPERATION_ENABLED or self.phase in (Phase.POWERING, Phase.RELEASING):
            self.fault(off=False)

    def tick(self) -> None:
        if self.phase == Phase.SLOWING:
            if not self._axis.motion.velocity:
                self._at_rest()
        elif self.phase and self._begun != self._axis.node.timers.now:
            self._delay -= 1
            if not self._delay:
                {Phase.POWERING: self._release, Phase.RELEASING: self._enabled, Phase.APPLYING: self._held}[
                    self.phase
                ]()

    # ---- the controlword ---------------------------------------------------------------------------------------------

    def _decode(self, word: int, before: int) -> None:
        """All commands that the word gives, in the order of the table: 3 and 4 may follow each other in one turn."""
        if self._machine is not None:
            for command in self._machine.commands.values():
                if command.matches(word, before):
                    self._obey(command.name)
        self._axis.mode.control(word, before)

    def _obey(self, command: str) -> None:
        axis = self._axis
        end = self._ends.get((self.state, command))
        if end is None:
            return
        if command == PdsCommand.FAULT_RESET:
            if axis.node.emcy.has_fault_cause(axis.conditions):
                return
            axis.node.emcy.raise_(Condition.FAULT_RESET, axis.number)
        if end == PdsState.OPERATION_ENABLED:
            if self.state == PdsState.SWITCHED_ON:
                self._power_on()
            elif self._quick_stop in _STAYING:
                self._enabled()
        elif end == PdsState.QUICK_STOP_ACTIVE:
            self._stop_quickly()
        elif end == PdsState.SWITCHED_ON and self.state == PdsState.OPERATION_ENABLED:
            self._goal = end
            self._slow_down(Stop.MODE_RAMP)
        else:
            self._power_off()
            self.state = end

    def _follow(self, event: str) -> bool:
        """Take the transition that an event leads to, if there is one."""
        end = self._ends.get((self.state, event))
        if end is None:
            return False
        self.state = end
        return True

    # ---- power up: transition 4 --------------------------------------------------------------------------------------

    def _power_on(self) -> None:
        self._axis.motor.power_on()
        if self._axis.values.encoder_init_position & _FROM_ENCODER:
            self._axis.motion.start_from_encoder()
        self._wait(Phase.POWERING, self._axis.values.enable_drive_delay_time)

    def _release(self) -> None:
        motor, values = self._axis.motor, self._axis.values
        motor.is_released = True
        self._wait(Phase.RELEASING, values.brake_delay_times_release if motor.has_brake else 0)

    def _enabled(self) -> None:
        self.phase = Phase.NONE
        self.stop = Stop.NONE
        self.state = PdsState.OPERATION_ENABLED
        self._axis.mode.enabled()
        self._work_off()

    # ---- power down --------------------------------------------------------------------------------------------------

    def _stop_quickly(self) -> None:
        self.state = PdsState.QUICK_STOP_ACTIVE
        self._quick_stop = self._axis.values.quick_stop_option_code
        stop = Stop.MODE_RAMP if self._quick_stop in _ON_MODE_RAMP else Stop.QUICK_STOP_RAMP
        if self._quick_stop in _STAYING:
            self.stop = stop
        else:
            self._slow_down(stop)

    def _slow_down(self, stop: Stop) -> None:
        self.stop = stop
        self.phase = Phase.SLOWING
        if not self._axis.motion.velocity:
            self._at_rest()

    def _at_rest(self) -> None:
        motor, values = self._axis.motor, self._axis.values
        motor.is_released = False
        self._wait(Phase.APPLYING, values.brake_delay_times_apply if motor.has_brake else 0)

    def _held(self) -> None:
        """The brake holds the load, the power stage may go off."""
        self._power_off()
        if self.state == PdsState.OPERATION_ENABLED:
            self.state = self._goal
            self._work_off()
        elif not self._follow(PdsEvent.QUICK_STOP_DONE):
            self._follow(PdsEvent.FAULT_REACTION_DONE)

    def _power_off(self) -> None:
        self.phase = Phase.NONE
        self.stop = Stop.NONE
        self._axis.motor.power_off()
        self._axis.motion.halt()

    # ---- time --------------------------------------------------------------------------------------------------------

    def _wait(self, phase: Phase, ticks: int) -> None:
        """Go on with what follows a phase: now, or so many ticks later."""
        self.phase = phase
        self._delay = ticks
        self._begun = self._axis.node.timers.now
        if ticks:
            self._axis.node.timers.arm_tick()
        else:
            self._go_on()

    def _go_on(self) -> None:
        """The phase is over."""
        match self.phase:
            case Phase.POWERING:
                self._release()
            case Phase.RELEASING:
                self._enabled()
            case Phase.APPLYING:
                self._held()

    def _work_off(self) -> None:
        """A transition is complete: the word that waited for it is decoded."""
        if self._is_waiting:
            self._is_waiting = False
            self._decode(self._word, self._before)
