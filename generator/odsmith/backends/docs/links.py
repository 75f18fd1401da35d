"""Where each element of a model stands in the reference, and which words of a text lead there.

An element is known by its path in the spec, as errata name it: `objects.controlword`, `pds.transitions.4`. A link is
`page.md#anchor`. Anchors are unique over all pages, so that the single HTML page has the same ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from odsmith.model import Device, Object

OBJECT_PAGES = (
    (0x1000, 0x1FFF, "objects-communication.md", "Communication objects"),
    (0x2000, 0x5FFF, "objects-manufacturer.md", "Manufacturer objects"),
    (0x6000, 0xFFFF, "objects-profile.md", "Profile objects"),
)
"""First and last index of each page of objects, its file and title: the areas of CiA 301, table 41."""


def hexadecimal(value: int, digits: int = 4) -> str:
    """`6040h`, as the standards and the manuals write it."""
    return f"{value:0{digits}X}h"


class Page(NamedTuple):
    """A page of the reference, as the table of contents shows it."""

    file: str
    title: str
    summary: str


def pages(device: Device) -> tuple[Page, ...]:
    """The pages of a device in reading order; what the device lacks has no page."""
    return tuple(page for page, present in _pages(device) if present)


def _pages(device: Device) -> Iterator[tuple[Page, bool]]:
    for low, _, file, title in OBJECT_PAGES:
        count = sum(_object_page(obj) == file for obj in device.objects)
        yield Page(file, title, f"{count} objects from {hexadecimal(low)} on"), bool(count)
    yield Page("pdos.md", "PDOs", "what the PDOs carry at power-on"), bool(device.pdos)
    modes = ", ".join(mode.short for mode in device.modes if mode.bit is not None)
    yield Page("modes.md", "Modes of operation", f"{modes}: bits, objects, recipes"), bool(device.modes)
    homing = f"{len(device.homing_methods)} homing methods"
    yield Page("homing.md", "Homing", homing), bool(device.homing_methods)
    yield Page("ramp.md", "Ramp", "parameters of the ramp generator"), bool(device.ramp)
    machine = "states, commands, transitions, with a diagram"
    yield Page("state-machine.md", "State machine", machine), _has_state_machine(device)
    yield Page("nmt.md", "NMT and LEDs", "states of the node, commands, what the LEDs show"), bool(device.nmt_states)
    rows = f"{len(device.emergencies)} messages: frame, condition, reaction, cause, remedy"
    yield Page("emergencies.md", "Emergencies", rows), bool(device.emergencies)
    used = sum(code.used for code in device.abort_codes)
    codes = f"{len(device.abort_codes)} codes, {used} of them used"
    yield Page("abort-codes.md", "SDO abort codes", codes), bool(device.abort_codes)
    yield Page("storage.md", "Storage", "what is kept over a reset, and how"), bool(device.storage_groups)
    errata = f"{len(device.errata)} places where the manual contradicts itself or a standard"
    yield Page("errata.md", "Errata", errata), bool(device.errata)
    differences = sum(len(erratum.vendor) for erratum in device.errata)
    vendor = f"{differences} ways in which our EDS differs from it, with the decision"
    yield Page("vendor-eds.md", "The vendor's EDS", vendor), bool(device.identity.vendor_eds and differences)
    yield Page("coverage.md", "Coverage", "what each section and table of the manual became"), bool(device.manual)
    changes = bool(device.identity.firmware or device.identity.changes)
    yield Page("changes.md", "Changes", "revisions of the firmware and of this model"), changes


def _has_state_machine(device: Device) -> bool:
    """A vocabulary with the states of CiA 402 makes no drive; an object that reports them does."""
    entries = (entry for obj in device.objects for entry in obj.entries)
    return bool(device.transitions) and any(entry.role in ("controlword", "statusword") for entry in entries)


def _object_page(obj: Object) -> str:
    return next(file for _, high, file, _ in OBJECT_PAGES if obj.index <= high)


def object_link(obj: Object) -> str:
    return f"{_object_page(obj)}#{hexadecimal(obj.index)}"


def element_links(device: Device, present: tuple[Page, ...]) -> dict[str, str]:
    """Path of each element that has a place of its own on one of the pages, and its link."""
    files = {page.file for page in present}
    return {path: link for path, link in _elements(device) if link.partition("#")[0] in files}


def _elements(device: Device) -> Iterator[tuple[str, str]]:
    for obj in device.objects:
        yield f"objects.{obj.name}", object_link(obj)
    yield "pdos", "pdos.md"
    for pdo in device.pdos:
        yield f"pdos.{pdo.kind}.{pdo.number}", f"pdos.md#{pdo.kind}-{pdo.number}"
    for mode in device.modes:
        yield f"modes.{mode.name}", f"modes.md#mode-{mode.name}"
        for recipe in mode.recipes:
            yield f"modes.{mode.name}.recipes.{recipe.name}", f"modes.md#recipe-{mode.name}-{recipe.name}"
    for method in device.homing_methods:
        yield f"homing_methods.{method.name}", f"homing.md#homing-{method.name}"
    for state in device.pds_states:
        yield f"pds.states.{state.name}", f"state-machine.md#state-{state.name}"
    for command in device.pds_commands:
        yield f"pds.commands.{command.name}", f"state-machine.md#command-{command.name}"
    for event in device.pds_events:
        yield f"pds.events.{event.name}", f"state-machine.md#event-{event.name}"
    for transition in device.transitions:
        yield f"pds.transitions.{transition.number}", f"state-machine.md#transition-{transition.number}"
    for parameter in device.ramp:
        yield f"ramp.{parameter.name}", f"ramp.md#ramp-{parameter.name}"
    for row in device.emergencies:
        yield f"emergencies.{row.name}", f"emergencies.md#emergency-{row.name}"
    for bit in device.register_bits.values():
        yield f"error_register.{bit.name}", f"emergencies.md#register-{bit.name}"
    for code in device.abort_codes:
        yield f"abort_codes.{code.name}", f"abort-codes.md#abort-{code.name}"
    for nmt_state in device.nmt_states:
        yield f"nmt.states.{nmt_state.name}", f"nmt.md#nmt-{nmt_state.name}"
    for nmt_command in device.nmt_commands:
        yield f"nmt.commands.{nmt_command.name}", f"nmt.md#nmt-command-{nmt_command.name}"
    for led in device.leds:
        yield f"leds.{led.name}", f"nmt.md#led-{led.name}"
    for group in device.storage_groups.values():
        yield f"storage_groups.{group.name}", f"storage.md#group-{group.name}"
    for erratum in device.errata:
        yield f"errata.{erratum.id}", f"errata.md#{erratum.id}"


def link_of(path: str, elements: dict[str, str]) -> str:
    """The link of the nearest element on the way up from a path; empty where there is none."""
    while path:
        if path in elements:
            return elements[path]
        path = path.rpartition(".")[0]
    return ""


def mentions(device: Device, elements: dict[str, str]) -> dict[str, str]:
    """Words of a text that lead somewhere: indices, object names, emergency codes, abort codes, errata.

    An index of axis 0 wins over an emergency of the same number, that one over an index of another axis.
    """
    links: dict[str, str] = {}
    for obj in device.objects:
        for index in axis_indices(obj, device.axes)[1:]:
            links.update((hexadecimal(index + i), object_link(obj)) for i in range(obj.count))
    for row in device.emergencies:
        links[hexadecimal(row.code)] = elements[f"emergencies.{row.name}"]
    for obj in device.objects:
        links.update((hexadecimal(obj.index + i), object_link(obj)) for i in range(obj.count))
        links[obj.name] = object_link(obj)
    for code in device.abort_codes:
        links[hexadecimal(code.code, 8)] = elements[f"abort_codes.{code.name}"]
    links.update((erratum.id, elements[f"errata.{erratum.id}"]) for erratum in device.errata)
    return links


def axis_indices(obj: Object, axes: int) -> list[int]:
    """The index of an object on each axis; of a device-wide object the only one."""
    return [obj.index + axis * obj.stride for axis in range(axes if obj.per_axis else 1)]
