"""A way to a bus for tools that ask and wait: over python-can, or straight into a simulation that nobody started."""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import can

    from ..device.port import Frame
    from .device import VirtualDevice
    from .wire import Station


class Transport(Protocol):
    def now(self) -> float:
        """Seconds."""

    def send(self, frame: Frame) -> None:
        """Raises OSError."""

    def receive(self, timeout: float) -> Frame | None:
        """The next frame; None if there was none for so many seconds, or if something came that is no frame."""


class BusTransport:
    """A bus of python-can, closed with it."""

    def __init__(self, bus: can.BusABC) -> None:
        self.bus = bus

    def now(self) -> float:
        return time.monotonic()

    def send(self, frame: Frame) -> None:
        from can import CanError

        from .can_link import to_message

        try:
            self.bus.send(to_message(frame))
        except CanError as error:
            raise OSError(f"the bus does not take frames: {error}") from None

    def receive(self, timeout: float) -> Frame | None:
        from can import CanError

        from .can_link import from_message

        try:
            message = self.bus.recv(timeout)
        except CanError as error:
            raise OSError(f"the bus is gone: {error}") from None
        return from_message(message) if message else None

    def close(self) -> None:
        self.bus.shutdown()


class SimulatedTransport:
    """The wire of virtual devices that were not started: waiting makes their time pass, and takes none."""

    def __init__(self, device: VirtualDevice) -> None:
        self._simulator = device.simulator
        self._heard: deque[Frame] = deque()
        self._simulator.observers.append(self._hear)

    def now(self) -> float:
        return self._simulator.wire.now / 1_000_000

    def send(self, frame: Frame) -> None:
        self._simulator.act(lambda: self._simulator.wire.transmit(frame, None))

    def receive(self, timeout: float) -> Frame | None:
        wire = self._simulator.wire
        until = wire.now + round(timeout * 1_000_000)
        while not self._heard and wire.now < until:
            at = wire.next()
            self._simulator.run(min(until, max(wire.now + 1, until if at is None else at)) - wire.now)
        return self._heard.popleft() if self._heard else None

    def _hear(self, time: int, frame: Frame, origin: Station) -> None:
        self._heard.append(frame)
