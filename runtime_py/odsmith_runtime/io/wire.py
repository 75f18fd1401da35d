"""A bus in simulated time, with the virtual devices that are connected to it.

The wire knows no clock: it is run up to an instant, and everything happens at its own instant and in order. A frame of
a device reaches those who listen outside at once, and the other devices after the time that it takes on a real bus,
which is also what keeps devices that answer each other from doing so without end in no time.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from ..device.port import Can, Frame, Input
from .engine import make_group
from .log import EXTENDED

if TYPE_CHECKING:
    from .engine import Engine, Group

BIT_RATE = 1_000_000
_FRAME_BITS = 47  # of a frame without data and stuff bits, with the pause behind it

Listener = Callable[[int, Frame, object], None]
"""Told of each frame: when it was on the bus, and who sent it."""


class Station:
    """A device on the wire, and what may go wrong between them.

    `lose` is how many of the next frames to or from it get lost, `delay_us` how late its own frames are.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.lose = 0
        self.delay_us = 0
        self.next: int | None = None

    def loses(self) -> bool:
        if not self.lose:
            return False
        self.lose -= 1
        return True


class _Pending(NamedTuple):
    """A frame on its way; `leaves` if it has not reached the bus yet."""

    due: int
    order: int
    frame: Frame
    origin: Station
    leaves: bool


class Wire:
    """`now` is the instant that it has reached, in microseconds."""

    def __init__(self, listener: Listener = lambda time, frame, origin: None) -> None:
        self.now = 0
        self.listener = listener
        self.stations: list[Station] = []
        self._pending: list[_Pending] = []
        self._order = 0
        self._group: Group | None = None
        self._may_lose = False  # a frame to some device

    def attach(self, engine: Engine) -> Station:
        """Connect a device; it has to be given power."""
        station = Station(engine)
        self.stations.append(station)
        return station

    def detach(self, station: Station) -> None:
        """Take a device from the bus; what it has sent is lost where it has not arrived."""
        self.stations.remove(station)
        self._pending = [item for item in self._pending if item.origin is not station]
        heapq.heapify(self._pending)
        self._form_group()

    # ---- events ------------------------------------------------------------------------------------------------------

    def transmit(self, frame: Frame, origin: object) -> None:
        """A frame of somebody outside, now."""
        self.listener(self.now, frame, origin)
        self._deliver(frame, None)

    def power_on(self, station: Station) -> None:
        """Give a device power, now."""
        station.engine.power_on(self.now)
        self._form_group()
        self._look_at(station)

    def power_off(self, station: Station) -> None:
        """Take the power of a device away, at once and without a word."""
        station.engine.power_off()
        self._form_group()
        self._look_at(station)

    def input(self, station: Station, input: Input, channel: int, value: int) -> None:
        """Set an input of a device, of a channel from 0, to a value."""
        station.engine.input(self.now, input, channel, value)
        self._look_at(station)

    def fault(self, station: Station, axis: int, condition: str, holds: bool) -> None:
        """Make a condition hold on an axis of a device, or end it."""
        station.engine.fault(self.now, axis, condition, holds)
        self._look_at(station)

    def set_hardware(self, station: Station, axis: int, name: str, value: int) -> None:
        """Set an input of the simulated hardware of an axis. Raises KeyError, ValueError."""
        station.engine.set_hardware(self.now, axis, name, value)
        self._look_at(station)

    def report_can(self, station: Station, event: Can) -> None:
        """Tell a device how its CAN controller is."""
        station.engine.report_can(self.now, event)
        self._look_at(station)

    def lose(self, station: Station, frames: int) -> None:
        """Let the next frames to or from a device get lost."""
        station.lose = frames
        self._may_lose = True

    # ---- time --------------------------------------------------------------------------------------------------------

    def next(self) -> int | None:
        """The next instant at which something happens."""
        at = self._next_of_stations()
        if self._pending and (at is None or self._pending[0].due < at):
            return self._pending[0].due
        return at

    def run(self, until: int) -> None:
        """Let everything happen that happens up to an instant, which is now if it has passed."""
        while True:
            due = self._pending[0].due if self._pending else until + 1
            if not self._advance(min(until, due - 1)):
                continue  # somebody has sent something, which may be due earlier
            if due > until:
                break
            self.now = max(self.now, due)
            while self._pending and self._pending[0].due <= due:
                item = heapq.heappop(self._pending)
                if item.leaves:
                    self._leave(item.due, item.frame, item.origin)
                else:
                    self._deliver(item.frame, item.origin)
        self.now = max(self.now, until)

    def _next_of_stations(self) -> int | None:
        if self._group:
            return self._group.next()
        return min((station.next for station in self.stations if station.next is not None), default=None)

    def _advance(self, until: int) -> bool:
        """Let the time of all devices pass. False if it stopped on the way, because something had to be looked at."""
        if self._group:
            at = self._group.run(until)
            self.now = max(self.now, at)
            return not self._look_at_senders()
        next_at = self._next_of_stations()
        if next_at is None or next_at > until:
            return True
        self.now = max(self.now, next_at)
        for station in self.stations:
            if station.next is not None and station.next <= next_at:
                station.engine.advance(self.now)
                self._look_at(station)
        return False

    # ---- frames ------------------------------------------------------------------------------------------------------

    def _look_at(self, station: Station) -> None:
        """Something happened to a device: what it has sent leaves, and its next instant is another one."""
        for time, frame in station.engine.take():
            if station.loses():
                continue
            if station.delay_us:
                self._put(time + station.delay_us, frame, station, leaves=True)
            else:
                self._leave(time, frame, station)
        station.next = station.engine.next()

    def _leave(self, time: int, frame: Frame, origin: Station) -> None:
        self.listener(time, frame, origin)
        if len(self.stations) > 1:
            self._put(time + _duration(frame), frame, origin, leaves=False)

    def _deliver(self, frame: Frame, origin: Station | None) -> None:
        if frame.id & EXTENDED:  # no device here listens to those
            return
        if self._group and not self._may_lose:
            if self._group.deliver(self.now, frame, origin.engine if origin else None):
                self._look_at_senders()
            return
        for station in self.stations:
            if station is not origin and station.engine.is_on and not station.loses():
                station.engine.receive(self.now, frame)
                self._look_at(station)
        self._may_lose = any(station.lose for station in self.stations)

    def _look_at_senders(self) -> bool:
        """Let leave what was sent. True if there was something."""
        senders = [station for station in self.stations if station.engine.has_sent]
        for station in senders:
            self._look_at(station)
        return bool(senders)

    def _form_group(self) -> None:
        """Devices came, went or lost their power."""
        self._group = make_group([station.engine for station in self.stations])

    def _put(self, due: int, frame: Frame, origin: Station, *, leaves: bool) -> None:
        self._order += 1
        heapq.heappush(self._pending, _Pending(due, self._order, frame, origin, leaves))


def _duration(frame: Frame) -> int:
    return (_FRAME_BITS + 8 * len(frame.data)) * 1_000_000 // BIT_RATE
