"""Why an axis does not do what it should: what is in the way, and what leads on.

Pure functions of the tables and of what was seen last, so that errors can say it without asking the device again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.words import PdsState

from .errors import EmergencyError, StateError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canopen.emcy import EmcyError

    from .facts import Facts

_FACE: dict[str, str] = {
    PdsState.OPERATION_ENABLED: " by enable()",
    PdsState.SWITCH_ON_DISABLED: " by disable()",
}
"""How the methods of an axis lead to a state."""

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
    """The last emergency with the reaction of a fault, of this axis or of the whole device."""
    for frame in reversed(list(frames)):
        error = emergency(facts, frame, seen)
        row = error.emergency
        if frame.code >> 8 and row and row.reaction.startswith("fault") and row.axis in (axis, None):
            return error
    return None


def state_error(facts: Facts, axis: int, seen: Seen, wanted: str, frames: Iterable[EmcyError]) -> StateError:
    """Why an axis is not in a state."""
    blocked_by, next_step = _blocked(facts, axis, seen, wanted, frames)
    return StateError(axis, seen.state, wanted, blocked_by, next_step)


def _blocked(facts: Facts, axis: int, seen: Seen, wanted: str, frames: Iterable[EmcyError]) -> tuple[str, str]:
    if seen.state in FAULTY:
        fault = last_fault(facts, axis, frames)
        why = (
            f"{fault.title}: {fault.cause.rstrip('.')}"
            if fault
            else "a fault that came without an emergency, such as NMT STOPPED"
        )
        remedy = f"{fault.remedy} Then " if fault else ""
        return f"bit 3 of the statusword (fault): {why}", f"{remedy}reset_fault()"
    if "remote" not in seen.flags:
        return "bit 9 of the statusword (remote) is 0: the axis does not obey the controlword", "leave TMCL mode"
    if "voltage_enabled" not in seen.flags:
        return (
            "bit 4 of the statusword (voltage enabled) is 0: the motor supply or the enable input is missing",
            "switch them on, then enable()",
        )
    if seen.state == PdsState.QUICK_STOP_ACTIVE:
        entry = facts.find("quick_stop_option_code", axis)
        name = entry.label if entry else "the quick stop option code"
        return f"{name} holds it there until it is told to go on", "disable(), or enable() where the code is 5 or 6"
    return "the drive takes its time, or was not told", _step(facts, seen.state, wanted)


def _step(facts: Facts, state: str, wanted: str) -> str:
    """The next legal step on the way to a state."""
    route = facts.state_machine.route(state, wanted) if facts.state_machine else None
    if not route:
        return "none leads there"
    names = " or ".join(route[0].by)
    face = _FACE.get(wanted, "")
    return f"{names} to {route[0].end}{face}"
