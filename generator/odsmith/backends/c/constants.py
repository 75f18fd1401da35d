"""The constants of a dictionary for people who write firmware: indices, bits, values, limits, defaults.

Each name begins with the device and the kind of the constant, so that no two kinds can collide:
`TMCM3230_OBJ_TARGET_POSITION`, `TMCM3230_SUB_HOMING_SPEEDS_FAST`, `TMCM3230_BIT_SWITCH_PARAMETERS_HOME_INVERTED`.
"""

from __future__ import annotations

from collections.abc import Iterator

from odsmith import names
from odsmith.backends.c.storage import is_constant
from odsmith.backends.c.text import Constant, Group, hexadecimal, number, signed
from odsmith.model import Device, Entry, Object

_INT = range(-0x80000000, 0x80000000)
"""What an enumerator can be on every compiler."""


def object_groups(device: Device) -> Iterator[Group]:
    """The constants of each object, in the order of the indices: macros first, then an enumeration for each entry that
    has one."""
    prefix = device.identity.identifier
    for obj in device.objects:
        macros = [Constant(names.constant(prefix, "OBJ", obj.name), hexadecimal(obj.index, 4), place=obj.place)]
        enumerations = []
        for entry in obj.entries:
            macros += _entry(prefix, obj, entry)
            values = _values(prefix, obj, entry)
            if values and all(value.value in _INT for value in entry.values):
                title = f"{obj.title}: {entry.title}" if entry.sub else obj.title
                enumerations.append(Group(f"Values of {title}.", values, enumeration=True))
            else:
                macros += values
        yield Group(f"{obj.index:04X}h {_heading(obj)}", tuple(macros))
        yield from enumerations


def _heading(obj: Object) -> str:
    text = obj.title.replace("{number}", "n")
    return f"{text}. {obj.text}" if obj.text else text


def _path(obj: Object, entry: Entry) -> tuple[str, ...]:
    return (obj.name,) if len(obj.entries) == 1 and entry.sub == 0 else (obj.name, entry.name)


def _entry(prefix: str, obj: Object, entry: Entry) -> Iterator[Constant]:
    path = _path(obj, entry)
    if entry.sub:
        yield Constant(names.constant(prefix, "SUB", *path), f"{entry.sub}u", entry.title, entry.place)
    if not entry.type.integer:
        return
    if entry.allowed and not entry.signatures:
        yield Constant(names.constant(prefix, "MIN", *path), _operand(entry.allowed.low, entry), "", entry.place)
        yield Constant(names.constant(prefix, "MAX", *path), _operand(entry.allowed.high, entry), "", entry.place)
    if entry.default and not is_constant(entry) and not obj.pdo:
        text = "plus the node-ID" if entry.default.node_id else ""
        value = _operand(entry.default.number, entry)
        yield Constant(names.constant(prefix, "DEFAULT", *path), value, text, entry.place)
    for bit in entry.bits:
        mask = hexadecimal(bit.mask, entry.type.bits // 4)
        yield Constant(names.constant(prefix, "BIT", *path, bit.name), mask, bit.text, bit.place)
        if bit.low != bit.high:
            yield Constant(names.constant(prefix, "SHIFT", *path, bit.name), f"{bit.low}u", "", bit.place)


def _operand(value: int, entry: Entry) -> str:
    """The value of a macro, which may stand anywhere in an expression."""
    text = number(value, entry.type)
    return f"({text})" if value < 0 else text


def _values(prefix: str, obj: Object, entry: Entry) -> tuple[Constant, ...]:
    """Enumerators are of type int, so their values are spelled without a suffix."""
    return tuple(
        Constant(
            names.constant(prefix, "VALUE", *_path(obj, entry), value.name),
            signed(value.value) if value.value in _INT else _operand(value.value, entry),
            value.text,
            value.place,
        )
        for value in entry.values
    )
