"""CAN frames as lines of text, as `candump -L` of can-utils writes them and `canplayer` reads them.

    (1436509052.249713) can0 601#4000100000000000       seconds, bus, CAN-ID # data
    (1436509052.249713) can0 701#R1                     a remote frame and its DLC

A letter at the end says which way a frame went, from the point of view of the virtual device: `T` it sent it, `R` it
received it. Newer can-utils and python-can know this letter; it may be missing.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from ..device.port import Frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

EXTENDED = 0x8000_0000
"""Marks a CAN-ID of 29 bits, as SocketCAN does. No CANopen device here answers to one."""

HIGHEST_ID = 0x7FF
HIGHEST_EXTENDED_ID = 0x1FFF_FFFF

_LINE = re.compile(
    r"""(?:\((?P<time>\d{1,12}\.\d{6,9})\)\s+(?P<bus>[^\s#]+)\s+)?
    (?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})
    \#(?:(?P<data>(?:[0-9A-Fa-f]{2}\.?){0,8})|R(?P<length>[0-8]?))
    (?:\s+(?P<way>[RT]))?\s*""",
    re.VERBOSE,
)
_OTHER = re.compile(
    r"(?:\(\d+\.\d+\)\s+\S+\s+)?(?:[0-9A-Fa-f]{3,8}\#\#[0-9A-Fa-f]+|2[0-9A-Fa-f]{7}\#.*)(?:\s+[RT])?\s*"
)


class LogLineError(ValueError):
    """A line is no frame."""


class Logged(NamedTuple):
    """A line of a log: seconds, or None where the line has none; `way` is T, R or nothing."""

    time: float | None
    frame: Frame
    bus: str = ""
    way: str = ""


def parse_line(line: str) -> Logged | None:
    """What a line says; None for an empty one, and for CAN FD and error frames. Raises LogLineError."""
    line = line.strip()
    if not line:
        return None
    found = _LINE.fullmatch(line)
    if found is None or (len(found["id"]) == 3 and int(found["id"], 16) > HIGHEST_ID):
        if _OTHER.fullmatch(line):
            return None
        raise LogLineError("this is no line of candump -L")
    identifier = int(found["id"], 16)
    if len(found["id"]) == 8:
        if identifier > HIGHEST_EXTENDED_ID:
            return None  # an error frame
        identifier |= EXTENDED
    if found["data"] is None:
        frame = Frame(identifier, remote=True, length=int(found["length"] or 0))
    else:
        frame = Frame(identifier, bytes.fromhex(found["data"].replace(".", "")))
    time = float(found["time"]) if found["time"] else None
    return Logged(time, frame, found["bus"] or "", found["way"] or "")


def read_log(lines: Iterable[str], name: str = "") -> Iterator[Logged]:
    """The frames of a log. Raises LogLineError with file and line."""
    for number, line in enumerate(lines, start=1):
        try:
            logged = parse_line(line)
        except LogLineError as error:
            raise LogLineError(f"{name or 'line'}{':' if name else ' '}{number}: {error}") from None
        if logged is not None:
            yield logged


def format_frame(frame: Frame) -> str:
    """`601#4000100000000000`."""
    digits = f"{frame.id & HIGHEST_EXTENDED_ID:08X}" if frame.id & EXTENDED else f"{frame.id:03X}"
    return f"{digits}#{f'R{frame.length}' if frame.remote else frame.data.hex().upper()}"


def format_line(microseconds: int, frame: Frame, bus: str = "can0", way: str = "") -> str:
    """A line of a log, without its end."""
    seconds, rest = divmod(microseconds, 1_000_000)
    return f"({seconds:010}.{rest:06}) {bus} {format_frame(frame)}{f' {way}' if way else ''}"
