"""Why an axis does not do what it should: what is in the way, and what leads on.

Pure functions of the tables and of what was seen last, so that errors can say it without asking the device again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.words import PdsState

from .errors import EmergencyError, StateError, StateTimeoutError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from canopen.emcy import EmcyError

    from ..state_machine import PdsCommandInfo
    from .facts import Facts

_FACE: dict[str, str] = {
    PdsState.OPERATION_ENABLED: " by enable()",
    PdsState.SWITCH_ON_DISABLED: " by disable()",
}
"""How the methods of an axis lead to a state."""

STANDSTILL = "standstill"
MODE = "the mode of operation"
ACKNOWLEDGE = "the right set-point acknowledge"
"""What is waited for beside states."""

TOLD = (
    "controlword",
    "modes_of_operation",
    "modes_of_operation_display",
    "enable_drive_delay_time",
    "brake_delay_times_release",
    "brake_delay_times_apply",
)
"""The roles whose values say why an axis does not get on."""

NO_EMERGENCY = "a fault that came without an emergency, such as NMT STOPPED"

FAULTY = (PdsState.FAULT, PdsState.FAULT_REACTION_ACTIVE)


class Seen(NamedTuple):
    """A statusword and what it says. `flags` are the names of its bits in the mode, lower case."""

    state: str
    word: int
    flags: frozenset[str]

    def __str__(self) -> str:
        told = ", ".join(sorted(self.flags - _STATE_FLAGS)) or "no other bit"
        return f"{self.state}, statusword {self.word:04X}h: {told}"


_STATE_FLAGS = {"ready_to_switch_on", "switched_on", "operation_enabled", "fault", "quick_stop", "switch_on_disabled"}


def see(facts: Facts, word: int, mode: int) -> Seen:
    """What a statusword says in a mode."""
    state = facts.state_machine.decode(word) if facts.state_machine else None
    info = facts.modes.get(mode)
    members = info.statusword.__members__ if info and info.statusword else {}
    flags = frozenset(name.lower() for name, bit in members.items() if word & bit.value == bit.value)
    return Seen(state.name if state else f"an unknown state ({word:04X}h)", word, flags)


def emergency(facts: Facts, frame: EmcyError, seen: str = "") -> EmergencyError:
    """An EMCY frame in words."""
    row = facts.emergencies.find(frame.code, bytes(frame.data))
    return EmergencyError(row.axis if row else None, row, frame.code, frame.register, seen)


def last_fault(facts: Facts, axis: int, frames: Iterable[EmcyError], seen: str = "") -> EmergencyError | None:
    """The last emergency with the reaction of a fault, of this axis or of the whole device, since its last reset."""
    for frame in reversed(list(frames)):
        error = emergency(facts, frame, seen)
        row = error.emergency
        if not frame.code >> 8 and row and row.axis == axis:
            return None  # by a fault reset; that the whole device has no error any more takes no axis out of fault
        if frame.code >> 8 and row and row.reaction.startswith("fault") and row.axis in (axis, None):
            return error
    return None


def state_error(
    facts: Facts,
    axis: int,
    seen: Seen,
    wanted: str,
    frames: Iterable[EmcyError],
    told: Mapping[str, int] | None = None,
    timeout: float | None = None,
) -> StateError:
    """Why an axis is not in a state, or does not do what else is waited for.

    `told` are values by the roles of `TOLD`, as many as are known. With a `timeout` it is what came to its end.
    """
    blocked_by, next_step = _Case(facts, axis, seen, wanted, told or {}).blocked(frames)
    if timeout is None:
        return StateError(axis, seen.state, wanted, blocked_by, next_step)
    return StateTimeoutError(
        axis,
        seen.state,
        wanted,
        blocked_by,
        next_step,
        is_state=wanted not in (STANDSTILL, MODE, ACKNOWLEDGE),
        timeout=timeout,
        seen=str(seen),
    )


class _Case(NamedTuple):
    """An axis, how it is, what it should be, and what is known beside. Methods give what blocks and the next step."""

    facts: Facts
    axis: int
    seen: Seen
    wanted: str
    told: Mapping[str, int]

    def blocked(self, frames: Iterable[EmcyError]) -> tuple[str, str]:
        if self.wanted == MODE:
            return self._mode()
        if self.seen.state in FAULTY:
            return self._fault(frames)
        if "remote" not in self.seen.flags:
            return "bit 9 of the statusword (remote) is 0: the axis does not obey the controlword", "leave TMCL mode"
        if "voltage_enabled" not in self.seen.flags:
            return (
                "bit 4 of the statusword (voltage enabled) is 0: the motor supply or the enable input is missing",
                "switch them on, then enable()",
            )
        if self.wanted == STANDSTILL:
            return self._turning()
        if self.wanted == ACKNOWLEDGE:
            return self._handshake()
        if self.seen.state == PdsState.QUICK_STOP_ACTIVE:
            return (
                f"{self._label('quick_stop_option_code')} holds it there until it is told to go on",
                "disable(), or enable() where the code is 5 or 6",
            )
        return self._way()

    def _fault(self, frames: Iterable[EmcyError]) -> tuple[str, str]:
        fault = last_fault(self.facts, self.axis, frames)
        why = f"{fault.title}: {fault.cause.rstrip('.')}" if fault else NO_EMERGENCY
        remedy = f"{fault.remedy} Then " if fault else ""
        return f"bit 3 of the statusword (fault): {why}", f"{remedy}reset_fault()"

    # ---- on the way to a state ---------------------------------------------------------------------------------------

    def _way(self) -> tuple[str, str]:
        """The controlword has not said what leads on, or it has and that takes time."""
        machine = self.facts.state_machine
        route = machine.route(self.seen.state, self.wanted) if machine else None
        if not machine or not route:
            return f"no transition leads from {self.seen.state} to {self.wanted}", "disable(), which starts afresh"
        word, end = self.told.get("controlword"), route[0].end
        commands = [machine.commands[name] for name in route[0].by if name in machine.commands]
        is_told = word is not None and any(command.matches(word, 0) for command in commands)
        if not commands or (is_told and (delay := self._delay(end))):
            return delay if commands else "it is not ready yet", f"none but to wait: {end} comes of itself"
        names = " or ".join(route[0].by)
        said = "does not say" if word is None else f"is {word:04X}h: it {'says' if is_told else 'does not say'}"
        late = ", but the axis did not follow" if is_told else ""
        blocked_by = f"{self._label('controlword')} {said} {commands[0].name}, {_bits(commands[0])}{late}"
        return blocked_by, f"{names} to {end}{_FACE.get(self.wanted, '')}"

    def _delay(self, end: str) -> str:
        """What takes time once it was told (transitions 4 and 5); empty for what takes none."""
        if end == PdsState.OPERATION_ENABLED:
            roles = ("enable_drive_delay_time", "brake_delay_times_release")
            return f"it was told; power stage and brake take their time: {self._values(roles)}"
        if end == PdsState.SWITCHED_ON and self.seen.state == PdsState.OPERATION_ENABLED:
            first = f"{self._ramp()}, then " if "motor_activity" in self.seen.flags else ""
            return f"it was told; {first}the brake takes its time: {self._values(('brake_delay_times_apply',))}"
        return ""

    # ---- on the way to something else --------------------------------------------------------------------------------

    def _turning(self) -> tuple[str, str]:
        way_out = "quick_stop(), or wait longer"
        if self.seen.state != PdsState.OPERATION_ENABLED:
            way_out = "none but to wait"
        return f"bit 14 of the statusword (motor activity) is 1: {self._ramp()}", way_out

    def _ramp(self) -> str:
        mode = self.facts.modes.get(self.told.get("modes_of_operation_display", 0))
        role = mode.slow_down_ramp if mode else ""
        if self.seen.state == PdsState.QUICK_STOP_ACTIVE:
            role = "quick_stop_deceleration"
        return f"it slows down by {self._label(role)}" if role else "it slows down"

    def _handshake(self) -> tuple[str, str]:
        is_set = "set_point_acknowledge" in self.seen.flags
        blocked_by = (
            f"bit 12 of the statusword (set-point acknowledge) is {is_set:d} "
            f"{'after bit 4 was taken out of' if is_set else 'after bit 4 was set in'} {self._label('controlword')}"
        )
        modes = self._values(("modes_of_operation", "modes_of_operation_display"))
        return blocked_by, f"move again, if nobody else writes the controlword or the mode: {modes}"

    def _mode(self) -> tuple[str, str]:
        asked, shown = (self._values((role,)) for role in ("modes_of_operation", "modes_of_operation_display"))
        return f"{shown}, while {asked}", "set_mode() once more, if nobody else writes the mode"

    # ---- words -------------------------------------------------------------------------------------------------------

    def _label(self, role: str) -> str:
        entry = self.facts.find(role, self.axis)
        return entry.label if entry else f"the {role.replace('_', ' ')}"

    def _values(self, roles: Iterable[str]) -> str:
        """Objects by their names, with their values where these are known."""
        parts = []
        for role in roles:
            entry = self.facts.find(role, self.axis)
            if entry is not None:
                symbol = f" {entry.unit.symbol}" if entry.unit else ""
                parts.append(f"{entry.label} is {self.told[role]}{symbol}" if role in self.told else entry.label)
        return ", ".join(parts)


def _bits(command: PdsCommandInfo) -> str:
    """The bits of the controlword that give a command."""
    wanted = {1: command.value | command.edge, 0: command.mask & ~(command.value | command.edge)}
    words = []
    for level, mask in wanted.items():
        numbers = [str(bit) for bit in range(16) if mask >> bit & 1]
        if numbers:
            words.append(f"bit{'s' if len(numbers) > 1 else ''} {', '.join(numbers)} = {level}")
    return " and ".join(words)
