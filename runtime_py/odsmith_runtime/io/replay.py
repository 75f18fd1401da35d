"""A log once more: what masters sent in it, and whether a virtual device answers as the log has it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ..device import can_id
from .device import VirtualDevice
from .log import EXTENDED, format_frame
from .simulator import Simulator

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from types import ModuleType

    from ..device.port import Frame
    from .log import Logged
    from .wire import Station

_OF_DEVICES = 0x080  # this bit tells the CAN-IDs of devices (CiA 301, 7.3.3), but for error control


class Difference(NamedTuple):
    """Where a device does something else: seconds since the beginning, and the frames as text."""

    time: float
    logged: str
    sent: str


def of_masters(logged: Sequence[Logged]) -> list[Logged]:
    """The frames that no device sent: by the marks of the log, else by the predefined connection set."""
    if any(item.way for item in logged):
        return [item for item in logged if item.way != "T"]
    return [item for item in logged if not is_of_device(item.frame)]


def is_of_device(frame: Frame) -> bool:
    """Whether a node sends such frames as delivered."""
    if frame.id & EXTENDED or frame.remote or not frame.id & can_id.NODE_IDS:
        return False
    return bool(frame.id & _OF_DEVICES) or frame.id >= can_id.ERROR_CONTROL


def compare(
    package: ModuleType, logged: Sequence[Logged], node_ids: Iterable[int], *, engine: str = "auto"
) -> tuple[int, Difference | None]:
    """Run a log against devices that are switched on at its first frame, in no time.

    Gives how many of their frames are as in the log, and the first that is not. Raises EngineError.
    """
    marked = any(item.way for item in logged)
    begin = logged[0].time or 0.0
    simulator = Simulator()
    sent: list[tuple[int, Frame]] = []

    def hear(time: int, frame: Frame, origin: Station) -> None:
        sent.append((time, frame))

    simulator.observers.append(hear)
    for node_id in node_ids:
        VirtualDevice(package, node_id, engine=engine, simulator=simulator)
    wanted = []
    for item in logged:
        at = simulator.wire.now / 1_000_000 if item.time is None else item.time - begin
        simulator.run(max(0, round(at * 1_000_000) - simulator.wire.now))
        if item.way == "T" if marked else is_of_device(item.frame):
            wanted.append((at, item.frame))
        else:
            simulator.act(partial(simulator.wire.transmit, item.frame, None))
    for same, (at, frame) in enumerate(wanted):
        if same == len(sent) or sent[same][1] != frame:
            instead = format_frame(sent[same][1]) if same < len(sent) else ""
            return same, Difference(at, format_frame(frame), instead)
    if len(sent) > len(wanted):
        time, frame = sent[len(wanted)]
        return len(wanted), Difference(time / 1_000_000, "", format_frame(frame))
    return len(wanted), None
