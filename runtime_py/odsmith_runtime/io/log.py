"""CAN frames as lines of text, as candump of can-utils writes them.

With -L, which `canplayer` reads too, and which is written here:

    (1436509052.249713) can0 601#4000100000000000       seconds, bus, CAN-ID # data
    (1436509052.249713) can0 701#R1                     a remote frame and its DLC

A letter at the end says which way a frame went, from the point of view of the virtual device: `T` it sent it, `R` it
received it. Newer can-utils and python-can know this letter; it may be missing.

Without -L, which is only read here; each line may be of either kind:

      can0  601   [8]  40 00 10 00 00 00 00 00
     (1436509052.249713)  can0  701   [1]  remote request     with -t, where seconds may also be date and time

The TX and RX of `candump -x` are not taken for that letter: they speak of the machine on which candump ran.
"""

from __future__ import annotations

import re
from datetime import datetime
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
_PLAIN = re.compile(
    r"""(?:\((?P<time>\d{1,12}\.\d{6,9})\)\s+|\((?P<date>\d{4}-\d\d-\d\d\ \d\d:\d\d:\d\d\.\d{6})(?:\d{3})?\)\s+)?
    (?P<bus>[^\s#()]+)\s+
    (?:[RT]X\s+[B-]\s+[E-]\s+)?
    (?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+
    (?P<length>\[\d{1,4}\])
    (?:\s+(?P<remote>remote\ request)|(?P<data>(?:\s+[0-9A-Fa-f]{2})*))
    (?P<error>\s+ERRORFRAME)?
    (?:\s+'.*')?""",
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
    if plain := _PLAIN.fullmatch(line):
        return _parse_plain(plain)
    found = _LINE.fullmatch(line)
    if found is None:
        if _OTHER.fullmatch(line):
            return None
        raise LogLineError("this is no line of candump")
    identifier = _identifier(found["id"])
    if identifier is None:
        return None
    if found["data"] is None:
        frame = Frame(identifier, remote=True, length=int(found["length"] or 0))
    else:
        frame = Frame(identifier, bytes.fromhex(found["data"].replace(".", "")))
    time = float(found["time"]) if found["time"] else None
    return Logged(time, frame, found["bus"] or "", found["way"] or "")


def _parse_plain(found: re.Match[str]) -> Logged | None:
    identifier = _identifier(found["id"])
    if identifier is None or found["error"] or not re.fullmatch(r"\[[0-8]\]", found["length"]):
        return None  # an error frame, or one of CAN FD, which has two digits
    length = int(found["length"][1])
    data = bytes.fromhex(found["data"] or "")
    if found["remote"]:
        frame = Frame(identifier, remote=True, length=length)
    elif len(data) == length:
        frame = Frame(identifier, data)
    else:
        raise LogLineError(f"{len(data)} octets where [{length}] are announced")
    time = float(found["time"]) if found["time"] else None
    if found["date"]:
        time = _seconds(found["date"])
    return Logged(time, frame, found["bus"])


def _identifier(digits: str) -> int | None:
    """The CAN-ID, those of 29 bits marked; None for an error frame. Raises LogLineError."""
    identifier = int(digits, 16)
    if len(digits) == 3:
        if identifier > HIGHEST_ID:
            raise LogLineError(f"{digits}h is no CAN-ID of 11 bits")
        return identifier
    return identifier | EXTENDED if identifier <= HIGHEST_EXTENDED_ID else None


def _seconds(date: str) -> float:
    """Seconds of a date and time of this machine's zone, as candump writes it."""
    try:
        return datetime.fromisoformat(date).timestamp()
    except (ValueError, OverflowError, OSError):
        raise LogLineError(f"there is no time {date}") from None


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
