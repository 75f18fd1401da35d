"""The Python package of a device: its dictionary as compact tables, with types, enumerations and all that is known.

The tables are written for the runtime `odsmith_runtime`, which makes objects of them when they are asked for. Modules
are loaded on first use, so that an import of the package costs next to nothing.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from odsmith import escape
from odsmith.backends.python import client as python_client
from odsmith.backends.python import enums as python_enums
from odsmith.backends.python import objects as python_objects
from odsmith.backends.python import tables as tables
from odsmith.backends.python.names import clashes, find_role
from odsmith.backends.python.source import Hex, docstring, literal, reexports, string
from odsmith.backends.python.values import CLASSES, holders
from odsmith.errors import SpecError
from odsmith.model import Device
from odsmith.render import MARK, Backend
from odsmith.vocabulary import Vocabulary

DEVICE_MODULES: Mapping[str, tuple[str, ...]] = {
    "abort_codes": ("ABORT_CODES", "find_abort_code"),
    "client": (),
    "dictionary": ("DICTIONARY", "Dictionary"),
    "emergencies": ("CONDITIONS", "EMERGENCIES", "REACTIONS", "find_emergency"),
    "enums": (),
    "flags": (),
    "homing": ("HOMING_METHODS",),
    "identity": ("IDENTITY",),
    "leds": ("LEDS",),
    "modes": ("MODES",),
    "nmt": ("ERROR_BEHAVIOUR", "NMT_COMMANDS", "NMT_STATES"),
    "objects": ("AxisObjects", "DeviceObjects"),
    "ramp": ("RAMP",),
    "recipes": ("RECIPES",),
    "state_machine": ("STATE_MACHINE", "decode_state"),
    "storage": ("LAYOUT", "STORAGE_GROUPS"),
    "texts": (),
    "units": ("UNITS",),
}
"""The modules of a device's package and their public names, beside the classes that come from the spec."""

VOCABULARY_MODULES: Mapping[str, tuple[str, ...]] = {
    "codes": (),
    "emergencies": ("CONDITIONS", "REACTIONS"),
    "leds": ("LEDS",),
    "nmt": ("NMT_COMMANDS", "NMT_STATES"),
    "roles": ("ROLES",),
    "state_machine": ("STATE_MACHINE", "decode_state"),
    "units": ("UNITS",),
    "values": tuple(name for name, _ in CLASSES.values()),
    "words": (),
}
"""The same for the vocabulary."""


class PythonBackend(Backend):
    name = "python"
    filters: Mapping[str, Callable[..., Any]] = {
        "docstring": docstring,
        "literal": literal,
        "md": escape.markdown,
        "string": string,
        "toml": lambda text: json.dumps(escape.ascii_only(text)),
    }

    def device_context(self, device: Device) -> Mapping[str, object]:
        if found := list(clashes(device)):
            raise SpecError(found)
        enums = list(python_enums.value_tables(device))
        flags = list(python_enums.bit_tables(device))
        conditions = sorted({row.condition for row in device.emergencies})
        reactions = sorted({row.reaction for row in device.emergencies})
        return {
            **_common(device, device.identity.identifier),
            **_modules(
                {
                    **DEVICE_MODULES,
                    "client": python_client.public_names(device),
                    "enums": _names(enums),
                    "flags": _names(flags),
                }
            ),
            "device": device,
            "client": python_client.client_classes(device),
            "identity": device.identity,
            "name_plate": tables.identity(device),
            "example": _example(device),
            "areas": tables.areas(device),
            "objects": tables.objects(device),
            "entries": tables.entries(device),
            "pdos": tables.pdos(device),
            "texts": tables.texts(device),
            "enums": enums,
            "flags": flags,
            "names": python_objects.names_module(device),
            "units": tables.units(tables.units_of(device)),
            "abort_codes": tables.abort_codes(device),
            "emergencies": tables.emergencies(device),
            "conditions": tables.conditions(device.conditions[name] for name in conditions),
            "reactions": tables.named(device.reactions[name] for name in reactions),
            "modes": tables.modes(device),
            "modes_have_bits": any(tables.has_words(device, mode) for mode in device.modes),
            "homing_methods": tables.homing_methods(device),
            "ramp": tables.ramp(device),
            "recipes": tables.recipes(device),
            "step_classes": tables.step_classes(device),
            "layout": Hex(device.layout, 8),
            "error_behaviour": {value: state.code for value, state in device.error_behaviour.items()},
            "storage_groups": tables.named(device.storage_groups.values()),
        }

    def vocabulary_context(self, vocabulary: Vocabulary) -> Mapping[str, object]:
        codes = list(python_enums.codes(vocabulary))
        register = list(python_enums.register_bits(vocabulary))
        words = list(python_enums.words(vocabulary))
        return {
            **_common(vocabulary, vocabulary.identifier),
            **_modules({**VOCABULARY_MODULES, "codes": _names(codes + register), "words": _names(words)}),
            "vocabulary": vocabulary,
            "codes": codes,
            "register": register,
            "words": words,
            "units": tables.units(vocabulary.units.values()),
            "conditions": tables.conditions(vocabulary.conditions.values()),
            "reactions": tables.named(vocabulary.reactions.values()),
            "roles": tables.roles(vocabulary),
            "holders": list(holders(vocabulary)),
        }


def _common(model: Vocabulary, identifier: str) -> dict[str, object]:
    """What the packages of devices and of the vocabulary both hold."""
    return {
        "mark": MARK,
        "identifier": identifier,
        "digest": model.digest,
        "states": tables.states(model),
        "commands": tables.commands(model),
        "events": tables.named(model.pds_events),
        "transitions": tables.transitions(model),
        "nmt_states": tables.nmt_states(model),
        "nmt_commands": tables.nmt_commands(model),
        "leds": tables.leds(model),
    }


def _modules(modules: Mapping[str, tuple[str, ...]]) -> dict[str, object]:
    """The public names of a package, for programs and for type checkers."""
    return {"modules": dict(modules), "reexports": reexports(modules, 4)}


def _names(classes: Iterable[python_enums.Enumeration]) -> tuple[str, ...]:
    return tuple(sorted(name for item in classes for name in (item.name, *item.aliases)))


def _example(device: Device) -> Mapping[str, object]:
    """An entry for the README: the controlword, or else the first object."""
    obj, entry = find_role(device, "controlword") or (device.objects[0], device.objects[0].entries[0])
    holder = "axes[0]" if obj.per_axis else "device"
    sub = f".{entry.name}" if entry.name != obj.name else ""
    path = f"{holder}.{obj.name}{sub}"
    return {"path": path, "on_drive": path.removeprefix("device."), "index": f"0x{obj.index:04X}"}
