"""Time: microseconds in 32 bits, which wrap; the twin of a part of `ods_core.h`."""

from __future__ import annotations

MASK = 0xFFFFFFFF

TICK_US = 1000
US_PER_MS = 1000
US_PER_100US = 100

HORIZON_US = 0x40000000
"""Nothing is put off further than this, so that two instants can always be compared."""


def before(a: int, b: int) -> bool:
    """Whether instant `a` lies before `b`. They are less than 2^31 us apart."""
    return (a - b) & MASK >= 0x80000000


class Timers:
    """Deadlines by name. A timer that has run out stays armed until it is stopped or started again."""

    def __init__(self) -> None:
        self.now = 0
        self.deadlines: dict[str, int] = {}
        self.tick_at = 0

    def start(self, name: str, duration: int) -> None:
        self.deadlines[name] = (self.now + duration) & MASK

    def repeat(self, name: str, period: int) -> None:
        """Start again from when the timer ran out, whenever that was noticed."""
        self.deadlines[name] = (self.deadlines[name] + period) & MASK

    def stop(self, name: str) -> None:
        self.deadlines.pop(name, None)

    def is_armed(self, name: str) -> bool:
        return name in self.deadlines

    def is_due(self, name: str) -> bool:
        at = self.deadlines.get(name)
        return at is not None and not before(self.now, at)

    def next_tick(self) -> int:
        """The next tick. Those that were not armed have gone by unseen, but the grid holds."""
        if not before(self.now, self.tick_at):
            passed = (self.now - self.tick_at) & MASK
            self.tick_at = (self.tick_at + (passed // TICK_US + 1) * TICK_US) & MASK
        return self.tick_at

    def arm_tick(self) -> None:
        """Have the next tick visited."""
        self.deadlines["tick"] = self.next_tick()

    def earliest(self, horizon: int) -> int:
        """The next deadline, or the horizon."""
        at = horizon
        for deadline in self.deadlines.values():
            if before(deadline, at):
                at = deadline
        return at
