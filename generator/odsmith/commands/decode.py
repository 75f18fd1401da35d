"""`odsmith decode`: the frames of a log or of a bus in words."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TextIO

from odsmith.commands.common import add_bus, bus_of, load
from odsmith.errors import UsageError, visible
from odsmith_runtime.device import Frame
from odsmith_runtime.io.decoder import Decoder, Message
from odsmith_runtime.io.log import LogLineError, format_frame, parse_line

_LONGEST_WAIT_S = 0.5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", nargs="?", help="lines of candump, - for the standard input (default: a live bus)")
    parser.add_argument(
        "--device", action="append", default=[], metavar="NAME", help="a model of the bus; repeatable (default: all)"
    )
    add_bus(parser)


def run(options: argparse.Namespace) -> int:
    if options.log and (options.connect or options.interface):
        raise UsageError("a log and a bus at once", "name one of them")
    decoder = Decoder([loaded.package for loaded in load(options.project, options.device)])
    try:
        return _live(options, decoder) if options.log is None else _read(options, decoder)
    except KeyboardInterrupt:  # how one leaves a bus, or a pipe
        return 0


def _read(options: argparse.Namespace, decoder: Decoder) -> int:
    show = _show_json if options.json else _show
    wrong = 0
    with _opened(options.log) as stream:
        for number, line in enumerate(stream, start=1):
            try:
                logged = parse_line(line)
            except LogLineError as error:
                wrong += 1
                print(f"{visible(options.log)}:{number}: {error}", file=sys.stderr)
                continue
            if logged:
                show(logged.time, logged.frame, decoder.decode(logged.frame))
            if options.log == "-":
                sys.stdout.flush()  # it may be live
    return 1 if wrong else 0


def _live(options: argparse.Namespace, decoder: Decoder) -> int:
    show = _show_json if options.json else _show
    with bus_of(options) as bus:
        start = time.monotonic()
        while True:
            frame = bus.receive(_LONGEST_WAIT_S)
            if frame is not None:
                show(time.monotonic() - start, frame, decoder.decode(frame))
                sys.stdout.flush()


class _opened:  # noqa: N801  # used like open
    """A file or the standard input, as text in which no octet is an error."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._file: TextIO | None = None

    def __enter__(self) -> Iterable[str]:
        if self._name == "-":
            return _standard_input()
        self._file = Path(self._name).open(encoding="ascii", errors="backslashreplace")
        return self._file

    def __exit__(self, *_: object) -> None:
        if self._file:
            self._file.close()


def _standard_input() -> Iterator[str]:
    for line in sys.stdin.buffer:
        yield line.decode("ascii", "backslashreplace")


def _show(seconds: float | None, frame: Frame, message: Message) -> None:
    stamp = "" if seconds is None else f"{seconds:.6f}  "
    node = "" if message.node is None else f"node {message.node}"
    print(f"{stamp}{format_frame(frame):<21} {node:<8} {message.service:<9} {visible(message.text)}".rstrip())
    for line in message.more:
        print(f"{'':{len(stamp) + 40}} {visible(line)}")


def _show_json(seconds: float | None, frame: Frame, message: Message) -> None:
    print(
        json.dumps(
            {
                "time": seconds,
                "frame": format_frame(frame),
                "service": message.service,
                "node": message.node,
                "text": message.text,
                **({"more": message.more} if message.more else {}),
                **({"facts": message.facts} if message.facts else {}),
            }
        )
    )
