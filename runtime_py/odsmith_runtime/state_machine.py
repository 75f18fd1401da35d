"""The state machine of a drive (PDS FSA, CiA 402) as tables and the few questions that they answer."""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

    from .rows import Named


class PdsStateInfo(Row):
    """A state: it is the one where `statusword & mask == value`. `power` says whether the motor is powered in it."""

    name: str
    title: str
    mask: int
    value: int
    power: bool
    text: str = ""
    source: str = ""


class PdsCommandInfo(Row):
    """A command: given by a controlword with `controlword & mask == value` whose `edge` bits have just risen."""

    name: str
    title: str
    mask: int
    value: int
    edge: int
    text: str = ""
    source: str = ""

    def apply(self, controlword: int) -> int:
        """The controlword that gives this command and keeps all other bits.

        A command with an edge acts only if these bits were 0 in the controlword written before.
        """
        return controlword & ~self.mask | self.value | self.edge

    def matches(self, controlword: int, before: int) -> bool:
        """True where writing `controlword` after `before` gives this command."""
        return controlword & self.mask == self.value and controlword & ~before & self.edge == self.edge


class Transition(Row):
    """A transition from any state of `start` (none: power-on) to `end`, by any of these commands or events."""

    number: int
    start: tuple[str, ...]
    end: str
    by: tuple[str, ...]
    text: str = ""
    source: str = ""


class StateMachine:
    """States, commands and events by name, and the transitions."""

    def __init__(
        self,
        states: Mapping[str, PdsStateInfo],
        commands: Mapping[str, PdsCommandInfo],
        events: Mapping[str, Named],
        transitions: tuple[Transition, ...],
    ) -> None:
        self.states = states
        self.commands = commands
        self.events = events
        self.transitions = transitions

    def decode(self, statusword: int) -> PdsStateInfo | None:
        """The state that a statusword shows; None for a pattern that is none."""
        for state in self.states.values():
            if statusword & state.mask == state.value:
                return state
        return None

    def leaving(self, state: str) -> tuple[Transition, ...]:
        """The transitions that lead out of a state, by commands and by events."""
        return tuple(transition for transition in self.transitions if state in transition.start)

    def next_states(self, state: str) -> tuple[str, ...]:
        """The states that can follow a state."""
        return tuple(dict.fromkeys(transition.end for transition in self.leaving(state)))

    def command(self, start: str, end: str) -> PdsCommandInfo | None:
        """A command that leads from one state directly to another, if there is one."""
        for transition in self.leaving(start):
            if transition.end == end:
                for name in transition.by:
                    if name in self.commands:
                        return self.commands[name]
        return None

    def route(self, start: str, end: str) -> tuple[Transition, ...] | None:
        """The shortest way from one state to another by commands and by events that come of themselves.

        Empty where both are the same, None where no way leads there. The event `fault` is no way to go.
        """
        routes: dict[str, tuple[Transition, ...]] = {start: ()}
        queue = [start]
        while queue and end not in routes:
            state = queue.pop(0)
            for transition in self.leaving(state):
                if transition.end not in routes and transition.by != ("fault",):
                    routes[transition.end] = (*routes[state], transition)
                    queue.append(transition.end)
        return routes.get(end)
