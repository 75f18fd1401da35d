"""Check that errata decide something: each of their paths names an element of the spec."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from odsmith.errors import Diagnostic
from odsmith.load import Map
from odsmith.model import Device
from odsmith.rules import diagnose

_IDENTITIES = ("name", "number", "id")


def check_errata(device: Device, spec: Map) -> Iterator[Diagnostic]:
    """A path that leads nowhere is only a warning: a device may drop what the erratum of its family decides."""
    for erratum in device.errata:
        for path in erratum.paths:
            if not leads_somewhere(spec, path):
                yield diagnose(
                    "W502",
                    erratum.place,
                    f"erratum {erratum.id} decides `{path}`, which this device does not have",
                    "correct the path, or drop it together with what it decided",
                )


def leads_somewhere(spec: Map, path: str) -> bool:
    """True if a dotted path such as `objects.controlword.access` names something in a merged spec."""
    node: Any = spec
    for part in path.split("."):
        if isinstance(node, dict) and part in node:
            node = node[part]
        elif isinstance(node, list):
            node = next((item for item in node if part in _names(item)), None)
        elif isinstance(node, dict) and "subs" in node and part in node["subs"]:
            node = node["subs"][part]
        else:
            return False
        if node is None:
            return False
    return True


def _names(item: Any) -> set[str]:
    return {str(item[key]) for key in _IDENTITIES if key in item} if isinstance(item, dict) else set()
