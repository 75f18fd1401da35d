"""The classes that offer the entries of a dictionary as typed attributes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from odsmith import names
from odsmith.backends.python.names import bits_class, has_names, values_class
from odsmith.backends.python.source import declaration, docstring
from odsmith.canopen_types import DataType
from odsmith.explain import source_text
from odsmith.model import Device, Entry, Object


@dataclass(frozen=True, slots=True)
class Attribute:
    """An entry, or an object with several, as an attribute of a class of names."""

    declaration: str
    doc: str


@dataclass(frozen=True, slots=True)
class NamesClass:
    """The entries of one object, of an axis, or of the device, as attributes."""

    name: str
    doc: str
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True)
class NamesModule:
    """All classes, and what the module must import for them."""

    classes: tuple[NamesClass, ...]
    kinds: tuple[str, ...]
    value_modules: tuple[str, ...]


def names_module(device: Device) -> NamesModule:
    classes = tuple(names_classes(device))
    source = " ".join(attribute.declaration for item in classes for attribute in item.attributes)
    kinds = (kind for kind in ("Family", "Group", "Sub", "Variable") if f" _{kind}(" in source)
    value_modules = (module for module in ("enums", "flags") if f"_{module}." in source)
    return NamesModule(classes, tuple(sorted(["H", *kinds, "Names"])), tuple(value_modules))


def names_classes(device: Device) -> Iterator[NamesClass]:
    """A class for each object with sub-indices, then those of the device and of an axis."""
    for obj in device.objects:
        if has_names(obj):
            subs = tuple(_sub_attribute(obj, entry) for entry in obj.entries)
            yield NamesClass(names.class_name(obj.name), docstring([f"{_title(obj)}.", obj.text], 4), subs)
    once = tuple(_object_attribute(obj) for obj in device.objects if not obj.per_axis)
    yield NamesClass("DeviceObjects", docstring("Objects of the whole device: `DICTIONARY.device`.", 4), once)
    per_axis = tuple(_object_attribute(obj) for obj in device.objects if obj.per_axis)
    doc = "Objects of one axis: `DICTIONARY.axes[0]`. Axes count from 0, but from 1 in the names of the EDS."
    yield NamesClass("AxisObjects", docstring(doc if per_axis else "This device has no axes.", 4), per_axis)


def _sub_attribute(obj: Object, entry: Entry) -> Attribute:
    line = declaration(entry.name, ("_Sub", python_type(obj, entry)), ("_Sub", str(entry.sub)), 4)
    return Attribute(line, docstring([f"{entry.title} (sub-index {entry.sub}).", *_entry_doc(obj, entry)], 4))


def _object_attribute(obj: Object) -> Attribute:
    index, name = f"0x{obj.index:04X}", names.class_name(obj.name)
    where = f"{obj.index:04X}h" + (f" + axis * {obj.stride:X}h" if obj.per_axis else "")
    summary = f"{_title(obj)} ({where})."
    if not has_names(obj):
        entry = obj.entries[0]
        line = declaration(obj.name, ("_Variable", python_type(obj, entry)), ("_Variable", index), 4)
        return Attribute(line, docstring([summary, *_entry_doc(obj, entry)], 4))
    if obj.count > 1 or obj.pdo:
        line = declaration(obj.name, ("_Family", f"{name}[_H]"), ("_Family", f"{index}, {obj.count}, {name}"), 4)
        text = f"{obj.text} One for each PDO: by its number from 1 to {obj.count}."
    else:
        line = declaration(obj.name, ("_Group", f"{name}[_H]"), ("_Group", f"{index}, {name}"), 4)
        text = obj.text
    return Attribute(line, docstring([summary, text, f"Source: {source_text(obj.source)}."], 4))


def _title(obj: Object) -> str:
    return obj.title.replace("{number}", "n")


def python_type(obj: Object, entry: Entry) -> str:
    """What a value of the entry is in Python. A value table may meet a value that it has no name for."""
    if entry.bits:
        return f"_flags.{bits_class(obj, entry)}"
    if entry.values:
        return f"_enums.{values_class(obj, entry)} | int"
    if entry.type is DataType.BOOLEAN:
        return "bool"
    if entry.type.integer:
        return "int"
    if entry.type in (DataType.REAL32, DataType.REAL64):
        return "float"
    return "str" if entry.type is DataType.VISIBLE_STRING else "bytes"


def _entry_doc(obj: Object, entry: Entry) -> Iterator[str]:
    yield entry.text
    mapping = {"no": "", "rx": ", RPDO", "tx": ", TPDO", "both": ", RPDO and TPDO"}[entry.mapping.value]
    facts = [f"{entry.type.value}, {entry.access.value}{mapping}"]
    if entry.signatures:
        facts.append("acts on " + ", ".join(signature.name for signature in entry.signatures))
    elif entry.allowed:
        facts.append(str(entry.allowed))
    if entry.unit:
        facts.append(f"in {entry.unit.symbol}")
    if entry.default is not None:
        value = entry.default.value(0)
        facts.append(f"default {'node-ID + ' if entry.default.node_id else ''}{value}")
    if entry.writable_in:
        facts.append(f"written in {' or '.join(entry.writable_in)} only")
    if entry.access.writable:
        facts.append("not stored" if entry.stored == "never" else f"stored with {entry.stored}")
    yield "; ".join(facts) + "."
    yield f"Source: {source_text(entry.source)}."
