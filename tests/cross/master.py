"""python-canopen as the master of a testee, in one process and in virtual time.

    network = MasterNetwork(testee)
    node = network.add_node(5, "TMCM-3230.eds")
    network.power_on()

The library takes its answers from queues and waits with condition variables. Here an answer is in its queue before
anybody asks for it, and waiting lets the testee's time pass, so nothing ever blocks.
"""

from __future__ import annotations

import threading
from typing import Any

import canopen
from tests.cross.driver import Answer, Testee


class MasterNetwork(canopen.Network):
    """A network whose bus is a testee."""

    def __init__(self, testee: Testee) -> None:
        super().__init__()
        self.testee = testee

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        self._deliver(self.testee.remote(can_id) if remote else self.testee.rx(can_id, bytes(data)))

    def advance(self, us: int) -> None:
        self._deliver(self.testee.advance(us))

    def power_on(self) -> None:
        self._deliver(self.testee.power())

    def do(self, line: str) -> None:
        """Anything else that the testee understands."""
        self._deliver(self.testee.do(line))

    def _deliver(self, answer: Answer) -> None:
        for frame in answer.frames:
            self.notify(frame.id, bytearray(frame.data), frame.at / 1e6)

    def add_node(self, *arguments: Any, **keywords: Any) -> canopen.RemoteNode:
        node = super().add_node(*arguments, **keywords)
        node.sdo.RESPONSE_TIMEOUT = 0  # what is not there yet will not come
        node.nmt.state_update = _VirtualWait(self)
        node.emcy.emcy_received = _VirtualWait(self)
        for pdo in (*node.tpdo.values(), *node.rpdo.values()):
            pdo.receive_condition = _VirtualWait(self)
        return node


class _VirtualWait(threading.Condition):
    """A condition on which one waits in virtual time."""

    def __init__(self, network: MasterNetwork) -> None:
        super().__init__()
        self._network = network
        self._notified = False

    def wait(self, timeout: float | None = None) -> bool:
        assert timeout is not None, "nobody waits for ever"
        self._notified = False
        left = round(timeout * 1e6)
        while left > 0 and not self._notified:
            step = min(left, self._network.testee.last.next or left)
            self._network.advance(step)
            left -= step
        return self._notified

    def notify_all(self) -> None:
        self._notified = True
        super().notify_all()
