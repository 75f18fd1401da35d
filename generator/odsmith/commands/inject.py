"""`odsmith inject`: do something to a virtual device that runs elsewhere."""

from __future__ import annotations

import argparse
import json
import re
import socket

from odsmith.commands.common import explained, node_id
from odsmith.errors import UsageError
from odsmith_runtime.io.socketcand import DEFAULT_ADDRESS, parse_address

_TIMEOUT_S = 5.0
_MOST = 4096  # octets of an answer


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from odsmith_runtime.io import control

    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.epilog = "\n".join((control.__doc__ or "").splitlines()[2:])
    parser.add_argument("word", nargs="+", help="what to do: axis0 overtemperature on; see below")
    parser.add_argument(
        "--connect", default=DEFAULT_ADDRESS, metavar="HOST:PORT", help="where `odsmith simulate` listens"
    )
    parser.add_argument(
        "--node-id",
        type=node_id,
        default=0,
        metavar="N",
        help="to which node, by its present ID (default: the only one)",
    )


def run(options: argparse.Namespace) -> int:
    with explained():
        host, port = parse_address(options.connect)
    words = " ".join(options.word)
    if not re.fullmatch(r"[\w .-]+", words, re.ASCII):
        raise UsageError(f"`{words}` is no command", "such as: odsmith inject axis0 overtemperature on")
    try:
        answer = _ask(host, port, f"< inject {options.node_id} {words} >")
    except OSError as error:
        reason = error.strerror or str(error)
        raise UsageError(
            f"no virtual device answers at {options.connect}: {reason}", "start one: odsmith simulate tmcm6212"
        ) from None
    if answer != "ok":
        raise UsageError(answer.removeprefix("error "))
    if options.json:
        print(json.dumps({"done": words}))
    return 0


def _ask(host: str, port: int, command: str) -> str:
    """The answer to a command, which is the second thing that a server says. Raises OSError."""
    with socket.create_connection((host, port), _TIMEOUT_S) as sock:
        sock.sendall(command.encode("ascii"))
        text = ""
        while len(said := re.findall("<([^<>]*)>", text)) < 2:
            octets = sock.recv(_MOST)
            if not octets or len(text) > _MOST:
                raise ConnectionError("it does not speak our protocol")
            text += octets.decode("ascii", "replace")
    return str(said[1]).strip()
