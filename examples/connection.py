"""Where the drive of an example is: by default the virtual one that `odsmith simulate tmcm6212 --listen` offers."""

from __future__ import annotations

import argparse
from typing import Any

DEFAULT_HOST, DEFAULT_PORT = "127.0.0.1", 29536


def arguments() -> dict[str, Any]:
    """What `TMCM6212.connect` takes, from the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--interface", default="socketcand", help="as python-can calls it: socketcan, pcan, ...")
    parser.add_argument("--channel", default="can0")
    parser.add_argument("--bitrate", type=int, help="in bit/s")
    parser.add_argument("--host", default=DEFAULT_HOST, help="of socketcand")
    parser.add_argument("--port", type=int, default=DEFAULT_PORT, help="of socketcand")
    parser.add_argument("--node-id", type=int, default=1)
    given = vars(parser.parse_args())
    if given["interface"] != "socketcand":
        del given["host"], given["port"]
    return {name: value for name, value in given.items() if value is not None}
