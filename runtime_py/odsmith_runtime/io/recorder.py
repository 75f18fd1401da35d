"""Everything that is on the wire, written down as a log of candump."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from .log import format_line

if TYPE_CHECKING:
    from ..device.port import Frame


class Recorder:
    """A link that writes a log. Stamps are the time of day at which it began, plus the simulation's time since.

    Raises OSError if the file cannot be written.
    """

    def __init__(self, path: Path, begin: int | None = None) -> None:
        self._stream = path.open("w", encoding="ascii")
        self._begin = time.time_ns() // 1000 if begin is None else begin

    def start(self) -> None:
        """There is nothing to wait for."""

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        print(format_line(self._begin + time, frame, way="T" if from_device else "R"), file=self._stream)

    def close(self) -> None:
        self._stream.close()
