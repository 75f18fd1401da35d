"""Virtual devices in real time: it owns the clock, moves the wire along with it, and hands frames to and from links.

A link is a way out: a socket server, a bus of python-can, a log. Frames that come in by one reach the devices and all
other links. Whoever brings a frame has the wire brought up to date in his own thread, so an answer waits for no other
thread; one thread of the simulator's own sees to what happens with time.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

from .clock import RealClock
from .wire import Station, Wire

if TYPE_CHECKING:
    from ..device.port import Frame
    from .clock import Clock

LONGEST_STRIDE_US = 20_000
"""So much is simulated in one go before others get their turn."""

LONGEST_LAG_US = 500_000
"""A simulation that is later than this gives up time instead of catching up."""

LONGEST_SLEEP_S = 1.0


class Link(Protocol):
    """A way out of the simulation. Its methods are called while the simulator is locked, and must not wait."""

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        """A frame was on the wire. Raises OSError if the link is broken for good."""

    def start(self) -> None: ...

    def close(self) -> None: ...


class Simulator:
    """`wire` may be touched only while holding `lock`."""

    def __init__(self, *, speed: float = 1.0, clock: Clock | None = None) -> None:
        if not 0 < speed < float("inf"):
            raise ValueError(f"the speed is more than 0, not {speed}")
        self.speed = speed
        self.clock: Clock = clock or RealClock(speed)
        self.wire = Wire(self._on_wire)
        self.lock = threading.RLock()
        self.log: Callable[[str], None] = lambda text: None
        self.after_turn: list[Callable[[], None]] = []  # called whenever something has happened, while locked
        self.observers: list[Callable[[int, Frame, Station], None]] = []  # told of the frames of devices
        self.given_up_us = 0  # time that the machine was too slow for
        self.link_error: OSError | None = None  # the first that broke a link
        self._links: list[Link] = []
        self._broken: list[Link] = []
        self._changed = threading.Condition(self.lock)
        self._planned: int | None = None  # when the thread wakes up
        self._thread: threading.Thread | None = None
        self._stopping = False

    # ---- from outside ------------------------------------------------------------------------------------------------

    def connect(self, link: Link) -> None:
        """Add a link; it starts at once if the simulator runs."""
        with self.lock:
            self._links.append(link)
            if self._thread:
                link.start()

    def disconnect(self, link: Link) -> None:
        """Take a link away from the bus and close it."""
        with self.lock:
            if link in self._links:
                self._links.remove(link)
        link.close()

    def receive(self, frame: Frame, origin: Link) -> None:
        """A frame came in by a link."""
        self.act(lambda: self.wire.transmit(frame, origin))

    def act(self, action: Callable[[], None]) -> None:
        """Let something happen to the wire, now."""
        with self.lock:
            self._catch_up()
            action()
            self._end_turn()

    def run(self, microseconds: int) -> None:
        """Let so much time pass at once: for a simulation that was not started."""
        with self.lock:
            until = self.wire.now + microseconds
            while self.wire.now < until:
                self.wire.run(min(until, self.wire.now + LONGEST_STRIDE_US))
                self._end_turn()

    # ---- life --------------------------------------------------------------------------------------------------------

    def start(self) -> None:
        """Begin to run with the clock, in a thread."""
        with self.lock:
            if self._thread:
                return
            self._stopping = False
            self.clock.set_back(self.wire.now)
            self._thread = threading.Thread(target=self._live, name="odsmith simulator", daemon=True)
            for link in self._links:
                link.start()
        self._thread.start()

    def stop(self) -> None:
        """End the thread and close all links. `link_error` says whether one of them broke, now or before."""
        with self.lock:
            self._stopping = True
            self._changed.notify_all()
            thread, self._thread = self._thread, None
            links, broken, self._links, self._broken = self._links, self._broken, [], []
        if thread:
            thread.join()
        for link in links:
            try:
                link.close()
            except OSError as error:
                self._note(error)
        for link in broken:
            with suppress(OSError):  # it has been said before
                link.close()
        with self.lock:
            self._end_turn()

    def __enter__(self) -> Simulator:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _live(self) -> None:
        with self.lock:
            while not self._stopping:
                self._catch_up()
                self._end_turn()
                self._changed.wait(self._sleep())

    def _sleep(self) -> float:
        at = self._planned = self.wire.next()
        if at is None:
            return LONGEST_SLEEP_S
        return min(LONGEST_SLEEP_S, self.clock.wait_seconds(at - self.clock.now()))

    def _catch_up(self) -> None:
        """Bring the wire up to the present, or as near to it as may be done in one go."""
        if not self._thread:
            return  # its time is driven by run()
        now, at = self.clock.now(), self.wire.next()
        if at is not None and at <= now:
            if now - at > LONGEST_LAG_US:
                self.given_up_us += now - at - LONGEST_STRIDE_US
                now = at + LONGEST_STRIDE_US
                self.clock.set_back(now)
            now = min(now, max(at, self.wire.now) + LONGEST_STRIDE_US)
        self.wire.run(now)

    def _end_turn(self) -> None:
        for call in self.after_turn:
            call()
        at = self.wire.next()
        if at is not None and (self._planned is None or at < self._planned):
            self._planned = at
            self._changed.notify_all()

    # ---- frames ------------------------------------------------------------------------------------------------------

    def _on_wire(self, time: int, frame: Frame, origin: object) -> None:
        from_device = isinstance(origin, Station)
        if isinstance(origin, Station):
            for observe in self.observers:
                observe(time, frame, origin)
        for link in tuple(self._links):
            if link is origin:
                continue
            try:
                link.send(time, frame, from_device=from_device)
            except OSError as error:
                self._note(error)
                self._links.remove(link)
                self._broken.append(link)  # its thread may wait for us, so this is no place to close it

    def _note(self, error: OSError) -> None:
        """A link broke."""
        self.log(f"a link broke and is given up: {error}")
        self.link_error = self.link_error or error
