"""The classes that a device's Python package declares, and which fact of the model asks for each of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from odsmith import names
from odsmith.canopen_types import ObjectType, Place
from odsmith.errors import Diagnostic
from odsmith.model import Bit, Device, Entry, Mode, Object
from odsmith.rules import diagnose


@dataclass(frozen=True, slots=True)
class Declared:
    """A class, the module that declares it, and what in the spec it is called after."""

    module: str
    name: str
    origin: str
    place: Place


def declared_classes(device: Device) -> Iterator[Declared]:
    """Every class of the package that gets its name from the spec, in the order of the model.

    Two with one name in the same module, or an enumeration and a bit table with one name, cannot both be had.
    """
    for obj in device.objects:
        if has_names(obj):
            yield Declared("objects", names.class_name(obj.name), obj.name, obj.place)
        for entry in obj.entries:
            origin = obj.name if len(obj.entries) == 1 else f"{obj.name}.{entry.name}"
            if entry.values:
                yield Declared("enums", values_class(obj, entry), origin, entry.place)
            if entry.bits:
                yield Declared("flags", bits_class(obj, entry), origin, entry.place)
    for mode in device.modes:
        for word in MODE_WORDS:
            if has_mode_bits(device, mode, word):
                yield Declared("flags", mode_bits_class(mode, word), f"{word} of mode {mode.name}", mode.place)


def clashes(device: Device) -> Iterator[Diagnostic]:
    """Names of the spec that become one class, or one that the package declares anyway."""
    taken: dict[tuple[bool, str], Declared] = {}
    for item in declared_classes(device):
        named_values = item.module != "objects"  # enumerations and bit tables are told apart by name alone
        other = taken.setdefault((named_values, item.name), item)
        if other.origin != item.origin:
            yield diagnose(
                "E451",
                item.place,
                f"`{other.origin}` and `{item.origin}` both become the class {item.name} in Python",
                "rename one of them",
                notes=((other.place, f"`{other.origin}` is here"),),
            )
        elif item.name in RESERVED.get(item.module, ()):
            message = f"`{item.origin}` becomes {item.name} in Python, a class that every package has"
            yield diagnose("E452", item.place, message, "choose another name")


MODE_WORDS = ("controlword", "statusword")
"""The words whose bits depend on the mode, by their roles."""

RESERVED = {"objects": frozenset({"AxisObjects", "DeviceObjects"})}
"""Classes that a module declares whatever the spec says."""


def has_names(obj: Object) -> bool:
    """True for an object whose sub-indices are named by a class of their own."""
    return obj.object_type is not ObjectType.VAR


def values_class(obj: Object, entry: Entry) -> str:
    """The enumeration of an entry: called after its object, and after the entry where there are several."""
    return names.class_name(obj.name if len(obj.entries) == 1 else f"{obj.name}_{entry.name}")


def bits_class(obj: Object, entry: Entry) -> str:
    """The bit table of an entry; an entry may have named values beside it."""
    return values_class(obj, entry) + ("Bits" if entry.values else "")


def mode_bits_class(mode: Mode, word: str) -> str:
    """The bits of controlword or statusword in a mode: `ProfilePositionStatusword`."""
    return names.class_name(f"{mode.name}_{word}")


def has_mode_bits(device: Device, mode: Mode, word: str) -> bool:
    """True where the device has the word and bits of it have a meaning in the mode."""
    return bool(word_bits(device, mode, word))


def word_bits(device: Device, mode: Mode, word: str) -> tuple[Bit, ...]:
    """All bits of controlword or statusword in a mode; none where the device lacks the word."""
    found = find_role(device, word)
    own = mode.control_bits if word == "controlword" else mode.status_bits
    return mode_bits(found[1].bits, own) if found else ()


def find_role(device: Device, role: str) -> tuple[Object, Entry] | None:
    """The entry that has a role which only one entry can have."""
    return next(((obj, entry) for obj in device.objects for entry in obj.entries if entry.role == role), None)


def mode_bits(general: tuple[Bit, ...], of_mode: tuple[Bit, ...]) -> tuple[Bit, ...]:
    """The bits of a word in one mode: those of the mode, and the general ones that they leave."""
    names_taken = {bit.name for bit in of_mode}
    left = (bit for bit in general if bit.name not in names_taken and not any(bit.mask & own.mask for own in of_mode))
    return tuple(sorted((*of_mode, *left), key=lambda bit: bit.low))
