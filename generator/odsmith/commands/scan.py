"""`odsmith scan`: who is on a bus, which models they match, and where they differ from them."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from odsmith.commands.common import add_bus, bus_of, load
from odsmith.console import print_table
from odsmith.errors import visible
from odsmith_runtime.io.scan import Found, scan


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--device", action="append", default=[], metavar="NAME", help="a model to compare; repeatable (default: all)"
    )
    parser.add_argument(
        "--nodes", type=_nodes, default=range(1, 128), metavar="A-B", help="only these (default: 1-127)"
    )
    parser.add_argument("--deep", action="store_true", help="read every object that a matching model has")
    add_bus(parser)


def run(options: argparse.Namespace) -> int:
    packages = [loaded.package for loaded in load(options.project, options.device)]
    with bus_of(options) as bus:
        found = scan(bus, packages, nodes=options.nodes, deep=options.deep)
    if options.json:
        print(json.dumps([asdict(node) for node in found], indent=2))
    else:
        _print(found, options.deep)
    return 1 if any(node.differences for node in found) or not found else 0


def _print(found: list[Found], deep: bool) -> None:
    if not found:
        print("nobody answers")
        return
    print_table(
        [
            {
                "node": node.node_id,
                "state": node.state or "-",
                "name": node.name or "-",
                "vendor": _hex(node.vendor_id),
                "product": _hex(node.product_code),
                "revision": _hex(node.revision_number),
                "serial": "-" if node.serial_number is None else node.serial_number,
                "software": node.software or "-",
                "model": node.model or "-",
            }
            for node in found
        ]
    )
    for node in found:
        for difference in node.differences:
            print(visible(f"node {node.node_id}: {difference}"))
        if deep and node.model and not node.differences:
            print(f"node {node.node_id}: {node.compared} entries are as the model has them")


def _hex(number: int | None) -> str:
    return "-" if number is None else f"{number:08X}h"


def _nodes(word: str) -> range:
    first, dash, last = word.partition("-")
    if not first.isdecimal() or (dash and not last.isdecimal()):
        raise argparse.ArgumentTypeError(f"a node or a range such as 1-16, not {word}")
    nodes = range(int(first), int(last or first) + 1)
    if not nodes or nodes[0] < 1 or nodes[-1] > 127:
        raise argparse.ArgumentTypeError(f"node-IDs are 1 to 127, not {word}")
    return nodes
