"""What a node has to know about a device, gathered from its generated package; the twin of `ods/device.h`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType

    from ..dictionary import ObjectDictionary
    from ..emergencies import EmergencyTable
    from ..identity import Identity
    from ..leds import Led
    from ..modes import HomingMethodInfo, ModeInfo
    from ..nmt import NmtCommandInfo, NmtStateInfo
    from ..state_machine import PdsStateInfo, StateMachine


class Tables(NamedTuple):
    """The tables of one device. Those that a device without axes lacks are empty."""

    identity: Identity
    dictionary: ObjectDictionary
    nmt_states: Mapping[int, NmtStateInfo]
    nmt_commands: Mapping[int, NmtCommandInfo]
    error_behaviour: Mapping[int, int]
    emergencies: EmergencyTable
    leds: Mapping[str, Led]
    pds_states: Mapping[str, PdsStateInfo]
    state_machine: StateMachine | None
    modes: Mapping[int, ModeInfo]
    homing_methods: Mapping[int, HomingMethodInfo]
    layout: int
    storage_groups: tuple[str, ...]

    @classmethod
    def of(cls, package: ModuleType) -> Tables:
        """The tables of a generated package: `Tables.of(tmcm6212)`."""
        machine = getattr(package, "STATE_MACHINE", None)
        return cls(
            identity=package.IDENTITY,
            dictionary=package.DICTIONARY,
            nmt_states=package.NMT_STATES,
            nmt_commands=package.NMT_COMMANDS,
            error_behaviour=package.ERROR_BEHAVIOUR,
            emergencies=package.EMERGENCIES,
            leds=package.LEDS,
            pds_states=machine.states if machine else {},
            state_machine=machine,
            modes=getattr(package, "MODES", {}),
            homing_methods=getattr(package, "HOMING_METHODS", {}),
            layout=package.LAYOUT,
            storage_groups=tuple(package.STORAGE_GROUPS),
        )
