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
    tree = PathTree(spec)
    for erratum in device.errata:
        for path in erratum.paths:
            if not tree.leads_somewhere(path):
                yield diagnose(
                    "W502",
                    erratum.place,
                    f"erratum {erratum.id} decides `{path}`, which this device does not have",
                    "correct the path, or drop it together with what it decided",
                )


class PathTree:
    """A merged spec, asked for dotted paths such as `objects.controlword.access` or `pds.transitions.16`."""

    def __init__(self, spec: Map) -> None:
        self._spec: Any = spec
        self._lists: dict[int, dict[str, Any]] = {}  # the elements of a list by identity; lists live as long as `spec`

    def leads_somewhere(self, path: str) -> bool:
        """True if the path names something."""
        node = self._spec
        for part in path.split("."):
            if isinstance(node, list):
                node = self._elements(node).get(part)
            elif isinstance(node, dict):
                node = node.get(part)
            else:
                return False
            if node is None:
                return False
        return True

    def _elements(self, items: list[Any]) -> dict[str, Any]:
        found = self._lists.get(id(items))
        if found is None:
            found = self._lists[id(items)] = {
                str(item[key]): item for item in items if isinstance(item, dict) for key in _IDENTITIES if key in item
            }
        return found
