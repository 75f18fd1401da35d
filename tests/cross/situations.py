"""Situations of an axis: every state in which it can stay, and transitions that take time."""

from __future__ import annotations

from dataclasses import dataclass, replace

from tests.cross.oracle import Dialogue

OUT_OF_REACH = "not_ready_to_switch_on"
"""The one state in which no turn ends."""

Step = tuple[str, int]
"""The role of an entry and the value that is written there, or STALL and whether the hardware reports it for a tick."""

Steps = tuple[Step, ...]

STALL = "stall"


@dataclass(frozen=True)
class Situation:
    """The state of an axis and the steps that lead there from power-on. `is_slow`: transitions take time."""

    name: str
    state: str
    steps: Steps = ()
    then: Steps = ()  # behind a word with bit 7, if there is to be one
    option: int = 2  # quick stop option code
    is_slow: bool = False

    def with_bit_7(self) -> Situation:
        """The same, but that the word written last has bit 7, and is no command here."""
        return replace(self, name=f"{self.name}, bit 7 set", steps=(*self.steps, ("controlword", 0x80)))

    def play(self, dialogue: Dialogue, axis: int) -> None:
        """From power-on or reset node, with the default values."""
        for role, value in (("quick_stop_option_code", self.option), *self.steps, *self.then):
            if role == STALL:
                dialogue.fault(axis, STALL, holds=bool(value))
                dialogue.advance(1000)
            else:
                dialogue.write(axis, role, value)


def words(*controlwords: int) -> Steps:
    return tuple(("controlword", word) for word in controlwords)


SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP = 0x06, 0x07, 0x0F, 0x02

# A minute from the applied brake to the end of what waits for it, or from power to OPERATION ENABLED.
SLOW_BRAKE: Steps = (("brake_current_feed_release", 1), ("brake_delay_times_apply", 60000))
SLOW_POWER: Steps = (("enable_drive_delay_time", 60000),)

STALLED: Steps = ((STALL, 1),)
STALL_IS_OVER: Steps = ((STALL, 0),)

UP = words(SHUTDOWN, ENABLE)


ALL = (
    Situation("switch on disabled", "switch_on_disabled"),
    Situation("ready to switch on", "ready_to_switch_on", words(SHUTDOWN)),
    Situation("switched on", "switched_on", words(SHUTDOWN, SWITCH_ON)),
    Situation("operation enabled", "operation_enabled", UP),
    Situation("operation enabled, 605Ah = 6", "operation_enabled", UP, option=6),
    Situation("quick stop active, 605Ah = 2", "quick_stop_active", (*SLOW_BRAKE, *UP, *words(QUICK_STOP))),
    Situation("quick stop active, 605Ah = 6", "quick_stop_active", (*UP, *words(QUICK_STOP)), option=6),
    Situation("fault reaction active", "fault_reaction_active", (*SLOW_BRAKE, *UP, *STALLED)),
    Situation("fault", "fault", STALLED, STALL_IS_OVER),
    Situation("fault, its cause still there", "fault", STALLED),
    Situation("ready to switch on, slow power", "ready_to_switch_on", (*SLOW_POWER, *words(SHUTDOWN)), is_slow=True),
    Situation("switched on, powering up", "switched_on", (*SLOW_POWER, *UP), is_slow=True),
    Situation("operation enabled, slow brake", "operation_enabled", (*SLOW_BRAKE, *UP), is_slow=True),
    Situation("operation enabled, brake closing", "operation_enabled", (*SLOW_BRAKE, *UP, *words(7)), is_slow=True),
)

SITUATIONS = tuple(each for situation in ALL for each in (situation, situation.with_bit_7()))
