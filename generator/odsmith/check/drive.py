"""Checks of what a drive does: modes, state machine, homing, emergencies, errata."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic
from odsmith.model import Device
from odsmith.rules import diagnose
from odsmith.vocabulary import Vocabulary


def check_drive(device: Device) -> Iterator[Diagnostic]:
    yield from _twice(device.modes, lambda mode: mode.code, "modes", "code")
    yield from _twice(
        (mode for mode in device.modes if mode.bit is not None), lambda mode: mode.bit, "modes", "bit of 6502h"
    )
    yield from _twice(device.homing_methods, lambda method: method.method, "homing methods", "number")
    yield from _twice(
        device.emergencies, lambda row: f"{row.code:04X}h with first byte {row.bytes[0]}", "emergencies", "code"
    )
    if not device.axes and not device.pds_states:
        for row in device.emergencies:
            if row.per_axis:
                yield diagnose("E446", row.place, f"`{row.name}` names an axis, the device has none")


def check_vocabulary(vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    yield from _twice(vocabulary.abort_codes, lambda code: f"{code.code:08X}h", "abort codes", "code")
    yield from _twice(vocabulary.nmt_states, lambda state: state.code, "NMT states", "code")
    yield from _twice(vocabulary.nmt_commands, lambda command: command.code, "NMT commands", "code")
    yield from _twice(vocabulary.mode_codes, lambda mode: mode.code, "mode codes", "code")
    yield from _reachable(vocabulary)
    yield from _ambiguous(vocabulary)


def _twice(items: Iterable[Any], key: Callable[[Any], object], what: str, of: str) -> Iterator[Diagnostic]:
    seen: dict[object, tuple[str, Place]] = {}
    for item in items:
        value, name = key(item), getattr(item, "name", "")
        if value in seen:
            first, place = seen[value]
            yield diagnose(
                "E441",
                item.place,
                f"two {what} have the {of} {value}" + (f": `{first}` and `{name}`" if name else ""),
                "give one of them another",
                notes=((place, "the first one is here"),),
            )
        else:
            seen[value] = (name, item.place)


def _reachable(vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    reached = {transition.end for transition in vocabulary.transitions if not transition.start}
    while True:
        more = {t.end for t in vocabulary.transitions if reached.intersection(t.start)} - reached
        if not more:
            break
        reached |= more
    for state in vocabulary.pds_states:
        if state.name not in reached:
            yield diagnose(
                "E442",
                state.place,
                f"no transition leads to the PDS state `{state.name}`",
                "add a transition to it, or remove the state",
            )


def _ambiguous(vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """Two states whose statusword patterns can match the same word could not be told apart."""
    states = vocabulary.pds_states
    for number, first in enumerate(states):
        for second in states[number + 1 :]:
            common = first.mask & second.mask
            if first.value & common == second.value & common:
                yield diagnose(
                    "E443",
                    second.place,
                    f"a statusword can mean both `{first.name}` and `{second.name}`",
                    "make the patterns differ in a bit that both of them name",
                    notes=((first.place, f"`{first.name}` is here"),),
                )
