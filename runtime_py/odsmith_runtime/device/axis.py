"""An axis as the rest of the node sees it; the twin of `ods_axis.c`.

What moves it stands behind these functions; until the motion modules fill them, an axis rests in SWITCH ON DISABLED.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.words import Condition, PdsState

if TYPE_CHECKING:
    from .node import Node

# Bits of the statusword 6041h that no mode owns (CiA 402).
_VOLTAGE_ENABLED = 0x0010
_WARNING = 0x0080
_REMOTE = 0x0200


class Axis:
    """Axis `number`; `state` is the name of its PDS state."""

    def __init__(self, node: Node, number: int) -> None:
        self._node = node
        self.number = number
        self.values = node.od.axes[number]
        self.faults: set[str] = set()  # hardware conditions as they are
        self.conditions: set[str] = set()  # those that hold since the last tick
        self.state: str = PdsState.SWITCH_ON_DISABLED

    def reset(self) -> None:
        """As at power-on. The values of the axis have just been set."""
        self.conditions = set()
        self.state = PdsState.SWITCH_ON_DISABLED
        self.update()

    def written(self, effect: str) -> None:
        """A value of the axis was written. At rest an axis obeys nothing."""

    def react(self, reaction: str) -> None:
        """What an emergency does to the axis."""
        self.update()

    def network_stopped(self) -> None:
        """The network is STOPPED: axes in operation have to come to rest."""
        self.update()

    def tick(self) -> None:
        """One millisecond."""
        self._node.emcy.set_axis(self.number, self.faults)
        self.update()

    @property
    def is_armed(self) -> bool:
        """Whether the next tick can change anything."""
        return self.faults != self.conditions

    def update(self) -> None:
        """The statusword follows the state of the axis and of the module."""
        node = self._node
        status = node.pds_states[self.state].value
        if Condition.SHUTDOWN_SWITCH not in node.emcy.conditions and Condition.UNDERVOLTAGE not in self.conditions:
            status |= _VOLTAGE_ENABLED
        if node.emcy.is_warned(self.conditions):
            status |= _WARNING
        if not node.values.tmcl_mode:
            status |= _REMOTE
        if self.values.statusword != status:
            self.values.statusword = status
            node.value_changed(node.od.instances[node.od.first["axis"] + self.number])
