"""A bus of python-can as a link of the simulation."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from ..device.port import Frame
from .log import EXTENDED, HIGHEST_EXTENDED_ID

if TYPE_CHECKING:
    import can

    from .simulator import Simulator

_POLL_S = 0.1  # how long a receiving thread may not notice that it is to end


BIT_RATES = (10_000, 20_000, 50_000, 100_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)
"""In bit/s: those that CiA 301 recommends, and 100 kbit/s, which many devices have."""


class LinkError(Exception):
    """A link cannot be opened; `hint` says what to do."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


def open_bus(interface: str, channel: str | None, bitrate: int | None = None, **options: object) -> can.BusABC:
    """A bus of python-can. `bitrate` is in bit/s, one of `BIT_RATES`. Raises LinkError."""
    if bitrate is not None and bitrate not in BIT_RATES:
        raise LinkError(f"no CANopen bus has {bitrate} bit/s", f"bit rates: {', '.join(map(str, BIT_RATES))}")
    try:
        import can
    except ModuleNotFoundError as error:
        if error.name != "can":
            raise
        raise LinkError("python-can is not installed", "pip install 'odsmith[can]'") from None
    if bitrate is not None:
        options["bitrate"] = bitrate
    try:
        return can.Bus(interface=interface, channel=channel, **options)  # type: ignore[arg-type]
    except (can.CanError, OSError, ValueError, TypeError, ImportError, NotImplementedError) as error:
        raise LinkError(f"no bus at interface {interface}, channel {channel}: {error}") from None


def from_message(message: can.Message) -> Frame | None:
    """A frame of python-can; None for what no device here sees: CAN FD and error frames."""
    if message.is_error_frame or message.is_fd:
        return None
    identifier = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
    if message.is_remote_frame:
        return Frame(identifier, remote=True, length=message.dlc)
    return Frame(identifier, bytes(message.data))


def to_message(frame: Frame) -> can.Message:
    import can

    return can.Message(
        arbitration_id=frame.id & HIGHEST_EXTENDED_ID,
        is_extended_id=bool(frame.id & EXTENDED),
        is_remote_frame=frame.remote,
        dlc=frame.dlc,
        data=frame.data,
    )


class CanLink:
    """Connects a bus to a simulator. It is closed with the link if the link `owns` it."""

    def __init__(self, simulator: Simulator, bus: can.BusABC, *, owns: bool = True) -> None:
        self._simulator = simulator
        self._bus = bus
        self._owns = owns
        self._thread: threading.Thread | None = None
        self._closing = False
        self._lost = 0

    def start(self) -> None:
        if self._thread is None:
            self._thread = threading.Thread(target=self._receive, name="odsmith bus", daemon=True)
            self._thread.start()

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        from can import CanError

        try:
            self._bus.send(to_message(frame))
        except CanError as error:  # a frame is lost, as it may be on any bus
            if not self._lost:
                self._simulator.log(f"frames are lost on {self._bus.channel_info}: {error}")
            self._lost += 1

    def close(self) -> None:
        self._closing = True
        if self._thread and self._thread is not threading.current_thread():
            self._thread.join()
        if self._owns:
            self._bus.shutdown()

    def _receive(self) -> None:
        from can import CanError

        while not self._closing:
            try:
                message = self._bus.recv(_POLL_S)
            except (CanError, OSError, ValueError) as error:
                if not self._closing:
                    self._simulator.log(f"{self._bus.channel_info} is gone: {error}")
                return
            frame = from_message(message) if message else None
            if frame is not None:
                self._simulator.receive(frame, self)
