"""Checks that the names of a spec become distinct identifiers in C and in Python, and distinct EDS names."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith import names
from odsmith.canopen_types import Place
from odsmith.check.dictionary import label
from odsmith.errors import Diagnostic
from odsmith.model import Device, Entry, Object
from odsmith.rules import diagnose
from odsmith.vocabulary import Vocabulary

EDS_NAME_LENGTH = 241
"""Longest ParameterName (CiA 306, clause 4.6.3.2)."""

PDO_NAME_LENGTH = 32
"""PDO parameter names become frame names elsewhere, which end here."""


def check_identifiers(device: Device) -> Iterator[Diagnostic]:
    yield from _constants(device)
    yield from _parameter_names(device)
    for obj in device.objects:
        yield from _reserved(obj.name, obj.place)
        for entry in obj.entries:
            yield from _members(obj, entry)


def check_roles(vocabulary: Vocabulary) -> Iterator[Diagnostic]:
    """Roles are fields of the runtimes' structs in C and attributes in Python, under their own names."""
    for role in vocabulary.roles.values():
        yield from _reserved(role.name, role.place)


def _constants(device: Device) -> Iterator[Diagnostic]:
    """C macros and Python constants: OBJECT and OBJECT_ENTRY."""
    taken: dict[str, tuple[str, Place]] = {}
    for obj in device.objects:
        spelled = [(names.constant(obj.name), obj.name, obj.place)]
        if len(obj.entries) > 1:
            spelled += [
                (names.constant(obj.name, entry.name), f"{obj.name}.{entry.name}", entry.place)
                for entry in obj.entries
                if entry.sub
            ]
        for constant, name, place in spelled:
            yield from _collision(taken, constant, name, place, "C and Python")


def _collision(
    taken: dict[str, tuple[str, Place]], spelling: str, name: str, place: Place, language: str
) -> Iterator[Diagnostic]:
    other = taken.setdefault(spelling, (name, place))
    if other != (name, place):
        yield diagnose(
            "E451",
            place,
            f"`{other[0]}` and `{name}` both become {spelling} in {language}",
            "rename one of them",
            notes=((other[1], f"`{other[0]}` is here"),),
        )


def _reserved(name: str, place: Place) -> Iterator[Diagnostic]:
    languages = [
        language
        for language, reserved in (("C", names.reserved_in_c(name)), ("Python", names.reserved_in_python(name)))
        if reserved
    ]
    if languages:
        yield diagnose("E452", place, f"`{name}` is a word of {' and of '.join(languages)}", "choose another name")


def _members(obj: Object, entry: Entry) -> Iterator[Diagnostic]:
    yield from _reserved(entry.name, entry.place)
    for items in (entry.values, entry.bits):
        taken: dict[str, Place] = {}
        for item in items:
            if item.name in taken:
                yield diagnose(
                    "E453",
                    item.place,
                    f"{label(obj, entry)} has two members called `{item.name}`",
                    "rename one of them",
                    notes=((taken[item.name], "the first one is here"),),
                )
            taken.setdefault(item.name, item.place)


def _parameter_names(device: Device) -> Iterator[Diagnostic]:
    """Programs look objects up by their EDS name, so it must lead to one object."""
    taken: dict[str, Object] = {}
    reported: set[tuple[str, str]] = set()  # once for all axes
    for item in device.expanded:
        name, place = item.parameter_name, item.object.place
        other = taken.setdefault(name, item.object)
        if other is not item.object and (pair := (other.name, item.object.name)) not in reported:
            reported.add(pair)
            yield diagnose(
                "E454",
                place,
                f"`{other.name}` and `{item.object.name}` are both called `{name}` in the EDS",
                "give one of them another `parameter_name`",
                notes=((other.place, f"`{other.name}` is here"),),
            )
        longest = PDO_NAME_LENGTH if item.object.pdo else EDS_NAME_LENGTH
        if len(name) > longest and (pair := (item.object.name, "")) not in reported:
            reported.add(pair)
            yield diagnose(
                "E455",
                place,
                f"the EDS name `{name}` has {len(name)} characters, {longest} are allowed",
                "shorten its `parameter_name`",
            )
