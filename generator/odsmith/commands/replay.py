"""`odsmith replay`: feed a log to a bus, or to a virtual device to see whether it does the same again."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

from odsmith.commands.common import add_bus, bus_of, explained, factor, load, node_id
from odsmith.errors import UsageError
from odsmith_runtime.io.engine import CHOICES
from odsmith_runtime.io.log import Logged, read_log
from odsmith_runtime.io.replay import Difference, compare, of_masters


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("log", type=Path, help="lines of candump, such as `simulate --record` writes")
    parser.add_argument(
        "device",
        nargs="?",
        help="run the log against this device, at once, and compare what it sends; hands that inject are in no log",
    )
    parser.add_argument(
        "--node-id",
        type=node_id,
        action="append",
        default=[],
        metavar="N",
        help="with a device; repeatable (default: 1)",
    )
    parser.add_argument("--engine", choices=CHOICES, default="auto", help="with a device: what it runs on")
    parser.add_argument("--speed", type=factor, default=1.0, metavar="X", help="on a bus: so much faster")
    parser.add_argument("--all", action="store_true", help="on a bus: send the frames of devices as well")
    add_bus(parser)


def run(options: argparse.Namespace) -> int:
    with explained(), options.log.open(encoding="ascii", errors="backslashreplace") as stream:
        logged = list(read_log(stream, str(options.log)))
    if not logged:
        raise UsageError(f"{options.log} has no frames")
    return _compare(options, logged) if options.device else _send(options, logged)


def _send(options: argparse.Namespace, logged: list[Logged]) -> int:
    frames = logged if options.all else of_masters(logged)
    with bus_of(options) as bus:
        begin, start = frames[0].time if frames else None, time.monotonic()
        for item in frames:
            if item.time is not None and begin is not None:
                at = start + (item.time - begin) / options.speed
                while (left := at - time.monotonic()) > 0:
                    bus.receive(left)  # nobody wants the answers, but they must not pile up
            bus.send(item.frame)
    if options.json:
        print(json.dumps({"sent": len(frames), "left_out": len(logged) - len(frames)}))
    else:
        print(f"{len(frames)} frames sent, {len(logged) - len(frames)} of devices left out")
    return 0


def _compare(options: argparse.Namespace, logged: list[Logged]) -> int:
    (loaded,) = load(options.project, [options.device])
    with explained():
        same, difference = compare(loaded.package, logged, options.node_id or [1], engine=options.engine)
    if options.json:
        print(json.dumps({"same": same, "difference": difference and difference._asdict()}))
    elif difference:
        _print(same, difference)
    else:
        print(f"the device sent the same {same} frames")
    return 1 if difference else 0


def _print(same: int, difference: Difference) -> None:
    print(f"{same} frames are the same, then at {difference.time:.6f} s")
    print(f"  the log has      {difference.logged or 'nothing more'}")
    print(f"  the device sends {difference.sent or 'nothing more'}")
