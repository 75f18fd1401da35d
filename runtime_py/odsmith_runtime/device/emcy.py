"""Emergencies (CiA 301, 7.2.7): from a condition to the error register, the reaction and the frame.

The twin of `ods_emcy.c`. A row of the device's table is raised on the edge of its condition. Rows of conditions that
hold make up the error register; momentary rows show in their frame only.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.codes import AbortCode
from odsmith_cia.words import Condition, Reaction

from . import can_id
from .port import Frame
from .timing import US_PER_100US
from .work import Work

if TYPE_CHECKING:
    from collections.abc import Iterable, Set

    from ..emergencies import Emergency
    from .node import Node

Conditions = set[str]

_QUEUE = 8
_WHOLE_DEVICE = 255  # stands in the axis byte of a message that concerns no single axis
_FAULTS = (Reaction.FAULT_RAMP, Reaction.FAULT_OFF)


def check_cob_id(cob_id: int) -> int:
    """Whether 1014h may be so: 0 or an abort code."""
    if cob_id & can_id.RESERVED:
        return AbortCode.INVALID_VALUE
    usable = cob_id & can_id.INVALID or not can_id.is_restricted(cob_id & can_id.MASK)
    return 0 if usable else AbortCode.INVALID_VALUE


class _Item(NamedTuple):
    row: Emergency | None
    axis: int
    error_register: int


class Emcy:
    def __init__(self, node: Node, rows: Iterable[Emergency]) -> None:
        self._node = node
        self._rows = tuple(rows)
        self.conditions: Conditions = set()  # those of the whole device that hold
        self._queue: deque[_Item] = deque()

    # ---- conditions ------------------------------------------------------------------------------------------------

    def set(self, condition: Condition, holds: bool) -> None:
        """A condition of the whole device holds or has ended."""
        if (condition in self.conditions) == holds:
            return
        was_clear = not self._register_of(self.conditions)
        if holds:
            self.conditions.add(condition)
        else:
            self.conditions.remove(condition)
        self._update_register()
        self._node.work |= Work.OUTPUT
        if holds:
            self.raise_(condition)
            self.react(condition)
        elif not was_clear and not self._register_of(self.conditions):
            self._push_cleared()

    def set_axis(self, axis: int, conditions: Set[str]) -> None:
        """The conditions of an axis that hold now."""
        node = self._node
        begun = conditions - node.axes[axis].conditions
        if conditions == node.axes[axis].conditions:
            return
        node.axes[axis].conditions = set(conditions)
        self._update_register()
        for row in self._rows:
            if row.condition in begun:
                self._push(row, axis, node.values.error_register)
                node.axes[axis].react(row.reaction)
                if row.reaction in _FAULTS:
                    node.nmt.application_error()

    def raise_(self, condition: Condition, axis: int = _WHOLE_DEVICE) -> None:
        """Something happened: raise the rows of a condition, in the order of the table."""
        for row in self._rows:
            if row.condition == condition:
                self._push(row, axis, self._node.values.error_register | row.register_mask)

    def react(self, condition: Condition) -> None:
        """Carry out the reactions to a condition of the whole device without raising it."""
        for row in self._rows:
            if row.condition == condition and row.reaction != Reaction.NONE:
                for axis in self._node.axes:
                    axis.react(row.reaction)
        if condition in (Condition.HEARTBEAT_LOST, Condition.BUS_OFF):
            self._node.nmt.communication_error()

    def is_warned(self, conditions: Set[str]) -> bool:
        """Whether a condition with the reaction of a warning is among these."""
        return any(row.reaction == Reaction.WARNING and row.condition in conditions for row in self._rows)

    def driver_flags(self, conditions: Set[str]) -> int:
        """What the driver error flags show of conditions."""
        flags = 0
        for row in self._rows:
            if row.condition in conditions:
                flags |= row.driver_flag
        return flags

    def has_fault_cause(self, conditions: Set[str]) -> bool:
        """Whether one of these conditions, or of those of the device, is a fault."""
        present = self.conditions | conditions
        return any(row.reaction in _FAULTS and row.condition in present for row in self._rows)

    def reset(self) -> None:
        """Forget what is queued."""
        self._queue.clear()
        self._node.timers.stop("emcy")
        self._update_register()

    # ---- error register --------------------------------------------------------------------------------------------

    def _register_of(self, conditions: Set[str]) -> int:
        """Rows of conditions that hold: their bits of the error register."""
        register = 0
        for row in self._rows:
            if not row.momentary and row.condition in conditions:
                register |= row.register_mask
        return register

    def _update_register(self) -> None:
        node = self._node
        present = self.conditions.union(*(axis.conditions for axis in node.axes))
        register = self._register_of(present)
        if node.values.error_register != register:
            node.values.error_register = register
            node.value_changed(node.od.instances[0])

    # ---- queue -----------------------------------------------------------------------------------------------------

    def _push(self, row: Emergency | None, axis: int, error_register: int) -> None:
        if len(self._queue) < _QUEUE:
            self._queue.append(_Item(row, axis, error_register))
        self._node.work |= Work.EMCY

    def _push_cleared(self) -> None:
        """The device's "error reset": the row that a fault reset has, under the byte that means no axis."""
        resets = (row for row in self._rows if row.condition == Condition.FAULT_RESET)
        self._push(next(resets, None), _WHOLE_DEVICE, self._node.values.error_register)

    def transmit(self) -> None:
        """Send what may leave now."""
        node = self._node
        if node.values.cob_id_emcy & can_id.INVALID:
            self._queue.clear()
            return
        if "emcy" not in node.services or node.can.is_off:
            return
        while self._queue and not node.timers.is_armed("emcy"):
            inhibit_time = node.values.inhibit_time_emcy * US_PER_100US
            self._send(self._queue.popleft())
            if inhibit_time:
                node.timers.start("emcy", inhibit_time)

    def _send(self, item: _Item) -> None:
        row = item.row
        code = row.code if row else 0
        additional = bytes(item.axis if byte == "axis" else int(byte) for byte in row.bytes) if row else bytes(5)
        data = code.to_bytes(2, "little") + bytes([item.error_register]) + additional
        self._node.send(Frame(self._node.values.cob_id_emcy & can_id.MASK, data))
