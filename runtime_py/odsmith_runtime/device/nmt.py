"""The NMT slave (CiA 301, 7.2.8, 7.3.2): states, commands and resets; the twin of `ods_nmt.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import NmtCommand, NmtState

from . import can_id
from .port import Frame
from .work import Work

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..nmt import NmtCommandInfo, NmtStateInfo
    from .node import Node


class Nmt:
    """The state: `state` is its name, `code` as the heartbeat carries it."""

    def __init__(
        self,
        node: Node,
        states: Mapping[int, NmtStateInfo],
        commands: Mapping[int, NmtCommandInfo],
        error_behaviour: Mapping[int, int],
    ) -> None:
        self._node = node
        self._states = states
        self._codes = {info.name: code for code, info in states.items()}
        self._commands = commands
        self._error_behaviour = error_behaviour
        self._next: int = NmtState.STOPPED
        self.code: int = NmtState.INITIALISING

    @property
    def state(self) -> str:
        return self._states[self.code].name

    def power_on(self) -> None:
        self.code = NmtState.INITIALISING
        self._node.services = ()

    def receive(self, frame: Frame) -> None:
        """A frame of the NMT master."""
        if frame.remote or len(frame.data) != 2 or frame.data[1] not in (0, self._node.id):
            return
        command = self._commands.get(frame.data[0])
        if command is None:
            return
        if command.code == NmtCommand.RESET_NODE:
            self.reset_node()
        elif command.code == NmtCommand.RESET_COMMUNICATION:
            self._reset_communication()
        else:
            self._enter(self._codes[command.to])

    def reset_node(self) -> None:
        """Reset node, also at power-on: every value, the axes, node-ID and bit rate."""
        node = self._node
        self._load_values()
        node.id = self._choose_node_id()
        self._load_values()  # now that the node-ID is known that some defaults depend on
        node.values.node_id_load = node.id
        node.values.can_bit_rate_load = node.values.can_bit_rate or max(node.identity.bit_rates, default=0)
        node.port.bus(node.values.can_bit_rate_load, node.id)
        node.emcy.conditions.clear()
        node.io.reset()
        for axis in node.axes:
            axis.reset()
        self._start_communication()
        node.can.set_conditions()
        node.timers.arm_tick()  # inputs and faults are found anew

    def communication_error(self) -> None:
        """1029h:01 decides what becomes of the state, once the emergencies of this turn have left."""
        self._error(0)

    def application_error(self) -> None:
        """1029h:02 does."""
        self._error(1)

    def follow_error(self) -> None:
        """Carry out what was decided."""
        self._enter(self._next)

    def _error(self, which: int) -> None:
        to = self._error_behaviour.get(self._node.values.error_behaviour[which])
        if self.code == NmtState.OPERATIONAL and to is not None:
            self._next = to
            self._node.work |= Work.ERROR_BEHAVIOUR

    def _enter(self, code: int) -> None:
        if code == self.code:
            return
        node = self._node
        self.code = code
        node.services = self._states[code].services
        if "pdo" in node.services:
            node.pdo.start()
        if "sdo" not in node.services:
            node.sdo.abandon()
        if code == NmtState.STOPPED:
            for axis in node.axes:
                axis.network_stopped()
        node.work |= Work.EMCY | Work.OUTPUT

    def _start_communication(self) -> None:
        """Communication starts anew under the node-ID in force. Its values are already those after the reset."""
        node = self._node
        self._enter(NmtState.INITIALISING)
        node.work &= ~(Work.HEARTBEAT | Work.ERROR_BEHAVIOUR)
        if node.config.serial_number:
            node.values.serial_number = node.config.serial_number
        node.heartbeat.reset()
        node.emcy.reset()
        node.pdo.reset()
        node.heartbeat.boot_up()
        self._enter(NmtState.PRE_OPERATIONAL)

    def _reset_communication(self) -> None:
        self._node.od.set_defaults(self._node.id, communication_only=True)
        self._node.store.load(communication_only=True)
        self._start_communication()

    def _load_values(self) -> None:
        """Defaults, then what is stored."""
        node = self._node
        node.od.set_defaults(node.id, communication_only=False)
        if node.config.node_id:
            node.values.node_id = node.config.node_id
        node.store.load(communication_only=False)

    def _choose_node_id(self) -> int:
        """The address switches count while they show a node-ID; else the stored one does."""
        address = self._node.io.address
        return address if 1 <= address <= can_id.NODE_IDS else self._node.values.node_id or 1
