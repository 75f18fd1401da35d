"""`odsmith engine`: compile the C engine of devices, for virtual devices that want to be quick."""

from __future__ import annotations

import argparse
import json

from odsmith.engine import build


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("device", nargs="+", help="a device of the project, or a YAML file")
    parser.add_argument("--force", action="store_true", help="compile even if nothing has changed")


def run(options: argparse.Namespace) -> int:
    from odsmith.project import compile_all, select

    built = [build(compiled, force=options.force) for compiled in compile_all(select(options.project, options.device))]
    if options.json:
        print(json.dumps([str(path) for path in built]))
    else:
        for path in built:
            print(path)
    return 0
