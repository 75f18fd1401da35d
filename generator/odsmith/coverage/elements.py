"""The elements of a model: everything that has a source, or should have one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from odsmith.canopen_types import Place, Source
from odsmith.model import Device


@dataclass(frozen=True, slots=True, eq=False)  # each is made once, and told apart by what it is
class Element:
    """One element by its path in the spec, as errata name it: `objects.controlword`, `pds.transitions.4`."""

    path: str
    source: tuple[Source, ...]
    place: Place

    @property
    def kind(self) -> str:
        """What it is one of: `objects`, `pds.transitions`, `errata`."""
        return self.path.rpartition(".")[0] or self.path

    @property
    def name(self) -> str:
        return self.path.rpartition(".")[2]

    def within(self, path: str) -> bool:
        """True if the element is what `path` names, or a part of it."""
        return self.path == path or self.path.startswith(path + ".")


def elements(device: Device) -> Iterator[Element]:
    """Every element of a device, in the order of the format's sections."""
    identity = device.identity
    yield Element("device", (), identity.place)
    if identity.firmware:
        yield Element("device.firmware", (), identity.place)
    for area in device.areas:
        if area.stride:
            yield Element(f"axes.areas.{area.name}", (), area.place)
    once = [area for area in device.areas if not area.stride]
    if once:
        yield Element("axes.device_wide", (), once[0].place)
    for code in device.abort_codes:
        yield Element(f"abort_codes.{code.name}", code.source, code.place)
    for nmt_state in device.nmt_states:
        yield Element(f"nmt.states.{nmt_state.name}", nmt_state.source, nmt_state.place)
    for nmt_command in device.nmt_commands:
        yield Element(f"nmt.commands.{nmt_command.name}", nmt_command.source, nmt_command.place)
    for led in device.leds:
        yield Element(f"leds.{led.name}", led.source, led.place)
    for state in device.pds_states:
        yield Element(f"pds.states.{state.name}", state.source, state.place)
    for command in device.pds_commands:
        yield Element(f"pds.commands.{command.name}", command.source, command.place)
    for event in device.pds_events:
        yield Element(f"pds.events.{event.name}", event.source, event.place)
    for transition in device.transitions:
        yield Element(f"pds.transitions.{transition.number}", transition.source, transition.place)
    for section, named in (
        ("effects", device.effects),
        ("reactions", device.reactions),
        ("storage_groups", device.storage_groups),
    ):
        for item in named.values():
            yield Element(f"{section}.{item.name}", item.source, item.place)
    yield from _drive(device)
    yield from _objects(device)


def _drive(device: Device) -> Iterator[Element]:
    for pdo in device.pdos:
        yield Element(f"pdos.{pdo.kind}.{pdo.number}", pdo.source, pdo.place)
    for mode in device.modes:
        yield Element(f"modes.{mode.name}", mode.source, mode.place)
        for recipe in mode.recipes:
            yield Element(f"modes.{mode.name}.recipes.{recipe.name}", recipe.source, recipe.place)
    for method in device.homing_methods:
        yield Element(f"homing_methods.{method.name}", method.source, method.place)
    for parameter in device.ramp:
        yield Element(f"ramp.{parameter.name}", parameter.source, parameter.place)
    for row in device.emergencies:
        yield Element(f"emergencies.{row.name}", row.source, row.place)
    for erratum in device.errata:
        yield Element(f"errata.{erratum.id}", erratum.source, erratum.place)


def _objects(device: Device) -> Iterator[Element]:
    """Objects, and those of their sub-indices that have a source of their own."""
    for obj in device.objects:
        yield Element(f"objects.{obj.name}", obj.source, obj.place)
        for entry in obj.entries:
            if entry.place != obj.place and entry.source != obj.source:
                yield Element(f"objects.{obj.name}.subs.{entry.sub}", entry.source, entry.place)
