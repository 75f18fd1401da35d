"""The classes of values: what the runtime keeps for the device, each axis and each PDO, an attribute for each role."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from odsmith.vocabulary import Role, Vocabulary

CLASSES: Mapping[str, tuple[str, str]] = {
    "axis": ("AxisValues", "Values of one axis."),
    "device": ("DeviceValues", "Values of the device."),
    "pdo": ("PdoValues", "Parameters of one PDO, with its mapping."),
}
"""The class of each scope and what it holds."""


@dataclass(frozen=True, slots=True)
class Holder:
    """A class with the roles of one scope: `slots` has the text of each, sorted; `zeros` the expression of its zero."""

    name: str
    text: str
    slots: Mapping[str, str]
    zeros: Mapping[str, str]


def holders(vocabulary: Vocabulary) -> Iterator[Holder]:
    for scope, (class_name, text) in CLASSES.items():
        roles = {role.name: role for role in vocabulary.roles.values() if role.scope == scope}
        slots = {name: roles[name].text for name in sorted(roles, key=_order)}
        yield Holder(class_name, text, slots, {name: _zero(role) for name, role in roles.items()})


def _order(name: str) -> str:
    """Sorts as ruff wants it of `__slots__`: numbers in a name by their value, and before letters."""
    return re.sub(r"\d+", lambda digits: digits[0].zfill(20), name)


def _zero(role: Role) -> str:
    """A number is an int, a real one as its bits; several are a list. A string is octets, as many as it may have."""
    if not role.type.bits:
        return f"bytes({role.length})"
    return f"[0] * {role.count}" if role.count > 1 else "0"
