"""The run LED and the error LED (CiA 303-3); the twin of `ods_led.c`.

For each, the pattern of highest priority whose reason holds shows; one that goes on to show is not started anew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .port import Can, Output
from .timing import US_PER_MS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..leds import Led, LedPattern
    from .node import Node

OUTPUTS = {"run": Output.RUN_LED, "error": Output.ERROR_LED}


class _State:
    def __init__(self, name: str, led: Led | None) -> None:
        self.output = OUTPUTS[name]
        self.patterns = led.patterns if led else ()
        self.timer = f"{name}_led"
        self.shown: tuple[LedPattern, str] | None = None
        self.phase = 0
        self.on = 0


class Leds:
    def __init__(self, node: Node, leds: Mapping[str, Led]) -> None:
        self._node = node
        self._leds = [_State(name, leds.get(name)) for name in OUTPUTS]

    def power_on(self) -> None:
        for state in self._leds:
            state.shown = None
            state.on = 0

    def put(self, *, all: bool) -> None:
        """Choose the patterns, step them, and tell the port the LEDs that have changed; at power-on all of them."""
        for state in self._leds:
            was_on = state.on
            self._show(state, self._choose(state))
            if all or was_on != state.on:
                self._node.port.output(state.output, 0, state.on)

    def is_due(self) -> bool:
        """Whether a phase ends now."""
        return any(self._node.timers.is_due(state.timer) for state in self._leds)

    def _choose(self, state: _State) -> tuple[LedPattern, str] | None:
        """The pattern that shows and its reason; None leaves the LED dark."""
        reasons = [(pattern, when) for pattern in state.patterns for when in pattern.when if self._holds(when)]
        return max(reasons, key=lambda reason: reason[0].priority, default=None)

    def _holds(self, when: str) -> bool:
        node = self._node
        match when:
            case "can_warning":
                return node.can.state >= Can.WARNING
            case "heartbeat_lost":
                return bool(node.heartbeat.lost)
            case "bus_off":
                return node.can.state == Can.BUS_OFF
            case "no_error":
                return True
        return node.nmt.state == when

    def _show(self, state: _State, chosen: tuple[LedPattern, str] | None) -> None:
        timers = self._node.timers
        if chosen != state.shown:
            state.shown = chosen
            timers.stop(state.timer)
            state.on = int(chosen is not None and chosen[0].steady == "on")
            if chosen is not None and chosen[0].phases:
                state.phase, state.on = 0, 1
                timers.start(state.timer, chosen[0].phases[0] * US_PER_MS)
        elif chosen is not None and timers.is_due(state.timer):
            phases = chosen[0].phases
            state.phase = (state.phase + 1) % len(phases)
            state.on = int(state.phase % 2 == 0)
            timers.repeat(state.timer, phases[state.phase] * US_PER_MS)
