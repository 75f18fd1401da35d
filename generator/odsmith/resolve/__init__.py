"""The third pass: names become the things that they name, and the YAML becomes the model.

`resolve` takes the merged tree of a spec and returns a frozen `Device` or `Vocabulary`. It reports every name that
leads nowhere and every value that cannot be read; whether the facts make sense together is for `check`.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace

from odsmith.model import Bit, Device, NamedValue
from odsmith.resolve.device import resolve_areas, resolve_errata, resolve_identity
from odsmith.resolve.drive import (
    homing_values,
    mode_bits,
    mode_numbers,
    mode_values,
    resolve_emergencies,
    resolve_homing,
    resolve_modes,
    resolve_ramp,
)
from odsmith.resolve.manuals import resolve_manuals
from odsmith.resolve.objects import Words, look_up_selectors, pdo_objects, resolve_objects, resolve_pdos
from odsmith.resolve.problems import Node, Problems, section
from odsmith.resolve.vocabulary import named, resolve_vocabulary
from odsmith.vocabulary import Vocabulary


def resolve(spec: Node) -> Device | Vocabulary:
    """Resolve a merged spec. Raises SpecError with every problem found."""
    problems = Problems()
    if ("device" in spec) == ("vocabulary" in spec):
        problems.report(
            "E309",
            spec.where,
            "a file to build needs either a `device:` or a `vocabulary:` section",
            "describe the device here and `include:` the files that it builds on",
        )
        problems.stop_if_any()
    model = _device(spec, problems) if "device" in spec else _vocabulary(spec, problems)
    problems.stop_if_any()
    return replace(model, digest=_digest(model))


def _vocabulary(spec: Node, problems: Problems) -> Vocabulary:
    node = spec["vocabulary"]
    return Vocabulary(identifier=node["identifier"], title=node["title"], **resolve_vocabulary(spec, problems))


def _device(spec: Node, problems: Problems) -> Device:
    vocabulary = resolve_vocabulary(spec, problems)
    numbers = mode_numbers(spec, vocabulary["mode_codes"], problems)
    pds_states = frozenset(state.name for state in vocabulary["pds_states"])
    words = Words(
        axes=section(spec, "axes").get("count", 0),
        areas=resolve_areas(spec),
        bases=section(spec, "bases"),
        units=vocabulary["units"],
        signatures=vocabulary["signatures"],
        effects=vocabulary["effects"],
        roles=vocabulary["roles"],
        pds_states=pds_states,
        nmt_states=frozenset(state.name for state in vocabulary["nmt_states"]),
        storage_groups=named(section(spec, "storage_groups")),
        values=_enumerations(spec, mode_values(numbers)),
        bits={
            "mode_codes": mode_bits(vocabulary["mode_codes"]),
            "error_register": tuple(
                Bit(bit.bit, bit.bit, bit.name, bit.text, True, bit.place)
                for bit in sorted(vocabulary["register_bits"].values(), key=lambda bit: bit.bit)
            ),
        },
        supported_modes=sum({1 << number.bit for number in numbers.values() if number.bit is not None}),
    )
    objects = resolve_objects(spec.get("objects") or (), words, problems)
    by_name = {obj.name: obj for obj in objects}
    look_up_selectors(by_name, problems)
    pdos = resolve_pdos(spec, by_name, problems)
    return Device(
        identifier=spec["device"]["identifier"],
        title=spec["device"]["title"],
        identity=resolve_identity(spec["device"]),
        axes=words.axes,
        areas=words.areas,
        objects=pdo_objects(objects, pdos),
        pdos=pdos,
        max_pdo_entries=section(spec, "pdos").get("max_entries", 8),
        modes=resolve_modes(
            spec,
            numbers,
            by_name,
            pds_states,
            frozenset(command.name for command in vocabulary["pds_commands"]),
            problems,
        ),
        homing_methods=resolve_homing(spec),
        ramp=resolve_ramp(spec, by_name, problems),
        storage_groups=words.storage_groups,
        emergencies=resolve_emergencies(spec, vocabulary, objects, problems),
        errata=resolve_errata(spec),
        manuals=resolve_manuals(spec, problems),
        **vocabulary,
    )


def _enumerations(spec: Node, modes: tuple[NamedValue, ...]) -> dict[str, tuple[NamedValue, ...]]:
    return {"modes": modes, "homing_methods": homing_values(spec)}


def _digest(model: Device | Vocabulary) -> str:
    """A hash of every fact; places do not count (they are not part of a model's repr)."""
    return hashlib.sha256(repr(model).encode()).hexdigest()[:16]
