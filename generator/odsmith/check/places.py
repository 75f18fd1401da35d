"""Where a fact of the model was written, down to the key; looked up only for findings."""

from __future__ import annotations

from typing import Any

from odsmith.canopen_types import Place
from odsmith.load import Map
from odsmith.model import Entry, Object, Pdo


class Places:
    """The merged tree that a model was resolved from, asked for the places of its keys."""

    def __init__(self, spec: Map) -> None:
        self._spec: Any = spec

    def of(self, obj: Object, entry: Entry, key: str) -> Place:
        """A key of an entry, or of its object where the entry inherits it; the entry itself if neither has it."""
        node = next((item for item in self._spec["objects"] if item["name"] == obj.name), None)
        subs = (node or {}).get("subs", {})
        owners = [*(item for item in subs.values() if item.where == entry.place), node]
        return next((owner.place(key) for owner in owners if owner and key in owner), entry.place)

    def of_pdo(self, pdo: Pdo, key: str) -> Place:
        """A key of a PDO, or of the section of PDOs."""
        node = self._spec["pdos"][pdo.kind][str(pdo.number)]
        place: Place = node.place(key)
        return place
