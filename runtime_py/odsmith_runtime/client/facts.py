"""What a client has to know about a device, gathered from its generated package."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import NoSuchObjectError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from ..abort_codes import AbortCodeInfo
    from ..dictionary import ObjectDictionary
    from ..emergencies import EmergencyTable
    from ..entries import Entry
    from ..identity import Identity
    from ..modes import HomingMethodInfo, ModeInfo
    from ..names import Names
    from ..state_machine import StateMachine


class Facts(NamedTuple):
    """The tables of one device. Those that a device without axes lacks are empty."""

    identity: Identity
    dictionary: ObjectDictionary
    find_abort_code: Callable[[int], AbortCodeInfo | None]
    emergencies: EmergencyTable
    state_machine: StateMachine | None
    modes: Mapping[int, ModeInfo]
    homing_methods: Mapping[int, HomingMethodInfo]
    device_objects: type[Names[Any]]
    axis_objects: type[Names[Any]]
    roles: Mapping[str, tuple[int, int]]  # base index and sub-index of the first entry with a role

    @classmethod
    def of(cls, package: str) -> Facts:
        """The facts of a generated package, by its name."""
        module = importlib.import_module(package)
        dictionary = module.DICTIONARY
        return cls(
            identity=module.IDENTITY,
            dictionary=dictionary,
            find_abort_code=module.find_abort_code,
            emergencies=module.EMERGENCIES,
            state_machine=getattr(module, "STATE_MACHINE", None),
            modes=getattr(module, "MODES", {}),
            homing_methods=getattr(module, "HOMING_METHODS", {}),
            device_objects=module.DeviceObjects,
            axis_objects=module.AxisObjects,
            roles=_roles(dictionary),
        )

    def entry(self, role: str, axis: int | None = None) -> Entry[Any]:
        """The entry that plays a role of the vocabulary. Raises NoSuchObjectError if the device has none."""
        found = self.find(role, axis)
        if found is None:
            raise NoSuchObjectError(f"{self.identity.name} has no object for {role}")
        return found

    def find(self, role: str, axis: int | None = None) -> Entry[Any] | None:
        """The same, but None if there is none."""
        place = self.roles.get(role)
        return self.dictionary.at(place[0], axis)[place[1]] if place else None

    def entries(self) -> Iterator[Entry[Any]]:
        """All entries of the device, ascending."""
        for obj in self.dictionary.values():
            yield from obj


def _roles(dictionary: ObjectDictionary) -> dict[str, tuple[int, int]]:
    roles: dict[str, tuple[int, int]] = {}
    for address, row in dictionary.entry_rows.items():
        role = dict(row[4:]).get("role")
        if role:
            roles.setdefault(role, (address >> 8, address & 0xFF))
    return roles
