"""Everything that is on the wire, written down as a log of candump."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from .log import format_line

if TYPE_CHECKING:
    from ..device.port import Frame


class Recorder:
    """A link that writes a log, whole lines at once, so that others can read it meanwhile.

    Stamps are the time of day at which it began, plus the simulation's time since. Raises OSError if the file cannot be
    written.
    """

    def __init__(self, path: Path, begin: int | None = None) -> None:
        self._path = path
        self._stream = path.open("w", encoding="ascii", buffering=1)
        self._begin = time.time_ns() // 1000 if begin is None else begin

    def start(self) -> None:
        """There is nothing to wait for."""

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        line = format_line(self._begin + time, frame, way="T" if from_device else "R")
        with self._named_errors():
            self._stream.write(f"{line}\n")

    def close(self) -> None:
        with self._named_errors():
            self._stream.close()

    @contextmanager
    def _named_errors(self) -> Iterator[None]:
        """An error says which file it is about."""
        try:
            yield
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from None
