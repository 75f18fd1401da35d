"""A network without a bus: devices in this process, and time that passes only when somebody waits.

    network = VirtualNetwork(tmcm6212)
    with TMCM6212(network, waiter=network.waiter()) as drive:
        drive.axes[0].enable()

A program tested with it neither sleeps nor depends on the clock: a move of ten seconds takes as long as computing it.
Frames go by function call, each takes `FRAME_US` of virtual time.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any

import canopen

from ..device.port import Frame
from ..io.engine import make_engine
from .waiting import ThreadLock

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractAsyncContextManager
    from types import ModuleType

    from ..io.engine import Engine

FRAME_US = 130
"""About the time of a frame of 8 octets at 1 Mbit/s."""

STEP_US = 1000
"""Who waits looks up so often."""


class VirtualNetwork(canopen.Network):
    """A network of python-canopen with devices of a generated package, one for each node-ID, powered.

    `engine` is python, c, or auto: C where it is built. `devices` are the engines, `now_us` is the time that each of
    their methods takes: `network.devices[0].fault(network.now_us, axis, "overtemperature", True)`. `log` has every
    frame with its time; frames for which `loses` is true reach nobody.
    """

    def __init__(self, package: ModuleType, *node_ids: int, engine: str = "python") -> None:
        super().__init__()
        self.now_us = 0
        self.log: list[tuple[int, Frame]] = []
        self.loses: Callable[[Frame], bool] = lambda frame: False
        self._pending: deque[tuple[Frame, Engine | None]] = deque()
        self._is_delivering = False
        self.devices = [make_engine(package, node_id, choice=engine) for node_id in node_ids or (1,)]
        for device in self.devices:
            device.power_on(self.now_us)
        self._deliver()

    def waiter(self) -> VirtualWaiter:
        """Time of this network for a blocking drive."""
        return VirtualWaiter(self)

    def async_waiter(self) -> AsyncVirtualWaiter:
        """Time of this network for tasks of asyncio."""
        return AsyncVirtualWaiter(self)

    def advance(self, microseconds: int) -> None:
        """Let time pass."""
        self.now_us += microseconds
        for device in self.devices:
            device.advance(self.now_us)
        self._deliver()

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """Put a frame on the bus; its answers arrive before this returns."""
        self.advance(FRAME_US)
        frame = Frame(can_id, b"" if remote else bytes(data), remote, len(data) if remote else 0)
        self._pending.append((frame, None))
        self._deliver()

    def _deliver(self) -> None:
        """Hand frames to everybody but their senders until there are none. A frame that a callback sends waits."""
        if self._is_delivering:
            return
        self._is_delivering = True
        try:
            self._collect()
            while self._pending:
                frame, sender = self._pending.popleft()
                if self.loses(frame):
                    continue
                self.log.append((self.now_us, frame))
                for device in self.devices:
                    if device is not sender:
                        device.receive(self.now_us, frame)
                if sender is not None:
                    self.notify(frame.id, bytearray(frame.data), self.now_us / 1e6)
                self._collect()
        finally:
            self._is_delivering = False

    def _collect(self) -> None:
        for device in self.devices:
            self._pending.extend((sent.frame, device) for sent in device.take())

    def disconnect(self) -> None:
        """There is nothing to disconnect."""


class VirtualWaiter:
    """Waits by letting virtual time pass."""

    def __init__(self, network: VirtualNetwork) -> None:
        self.network = network

    def now(self) -> float:
        return self.network.now_us / 1e6

    def notify(self) -> None:
        """Whoever waits looks up by itself."""

    async def wait(self, arrived: Callable[[], bool], until: float) -> None:
        while not arrived() and (left := until - self.now()) > 0:
            self.network.advance(min(STEP_US, max(1, round(left * 1e6))))  # at least 1, or `until` is never reached
            await self._let_others()

    def lock(self) -> AbstractAsyncContextManager[object]:
        return ThreadLock()

    async def _let_others(self) -> None:
        """Nobody else is there."""


class AsyncVirtualWaiter(VirtualWaiter):
    """The same for asyncio: other tasks have their turn at each step."""

    def lock(self) -> AbstractAsyncContextManager[object]:
        return asyncio.Lock()

    async def _let_others(self) -> None:
        await asyncio.sleep(0)
