"""What the CAN controller reports: its state and its losses; the twin of `ods_can.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.words import Condition

from .port import Can
from .work import Work

if TYPE_CHECKING:
    from .node import Node

_EVENTS = {
    Can.ERROR: Condition.COMMUNICATION_ERROR,
    Can.OVERRUN: Condition.CAN_OVERRUN,
    Can.TX_FULL: Condition.CAN_TX_FULL,
    Can.RX_FULL: Condition.CAN_RX_FULL,
}


class CanController:
    def __init__(self, node: Node) -> None:
        self._node = node
        self.state = Can.OK

    @property
    def is_off(self) -> bool:
        return self.state == Can.BUS_OFF

    def report(self, event: Can) -> None:
        """A new state of the controller, or something that happened to it."""
        if event in _EVENTS:
            self._node.emcy.raise_(_EVENTS[event])
        else:
            self._enter(event)

    def set_conditions(self) -> None:
        """After reset node too: the controller is in the state in which it was."""
        self._node.emcy.set(Condition.CAN_WARNING, self.state >= Can.WARNING)
        self._node.emcy.set(Condition.CAN_PASSIVE, self.state >= Can.PASSIVE)

    def _enter(self, state: Can) -> None:
        node, was_off = self._node, self.is_off
        self.state = state
        node.work |= Work.OUTPUT
        if self.is_off and not was_off:
            # Its emergency could not leave: it is raised when the node is back.
            node.emcy.react(Condition.BUS_OFF)
        if was_off and not self.is_off:
            node.emcy.raise_(Condition.BUS_OFF)
            node.work |= Work.EMCY | Work.TPDO
        self.set_conditions()
