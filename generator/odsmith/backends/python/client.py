"""The classes of a device on a bus: which there are, what they are called, and which objects they hide."""

from __future__ import annotations

import re
from dataclasses import dataclass

from odsmith import names
from odsmith.model import Device

DRIVE_NAMES = frozenset(
    (
        *("axes", "change_bit_rate", "change_node_id", "check_identity", "close", "configure_pdos", "connect"),
        *("disable", "emergencies", "enable", "id", "load_parameters", "network", "nmt_state", "objects", "pause"),
        *("reset", "restore", "save_parameters", "start", "store", "stream", "sync", "use_pdos", "wait"),
    )
)
"""What a drive can do. An object of such a name is found in `drive.objects` only."""

AXIS_NAMES = frozenset(
    (
        *("disable", "enable", "halt", "home", "mode", "move_by", "move_to", "number", "position", "position_in"),
        *("quick_stop", "require_enabled", "reset_fault", "resume", "run", "scale", "set_mode", "state", "status"),
        *("stop", "velocity", "velocity_in", "wait"),
    )
)
"""What an axis can do. An object of such a name is found in the dictionary only."""


@dataclass(frozen=True, slots=True)
class ClientClasses:
    """`hides` lists the objects of the whole device, `axis_hides` those of an axis, that a method hides."""

    name: str
    hides: tuple[str, ...]
    axis_hides: tuple[str, ...]


def client_classes(device: Device) -> ClientClasses:
    hidden = [obj for obj in device.objects if obj.name in (AXIS_NAMES if obj.per_axis else DRIVE_NAMES)]
    return ClientClasses(
        client_name(device),
        tuple(obj.name for obj in hidden if not obj.per_axis),
        tuple(obj.name for obj in hidden if obj.per_axis),
    )


def client_name(device: Device) -> str:
    """The class of the drive: the name of the device as an identifier, `TMCM6212`."""
    name = "".join(re.findall(r"[A-Za-z0-9]+", device.identity.name))
    return name if re.match(r"[A-Z]", name) else names.class_name(device.identity.identifier)


def public_names(device: Device) -> tuple[str, ...]:
    """The names that the module exports."""
    name = client_name(device)
    per_axis = (f"Async{name}Axis", f"{name}Axis") if device.axes else ()
    return tuple(sorted((f"Async{name}", name, *per_axis)))
