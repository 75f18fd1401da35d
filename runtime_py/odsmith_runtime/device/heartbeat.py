"""Error control: the heartbeats that the node sends and watches, and guarding (CiA 301, 7.2.8).

The twin of `ods_heartbeat.c`. The producer keeps a fixed grid. A consumer is armed by the first heartbeat of the node
that it watches; a boot-up message disarms it. Guarding is answered while no heartbeat is produced, and life guarding
runs from the first request on. Its time can be longer than a timer lasts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode, NmtState
from odsmith_cia.words import Condition

from . import can_id
from .port import Frame
from .timing import MASK, TICK_US, US_PER_MS

if TYPE_CHECKING:
    from .node import Node

_TOGGLE = 0x80
_STATE = 0x7F
_LIFE_STEP = 1_000_000  # ticks that a timer may last
_GUARDING = -1  # in `lost`: the master is missing


def _watched(entry: int) -> int:
    """The node that an entry of 1016h watches; 0 if it watches none."""
    node_id = entry >> 16 & 0xFF
    return node_id if entry & 0xFFFF and node_id <= can_id.NODE_IDS else 0


class Heartbeat:
    def __init__(self, node: Node) -> None:
        self._node = node
        self._life_ticks = 0  # of the life time: those that remain when its timer runs out
        self.lost: set[int] = set()  # what is missing: entries of 1016h, counted from 0, and _GUARDING
        self._toggle = 0  # bit 7 of the next guarding answer

    def reset(self) -> None:
        """After a reset."""
        for n in range(len(self._node.values.consumer_heartbeat_time)):
            self._node.timers.stop(f"consumer_{n}")
        self._node.timers.stop("life")
        self._toggle = 0
        self._set_lost(set())
        self.producer_written()

    def receive(self, frame: Frame) -> None:
        """A frame of error control, of this node's master or of another node."""
        node_id = frame.id - can_id.ERROR_CONTROL
        if frame.remote:
            if node_id == self._node.id:
                self._answer_guarding()
        elif len(frame.data) == 1 and node_id:
            self._consume(node_id, frame.data[0] & _STATE)

    def _set_lost(self, lost: set[int]) -> None:
        self.lost = lost
        self._node.emcy.set(Condition.HEARTBEAT_LOST, bool(lost))

    def _found(self, what: int) -> None:
        if what in self.lost:
            self._set_lost(self.lost - {what})

    # ---- consumer --------------------------------------------------------------------------------------------------

    def check_consumer(self, sub: int, value: int) -> int:
        """Whether 1016h may be so: 0 or an abort code."""
        others = (entry for n, entry in enumerate(self._node.values.consumer_heartbeat_time, start=1) if n != sub)
        taken = _watched(value) and any(_watched(entry) == _watched(value) for entry in others)
        return AbortCode.PARAMETER_INCOMPATIBLE if taken else 0

    def consumer_written(self, sub: int) -> None:
        self._node.timers.stop(f"consumer_{sub - 1}")
        self._found(sub - 1)

    def _consume(self, node_id: int, state: int) -> None:
        for n, entry in enumerate(self._node.values.consumer_heartbeat_time):
            if _watched(entry) != node_id:
                continue
            if state == NmtState.INITIALISING:
                self._node.timers.stop(f"consumer_{n}")
            else:
                self._node.timers.start(f"consumer_{n}", (entry & 0xFFFF) * US_PER_MS)
                self._found(n)

    def expire(self) -> None:
        """What is missing now."""
        for n in range(len(self._node.values.consumer_heartbeat_time)):
            if self._node.timers.is_due(f"consumer_{n}"):
                self._node.timers.stop(f"consumer_{n}")
                self._set_lost(self.lost | {n})
        if not self._node.timers.is_due("life"):
            return
        if self._life_ticks:
            self._run_life_timer(self._node.timers.now)
        else:
            self._node.timers.stop("life")
            self._set_lost(self.lost | {_GUARDING})

    # ---- guarding --------------------------------------------------------------------------------------------------

    def guard_written(self) -> None:
        self._stop_life_time()

    def _answer_guarding(self) -> None:
        node = self._node
        if node.values.producer_heartbeat_time:
            return
        node.send(Frame(can_id.ERROR_CONTROL + node.id, bytes([node.nmt.code | self._toggle])))
        self._toggle ^= _TOGGLE
        self._start_life_time()
        self._found(_GUARDING)

    def _start_life_time(self) -> None:
        """Life time is over at the first tick that is not before its end."""
        values, timers = self._node.values, self._node.timers
        time = values.guard_time * values.life_time_factor
        tick = timers.next_tick()
        if time:
            self._life_ticks = time - 1 if tick - timers.now & MASK == TICK_US else time
            self._run_life_timer(tick)

    def _run_life_timer(self, start: int) -> None:
        """Let the timer run for as many of the remaining ticks as it may."""
        ticks = min(self._life_ticks, _LIFE_STEP)
        self._life_ticks -= ticks
        self._node.timers.deadlines["life"] = start + ticks * TICK_US & MASK

    def _stop_life_time(self) -> None:
        self._node.timers.stop("life")
        self._found(_GUARDING)

    # ---- producer --------------------------------------------------------------------------------------------------

    def producer_written(self) -> None:
        period = self._node.values.producer_heartbeat_time
        if not period:
            self._node.timers.stop("heartbeat")
            return
        self._stop_life_time()  # heartbeat and guarding exclude each other
        self._node.timers.start("heartbeat", period * US_PER_MS)

    def transmit(self) -> None:
        """Send a heartbeat."""
        self._send(self._node.nmt.code)

    def boot_up(self) -> None:
        """Send the boot-up message."""
        self._send(NmtState.INITIALISING)

    def _send(self, state: int) -> None:
        self._node.send(Frame(can_id.ERROR_CONTROL + self._node.id, bytes([state])))
