"""`odsmith simulate`: a device of the model on a bus that programs can talk to."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

from odsmith.commands.common import (
    Loaded,
    add_interface,
    check_interface,
    explained,
    factor,
    load,
    node_id,
    specification,
)
from odsmith.errors import UsageError, visible
from odsmith_runtime.io.device import VirtualDevice
from odsmith_runtime.io.engine import CHOICES
from odsmith_runtime.io.library import find
from odsmith_runtime.io.simulator import Link, Simulator
from odsmith_runtime.io.socketcand import DEFAULT_ADDRESS, SocketcandServer
from odsmith_runtime.io.state_file import StateFile
from odsmith_runtime.io.watch import Watcher

if TYPE_CHECKING:
    from types import FrameType

_LOOK_S = 0.1  # how often changes are looked for


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("device", help="a device of the project, or a YAML file")
    parser.add_argument(
        "--node-id", type=node_id, action="append", default=[], metavar="N", help="repeatable (default: 1)"
    )
    parser.add_argument(
        "--listen",
        metavar="HOST:PORT",
        help=f"serve socketcand's protocol there, port 0: a free one (default: {DEFAULT_ADDRESS}, if no --interface)",
    )
    add_interface(parser)
    parser.add_argument("--speed", type=factor, default=1.0, metavar="X", help="so much faster than real time")
    parser.add_argument("--engine", choices=CHOICES, default="auto", help="what it runs on (default: C if possible)")
    parser.add_argument("--state", type=Path, metavar="FILE", help="keep stored parameters there")
    parser.add_argument("--record", type=Path, metavar="FILE", help="write a log as `candump -L` does")
    parser.add_argument("--plain", action="store_true", help="print lines instead of a live view")


def run(options: argparse.Namespace) -> int:
    check_interface(options)
    if options.channel and not options.interface:
        raise UsageError("--channel without an --interface", "such as --interface socketcan")
    (loaded,) = load(options.project, [options.device])
    node_ids = options.node_id or [1]
    if len({*node_ids}) < len(node_ids):
        raise UsageError("two devices with one node-ID")
    stopped = threading.Event()
    simulator = Simulator(speed=options.speed)
    links: list[Link] = []
    try:
        with explained():
            server = _connect(options, simulator, links)  # whoever comes while C is compiled waits instead of failing
            state = StateFile(options.state, loaded.package.__name__) if options.state else None
            engine = _prepare_engine(options, loaded)
            devices = [
                VirtualDevice(loaded.package, number, engine=engine, state=state, simulator=simulator)
                for number in node_ids
            ]
        if simulator.link_error:  # not even the boot-up frame gets there
            raise simulator.link_error
    except BaseException:
        for link in links:
            with suppress(OSError):
                link.close()
        raise
    if server:
        server.devices += devices
    _end_on_signals(stopped)  # until here there is nothing to be saved
    _live(options, simulator, devices, server, stopped)
    for device in devices:
        device.save()
    failed = next((device.save_error for device in devices if device.save_error), None)
    if failed:
        raise UsageError(f"the parameters are not saved: {failed}")
    if simulator.link_error:  # it was told when it happened, and shall not look like success
        raise simulator.link_error
    return 0


def _end_on_signals(stopped: threading.Event) -> None:
    def end(number: int, frame: FrameType | None) -> None:
        stopped.set()

    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, end)


def _prepare_engine(options: argparse.Namespace, loaded: Loaded) -> str:
    """Compile the C engine if it is wanted and can be had; gives what to ask for."""
    choice: str = options.engine
    if choice == "python":
        return choice
    from odsmith.engine import build

    try:
        compiled = specification(loaded)
    except UsageError as error:
        if find(loaded.package):  # it was built of a specification that is elsewhere
            return choice
        return _without_c(choice, error)
    try:
        build(compiled, announce=lambda: print("compiling the C engine, once ...", file=sys.stderr, flush=True))
    except (UsageError, OSError) as error:
        return _without_c(choice, error)
    return choice


def _without_c(choice: str, error: UsageError | OSError) -> str:
    """Say why it is Python, and how to get C; an error where C is demanded."""
    if choice == "c":
        raise error
    hint = error.hint if isinstance(error, UsageError) else ""
    print(f"the engine is Python's: {str(error).splitlines()[0]}" + (f"; {hint}" if hint else ""), file=sys.stderr)
    return "python"


def _connect(options: argparse.Namespace, simulator: Simulator, links: list[Link]) -> SocketcandServer | None:
    """The links that the options name. `links` has those that are open, even if this raises."""
    server = None
    if options.record:
        from odsmith_runtime.io.recorder import Recorder

        links.append(Recorder(options.record))
    if options.listen or not options.interface:
        server = SocketcandServer(simulator, options.listen or DEFAULT_ADDRESS)
        if not ip_address(server.host).is_loopback:
            print(f"other machines can reach it at {server.address}: it has no passwords", file=sys.stderr)
        links.append(server)
    if options.interface:
        from odsmith_runtime.io.can_link import CanLink, open_bus

        links.append(CanLink(simulator, open_bus(options.interface, options.channel, options.bitrate)))
    for link in links:
        simulator.connect(link)
    return server


def _live(
    options: argparse.Namespace,
    simulator: Simulator,
    devices: list[VirtualDevice],
    server: SocketcandServer | None,
    stopped: threading.Event,
) -> None:
    """Run until somebody ends it."""
    if sys.stdout.isatty() and not options.plain and not options.json:
        from odsmith.commands.live_view import show

        simulator.start()
        try:
            show(simulator, devices, _places(options, server), stopped)
        finally:
            simulator.stop()
        return
    say = partial(_say_json if options.json else _say, simulator)
    simulator.log = say
    for place in _places(options, server):
        say(f"{devices[0].identity.name} on {place}, engine {devices[0].engine.name}")
    simulator.start()
    try:
        _watch(devices, say, stopped)
    finally:
        simulator.stop()
    say("ended")


def _watch(devices: list[VirtualDevice], say: Callable[[str], None], stopped: threading.Event) -> None:
    watchers = [Watcher(device) for device in devices]
    while True:
        for watcher in watchers:
            for line in watcher.changes():
                say(line)
        if stopped.wait(_LOOK_S):
            return


def _places(options: argparse.Namespace, server: SocketcandServer | None) -> list[str]:
    """Where the devices can be reached."""
    places = [f"socketcand {server.address}"] if server else []
    if options.interface:
        places.append(f"{options.interface} {options.channel or ''}".strip())
    return places


def _say(simulator: Simulator, text: str) -> None:
    print(f"{simulator.wire.now / 1_000_000:12.6f}  {visible(text)}", flush=True)


def _say_json(simulator: Simulator, text: str) -> None:
    print(json.dumps({"time": simulator.wire.now / 1_000_000, "text": text}), flush=True)
