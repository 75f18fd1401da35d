"""The state machine of an axis as the model of a device has it: states, commands, transitions. No code of a runtime."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from odsmith.model import Device
from odsmith.vocabulary import PdsState, Transition


@dataclass(frozen=True)
class Machine:
    device: Device

    @cached_property
    def states(self) -> dict[str, PdsState]:
        return {state.name: state for state in self.device.pds_states}

    def decode(self, statusword: int) -> str:
        """The one state that it shows."""
        (name,) = (state.name for state in self.device.pds_states if statusword & state.mask == state.value)
        return name

    def commands(self, word: int, before: int) -> Iterator[str]:
        """What a controlword commands, after another one, in the order in which it is tried."""
        risen = word & ~before
        for command in self.device.pds_commands:
            if word & command.mask == command.value and risen & command.edge == command.edge:
                yield command.name

    def find(self, state: str, by: str) -> Transition | None:
        """The transition that a command or an event takes."""
        return next((each for each in self.device.transitions if state in each.start and by in each.by), None)
