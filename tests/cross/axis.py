"""What an axis must do while it stands, and what is sure of one that moves: the third judge's knowledge of axes.

Worked out from the model, which has the state machine, and from the section "Axes" of CONTRACT.md; it shares no code
with a runtime. An axis stands until its mode has somewhere to go and nothing holds it back. From then on the judge
leaves out what only the ramps could tell it: positions, speeds, what the driver measures (`BY_POSITION`, `BY_DRIVER`),
limits that depend on a position, and the bits 10, 11, 14 and 15 of the statusword as far as they follow from these.
The state it still knows, until that depends on when the axis comes to rest or on what it meets on its way: there it
gives up with `Astray`.

Hardware without switches, encoder and load is assumed: it measures nothing, and all lines are low.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

from tests.cross.pds import Machine

from odsmith.model import Device, Emergency
from odsmith.vocabulary import Transition

# Bits of the words (CiA 402; bits 14 and 15: M 6.1.2).
SET_POINT, RELATIVE, HALT = 0x0010, 0x0040, 0x0100
VOLTAGE, WARNING, REMOTE, REACHED, LIMIT, ACKNOWLEDGED, FOLLOWING_ERROR, MOVES, BACKWARDS = (
    1 << bit for bit in (4, 7, 9, 10, 11, 12, 13, 14, 15)
)

# Bits of the digital inputs 60FDh, each with those of 2005h that leave a switch out and turn it round (M 3.2.5).
LEFT, RIGHT, HOME = 1, 2, 4
SWITCHES = ((LEFT, 0x01, 0x04), (RIGHT, 0x02, 0x08), (HOME, 0x10, 0x20))

LOWEST, HIGHEST = -0x80000000, 0x7FFFFFFF

SOFTWARE_LIMITS = frozenset({"software_limit_negative", "software_limit_positive"})
LIMIT_SWITCHES = {LEFT: "limit_switch_negative", RIGHT: "limit_switch_positive"}
TO_THE_LEFT = frozenset({"software_limit_negative", "limit_switch_negative"})
TO_THE_RIGHT = frozenset({"software_limit_positive", "limit_switch_positive"})

FAULTS = ("fault_ramp", "fault_off")
"""Reactions."""

BY_POSITION = (
    *("position_demand_value", "position_actual_internal_value", "position_actual_value", "velocity_actual_value"),
    *("step_counter_low", "step_counter_high", "step_counter_value"),
    *("latched_internal_position", "latched_encoder_position"),
)
"""Roles that nobody knows without the ramps, once the axis has moved, until reset node."""

BY_DRIVER = ("actual_load_value", "pwm_scale_value", "measured_velocity")
"""Roles that the hardware gives: what it has measured last it remembers until power-on."""


class Astray(Exception):  # noqa: N818  (no error either)
    """What comes next depends on a motion."""


class Module(Protocol):
    """What an axis has to know of the module that it belongs to."""

    @property
    def conditions(self) -> frozenset[str]:
        """Those of the whole device that hold."""
        ...

    def mode(self, role: str) -> bool: ...

    def raised(self, row: Emergency) -> None:
        """A condition of an axis begins."""
        ...

    def get(self, axis: int, role: str) -> int:
        """A value of an axis; 0 where the device has no such entry."""
        ...

    def put(self, axis: int, role: str, value: int) -> None: ...


@dataclass
class Axis:
    """`faults` are the conditions that the hardware reports."""

    device: Device
    module: Module
    number: int
    faults: frozenset[str] = frozenset()
    has_run: bool = False  # since power-on
    machine: Machine = field(init=False)

    def __post_init__(self) -> None:
        self.machine = Machine(self.device)
        self.modes = {mode.name: mode.code for mode in self.device.modes}
        self.reset()

    def reset(self) -> None:
        """As at power-on."""
        self.state = "switch_on_disabled"
        self.has_power = False
        self.phase = ""  # what a transition waits for: powering, releasing, applying
        self.left = 0  # ticks of it
        self.has_begun = False  # in this tick, which is none of them
        self.stays = False  # after the quick stop that is active
        self.word = self.before = 0
        self.waits = False  # `word`, which came after `before`, for the end of a transition
        self.conditions: frozenset[str] = frozenset()
        self.limits: frozenset[str] = frozenset()  # those found by the last tick
        self.doubtful: frozenset[str] = frozenset()  # limits that may hold or not
        self.moves = self.has_moved = False  # or may do so, or may have done so since reset node
        self.homing_is_called = self.homing_runs = False
        self.homing_bits: int | None = 0  # None: nobody knows; so below
        self.offset_is_known = True  # 2100h
        self.has_index = False
        self.given_for: int | None = None  # the mode of a set-point that came since the last tick
        self.forget()

    def forget(self) -> None:
        """Set-points."""
        self.has_target = self.follows = self.is_acknowledged = False
        self.target: int | None = 0
        self.is_clamped: bool | None = False
        self.is_reached: bool | None = False
        self.inside = 0

    def get(self, role: str) -> int:
        return self.module.get(self.number, role)

    def put(self, role: str, value: int) -> None:
        self.module.put(self.number, role, value)

    def is_in(self, mode: str) -> bool:
        """6061h."""
        return mode in self.modes and self.get("modes_of_operation_display") == self.modes[mode]

    def is_asked_for(self, mode: str) -> bool:
        """6060h."""
        return mode in self.modes and self.get("modes_of_operation") == self.modes[mode]

    @property
    def is_enabled(self) -> bool:
        """Whether it obeys its mode."""
        return self.state == "operation_enabled" and not self.phase

    # ---- the state machine (contract, "State machine") ---------------------------------------------------------------

    def command(self, word: int) -> list[tuple[str, Transition]]:
        """6040h is written. The commands that lead somewhere at once, and where."""
        before, self.word = self.word, word
        if self.phase and self.state in ("switched_on", "operation_enabled"):
            self.before, self.waits = before, True
            return []
        return self.obey(word, before)

    def obey(self, word: int, before: int) -> list[tuple[str, Transition]]:
        taken = []
        for command in self.machine.commands(word, before):
            transition = self.machine.find(self.state, command)
            if transition is not None and not self.refuses(transition):
                taken.append((command, transition))
                self.take(transition)
        self.obey_mode(word, before)
        return taken

    def refuses(self, transition: Transition) -> bool:
        """15 while there is a cause; 16 after a quick stop that ends."""
        causes = self.conditions | self.module.conditions
        return (transition.number == 15 and any(row.reaction in FAULTS for row in self.rows(causes))) or (
            transition.number == 16 and not self.stays
        )

    def take(self, transition: Transition) -> None:
        match transition.number:
            case 4:
                self.has_power = True
                self.wait("powering", self.get("enable_drive_delay_time"))
            case 5:
                self.slow_down()
            case 11:
                self.state = transition.end
                self.stays = self.option.endswith("_stay")
                if not self.stays:
                    self.slow_down()
            case 16:
                self.enable()
            case _:
                self.power_off()
                self.state = transition.end

    @property
    def option(self) -> str:
        """605Ah."""
        return self._options[self.get("quick_stop_option_code")]

    @cached_property
    def _options(self) -> dict[int, str]:
        entries = [entry for obj in self.device.objects for entry in obj.entries]
        codes = [entry.values for entry in entries if entry.role == "quick_stop_option_code"]
        return {each.value: each.name for values in codes for each in values}

    def follow(self, event: str) -> bool:
        transition = self.machine.find(self.state, event)
        if transition is not None:
            self.state = transition.end
        return transition is not None

    def fault(self, *, off: bool) -> None:
        """Transition 13; with the driver off at once 14 follows."""
        is_new = self.follow("fault")
        if not is_new and not (off and self.state == "fault_reaction_active"):
            return
        self.waits = False
        if off or not self.has_power:
            self.power_off()
            self.follow("fault_reaction_done")
        else:
            self.slow_down()

    def network_stopped(self) -> None:
        """Those in operation or on the way there."""
        if self.state == "operation_enabled" or self.phase in ("powering", "releasing"):
            self.fault(off=False)

    def slow_down(self) -> None:
        """At rest the brake is applied, before the power goes off."""
        if self.moves:
            raise Astray
        self.wait("applying", self.get("brake_delay_times_apply") if self.has_brake else 0)

    def power_off(self) -> None:
        self.has_power = self.moves = False
        self.phase = ""

    @property
    def has_brake(self) -> bool:
        return bool(self.get("brake_current_feed_apply") or self.get("brake_current_feed_release"))

    def wait(self, phase: str, ticks: int) -> None:
        self.phase, self.left, self.has_begun = phase, ticks, True
        if not ticks:
            self.go_on()

    def go_on(self) -> None:
        """What the axis has waited for is over."""
        match self.phase:
            case "powering":
                self.wait("releasing", self.get("brake_delay_times_release") if self.has_brake else 0)
            case "releasing":
                self.enable()
            case "applying":
                self.power_off()
                if self.follow("disable_operation"):
                    self.work_off()
                else:
                    self.follow("quick_stop_done") or self.follow("fault_reaction_done")

    def enable(self) -> None:
        self.phase, self.state = "", "operation_enabled"
        self.forget()
        if self.homing_runs:
            self.homing_runs = False
            self.homing_bits = None
        self.work_off()

    def work_off(self) -> None:
        """The word that waits."""
        if self.waits:
            self.waits = False
            self.obey(self.word, self.before)

    # ---- set-points (contract, "Modes", "Homing") --------------------------------------------------------------------

    def obey_mode(self, word: int, before: int) -> None:
        """Bit 4 of the controlword."""
        is_set, has_risen = bool(word & SET_POINT), bool(word & ~before & SET_POINT)
        if self.is_asked_for("homing") and (has_risen or not is_set):
            self.homing_is_called = is_set
        if not is_set:
            self.is_acknowledged = False
        elif has_risen and self.is_enabled and self.is_asked_for("profile_position"):
            target = self.get("target_position")
            start = self.start() if word & RELATIVE else 0
            self.clamp(None if start is None else start + target)
            self.has_target = self.is_acknowledged = True
            self.is_reached = False
            self.inside = 0
            self.given_for = self.modes["profile_position"]

    def start(self) -> int | None:
        """What a relative target counts from (60F2h). All positions are 0 before an axis moves."""
        if self.get("positioning_option_code") == 0 and self.has_target:
            return self.target
        return None if self.has_moved else 0

    def clamp(self, target: int | None) -> None:
        low, high = self.allowed
        if target is None or not self.offset_is_known:
            self.target = self.is_clamped = None
        else:
            self.target = min(max(target, low, LOWEST), max(high, LOWEST), HIGHEST)
            self.is_clamped = self.target != target

    @property
    def allowed(self) -> tuple[int, int]:
        """The software limits."""
        offset = self.get("home_offset_display")
        low, high = (self.get(f"software_position_limit_{end}") for end in ("minimum", "maximum"))
        return low - offset, high - offset

    def written(self, role: str) -> None:
        """A value has changed: what does not wait for the tick."""
        if role == "controlword":
            self.command(self.get(role))
        if role == "target_position":
            self.set_point("cyclic_synchronous_position")
        if role == "target_velocity":
            self.set_point("cyclic_synchronous_velocity")
        if role in ("position_window", "position_window_time"):
            self.inside = 0
            self.is_reached = False

    def set_point(self, mode: str) -> None:
        """Of a cyclic mode."""
        if self.is_enabled and self.is_asked_for(mode):
            self.follows = True
            self.given_for = self.modes[mode]

    # ---- a tick (contract, "Conditions and reactions") ---------------------------------------------------------------

    def tick(self) -> None:
        self.has_begun = False
        self.read_switches()
        self.read_index()
        self.set_conditions()
        if self.phase and not self.has_begun:
            self.left -= 1
            if not self.left:
                self.go_on()
        self.change_mode()
        self.move()
        self.check_limits()
        self.set_conditions()
        self.display()
        self.given_for = None
        self.homing_is_called = False

    def read_switches(self) -> None:
        """All lines are low: a switch is active if it counts and is turned round."""
        parameters = self.get("switch_parameters")
        active = (bit for bit, left_out, turned in SWITCHES if parameters & turned and not parameters & left_out)
        self.put("digital_inputs", sum(active))

    def read_index(self) -> None:
        """It is low, too; where it begins 200Fh latches."""
        is_active = not self.get("encoder_polarity") & 1
        if is_active and not self.has_index and self.get("encoder_latch_mode") & 3:
            self.put("latched_internal_position", 0)
            self.put("latched_encoder_position", 0)
            self.put("encoder_latch_mode", self.get("encoder_latch_mode") & ~1)
        self.has_index = is_active

    def set_conditions(self) -> None:
        found = self.faults | self.limits
        if self.may_find_a_fault or any(row.reaction in FAULTS for row in self.rows(self.doubtful)):
            raise Astray
        begun, self.conditions = found - self.conditions, found
        for row in self.rows(begun):
            self.module.raised(row)
            if row.reaction in FAULTS:
                self.fault(off=row.reaction == "fault_off")

    @property
    def may_find_a_fault(self) -> bool:
        """Stall and following error."""
        has_encoder = bool(self.get("encoder_increments"))
        is_behind = self.has_moved and has_encoder and bool(self.get("following_error_window"))
        return self.has_power and (is_behind or (self.moves and bool(self.get("stop_on_stall"))))

    def rows(self, conditions: frozenset[str]) -> Iterator[Emergency]:
        return (row for row in self.device.emergencies if row.condition in conditions)

    def change_mode(self) -> None:
        asked = self.get("modes_of_operation")
        if asked != self.get("modes_of_operation_display"):
            self.put("modes_of_operation_display", asked)
            self.homing_runs = False
            self.homing_bits = 0
            if self.given_for != asked:
                self.forget()

    def move(self) -> None:
        if self.is_in("homing") and self.homing_is_called:
            self.start_homing()
        is_halted = bool(self.get("controlword") & HALT) and not self.is_in("homing")
        if self.is_enabled and not is_halted:
            if self.is_in("cyclic_synchronous_position") and self.follows:
                self.clamp(self.get("target_position") + self.get("position_offset"))
            if self.heads() not in self.blocked:
                self.moves = self.has_moved = self.has_run = True
        self.judge()

    def start_homing(self) -> None:
        number = self.get("homing_method")
        method = next((method for method in self.device.homing_methods if method.method == number), None)
        if method is None or (method.needs_power and not self.is_enabled):
            return
        if method.needs_power:
            self.homing_runs, self.homing_bits, self.offset_is_known = True, None, False
        elif number:
            self.homing_runs, self.homing_bits, self.offset_is_known = False, REACHED | ACKNOWLEDGED, True
            self.put("home_offset_display", self.get("home_offset"))

    def heads(self) -> int | None:
        """The direction in which the axis is to move; None: some direction."""
        if self.is_in("profile_position") and self.has_target:
            return self.towards(self.target)
        if self.is_in("profile_velocity") and self.get("profile_acceleration"):
            return sign(self.get("target_velocity"))
        if self.is_in("homing") and self.homing_runs:
            return None
        if self.is_in("cyclic_synchronous_position") and self.follows:
            return self.towards(self.target)
        if self.is_in("cyclic_synchronous_velocity") and self.follows:
            return sign(self.get("target_velocity") + self.get("velocity_offset"))
        return 0

    def towards(self, target: int | None) -> int | None:
        return None if target is None or self.has_moved else sign(target)

    @property
    def blocked(self) -> set[int]:
        """Where it does not go."""
        inputs = 0 if self.is_in("homing") else self.get("digital_inputs")
        blocked = {0}
        if inputs & LEFT or self.conditions & TO_THE_LEFT:
            blocked.add(-1)
        if inputs & RIGHT or self.conditions & TO_THE_RIGHT:
            blocked.add(1)
        return blocked

    def judge(self) -> None:
        """Bit 10 in the profile modes."""
        if self.is_in("profile_position"):
            self.is_reached = self.is_at_target() if self.has_target else not self.moves or None
        elif self.is_in("profile_velocity"):
            self.is_reached = None if self.moves else not self.get("target_velocity")
        else:
            self.is_reached = False

    def is_at_target(self) -> bool | None:
        window = self.get("position_window")
        if self.has_moved or self.target is None:
            return None
        if window in (0, 0xFFFFFFFF):
            return self.target == 0
        if abs(self.target) > window:
            self.inside = 0
            return False
        is_long = self.inside >= self.get("position_window_time")
        self.inside += not is_long
        return is_long

    def check_limits(self) -> None:
        if self.is_in("homing"):
            self.limits = self.doubtful = frozenset()
            return
        inputs = self.get("digital_inputs")
        switches = {name for bit, name in LIMIT_SWITCHES.items() if inputs & bit}
        low, high = self.allowed
        if not self.offset_is_known:
            self.limits, self.doubtful = frozenset(switches), SOFTWARE_LIMITS
            return
        passed = {name for name, holds in zip(sorted(SOFTWARE_LIMITS), (low > 0, high < 0), strict=True) if holds}
        may_be = {
            name
            for name, holds in zip(sorted(SOFTWARE_LIMITS), (low > LOWEST, high < HIGHEST), strict=True)
            if holds and self.has_moved
        }
        self.limits, self.doubtful = frozenset(switches | passed - may_be), frozenset(may_be)

    # ---- what is shown -----------------------------------------------------------------------------------------------

    def display(self) -> None:
        self.put("driver_error_flags", self.flags(self.conditions))
        self.put("microstep_resolution_display", self.get("microstep_resolution"))
        self.put("acceleration_dimension_index", 179 if self.get("velocity_dimension_index") else 0)

    def flags(self, conditions: frozenset[str]) -> int:
        flags = 0
        for row in self.rows(conditions):
            flags |= row.driver_flag
        return flags

    def statusword(self) -> tuple[int, int]:
        """It, and which of its bits nobody knows."""
        known, unknown = self.machine.states[self.state].value, 0
        for bit, holds in self.bits():
            known |= bit if holds else 0
            unknown |= bit if holds is None else 0
        return known, unknown & ~known

    def bits(self) -> Iterator[tuple[int, bool | None]]:
        yield VOLTAGE, "shutdown_switch" not in self.module.conditions and "undervoltage" not in self.conditions
        yield WARNING, any(row.reaction == "warning" for row in self.rows(self.conditions))
        yield REMOTE, not self.module.mode("tmcl_mode")
        yield LIMIT, bool(self.conditions & (TO_THE_LEFT | TO_THE_RIGHT)) or (None if self.doubtful else False)
        yield MOVES, None if self.moves else False
        yield BACKWARDS, None if self.has_moved else False
        yield FOLLOWING_ERROR, self.is_in("cyclic_synchronous_position") and "following_error" in self.conditions
        if self.is_in("homing"):
            for bit in (REACHED, ACKNOWLEDGED):
                yield bit, None if self.homing_bits is None else bool(self.homing_bits & bit)
        elif self.is_enabled:
            yield LIMIT, self.is_clamped
            yield REACHED, self.is_reached
            yield ACKNOWLEDGED, self.is_acknowledged or self.follows

    def unknown(self, role: str) -> int:
        """Bits of a value that nobody knows."""
        if role == "statusword":
            return self.statusword()[1]
        if role == "driver_error_flags":
            return self.flags(self.doubtful) & ~self.flags(self.conditions)
        is_unknown = (
            (role in BY_POSITION and self.has_moved)
            or (role in BY_DRIVER and self.has_run)
            or (role == "home_offset_display" and not self.offset_is_known)
        )
        return -1 if is_unknown else 0


def sign(number: int) -> int:
    return (number > 0) - (number < 0)
