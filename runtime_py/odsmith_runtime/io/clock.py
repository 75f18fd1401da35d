"""The time of a simulation: that of the machine, faster or slower."""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    def now(self) -> int:
        """Microseconds since the simulation began."""

    def wait_seconds(self, microseconds: int) -> float:
        """How long to sleep until so much of the simulation's time has passed."""

    def set_back(self, now: int) -> None:
        """It is only `now`: the machine could not keep up."""


class RealClock:
    """`speed` is how much faster than real time it runs."""

    def __init__(self, speed: float = 1.0) -> None:
        self.speed = speed
        self._start = time.monotonic_ns()
        self._offset = 0

    def now(self) -> int:
        return self._offset + int((time.monotonic_ns() - self._start) * self.speed / 1000)

    def wait_seconds(self, microseconds: int) -> float:
        return max(0.0, microseconds / self.speed / 1_000_000)

    def set_back(self, now: int) -> None:
        self._offset += now - self.now()
