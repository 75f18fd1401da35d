"""Checks of the object dictionary: values, types, ranges, indices, roles."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.canopen_types import Access
from odsmith.errors import Diagnostic
from odsmith.model import Device, Entry, Object
from odsmith.rules import diagnose

MANDATORY = {0x1000: "device type", 0x1001: "error register", 0x1018: "identity object"}
"""Objects that every CANopen device has (CiA 301, clause 7.5.1)."""


def check_dictionary(device: Device) -> Iterator[Diagnostic]:
    yield from _mandatory(device)
    yield from _indices(device)
    for obj in device.objects:
        yield from _area(device, obj)
        for entry in obj.entries:
            yield from _entry(obj, entry)
            yield from _role(device, obj, entry)
    yield from _roles_used_twice(device)


def label(obj: Object, entry: Entry) -> str:
    """`6040h 'controlword'`, or `607Dh:01 'software_position_limit.minimum'`."""
    if len(obj.entries) == 1 and entry.sub == 0:
        return f"{obj.index:04X}h `{obj.name}`"
    return f"{obj.index:04X}h:{entry.sub:02X} `{obj.name}.{entry.name}`"


def _mandatory(device: Device) -> Iterator[Diagnostic]:
    indices = {obj.index for obj in device.objects}
    for index, title in MANDATORY.items():
        if index not in indices:
            yield diagnose(
                "E401",
                device.identity.place,
                f"the device has no {title} {index:04X}h",
                "every CANopen device has it (CiA 301, clause 7.5.1): add the object",
            )


def _indices(device: Device) -> Iterator[Diagnostic]:
    taken: dict[int, tuple[Object, int | None]] = {}
    for item in device.expanded:
        if item.index > 0xFFFF:
            yield diagnose(
                "E402",
                item.object.place,
                f"`{item.object.name}` of axis {item.axis} lies at {item.index:X}h, past the end of the dictionary",
                "fewer axes, or a smaller stride",
            )
            continue
        other = taken.setdefault(item.index, (item.object, item.axis))
        if other == (item.object, item.axis):
            continue
        yield diagnose(
            "E403",
            item.object.place,
            f"{item.index:04X}h is taken twice: by `{other[0].name}`{_of_axis(other[1])}"
            f" and by `{item.object.name}`{_of_axis(item.axis)}",
            "the strides of the axes overlap: move one of the objects, or change `axes.areas`"
            if item.object is not other[0] and (item.axis or other[1])
            else "give one of them another index",
            notes=((other[0].place, f"`{other[0].name}` is written here"),),
        )


def _of_axis(axis: int | None) -> str:
    return "" if axis is None else f" of axis {axis}"


def _area(device: Device, obj: Object) -> Iterator[Diagnostic]:
    if device.areas and not any(area.first <= obj.index <= area.last for area in device.areas):
        yield diagnose(
            "E404",
            obj.place,
            f"{obj.index:04X}h `{obj.name}` lies neither in an area of the axes nor in `device_wide`",
            "write the index of axis 0, or add its range to `axes.device_wide`",
        )


def _entry(obj: Object, entry: Entry) -> Iterator[Diagnostic]:
    name, data_type, place = label(obj, entry), entry.type, entry.place
    if data_type.integer:
        for value in entry.values:
            if not data_type.low <= value.value <= data_type.high:
                yield diagnose("E405", value.place, f"the value {value.value} of {name} is outside {data_type}")
        for bit in entry.bits:
            if bit.high >= data_type.bits:
                yield diagnose("E406", bit.place, f"bit {bit.label} of {name} is outside {data_type}")
        if entry.allowed and not (data_type.low <= entry.allowed.low and entry.allowed.high <= data_type.high):
            yield diagnose(
                "E407",
                place,
                f"the range {entry.allowed} of {name} is outside {data_type}",
                f"{data_type} holds {data_type.low}..{data_type.high}",
            )
        if entry.default and not entry.default.node_id:
            number = entry.default.number
            if not data_type.low <= number <= data_type.high:
                yield diagnose(
                    "E408",
                    place,
                    f"the default {number} of {name} is outside {data_type}",
                    f"{data_type} holds {data_type.low}..{data_type.high}",
                )
            elif entry.allowed and number not in entry.allowed:
                yield diagnose(
                    "E409", place, f"the default {number} of {name} is not among the allowed values {entry.allowed}"
                )
        for value in entry.values:
            if entry.allowed and value.value not in entry.allowed:
                yield diagnose(
                    "E410", value.place, f"the value {value.value} of {name} is not in its range {entry.allowed}"
                )
    elif entry.allowed or entry.bits:
        yield diagnose("E411", place, f"{name} is a {data_type}: it has neither a range nor bits")
    for first, second in zip(entry.bits, entry.bits[1:], strict=False):
        if second.low <= first.high:
            yield diagnose(
                "E412",
                second.place,
                f"bit {second.label} of {name} is described twice",
                notes=((first.place, f"`{first.name}` takes it too"),),
            )
    if data_type.string and not entry.length:
        yield diagnose("E413", place, f"{name} is a {data_type} without a length", "add `length:` in octets")
    if entry.access.writable and not entry.effect:
        yield diagnose("E414", place, f"{name} can be written but says not what that does", "add `effect:`")
    if entry.access is Access.CONST and entry.role:
        yield diagnose("E415", place, f"{name} is constant and yet has a role", "make it `ro`, or drop the role")
    if entry.hidden_default and entry.default is None:
        yield diagnose("E416", place, f"{name} hides a default that it does not have", "add `default:`")
    if not entry.access.readable and entry.mapping.transmittable:
        yield diagnose("E417", place, f"{name} cannot be read, so no TPDO can carry it", "make it `mapping: rx`")
    if not entry.access.writable and entry.mapping.receivable:
        yield diagnose("E417", place, f"{name} cannot be written, so no RPDO can carry it", "make it `mapping: tx`")


def _role(device: Device, obj: Object, entry: Entry) -> Iterator[Diagnostic]:
    role = device.roles.get(entry.role)
    if role is None:
        return
    name = label(obj, entry)
    scope = "pdo" if obj.pdo else "axis" if obj.per_axis else "device"
    if role.scope != scope and device.axes:
        yield diagnose("E418", entry.place, f"the role `{role.name}` is one of each {role.scope}, {name} is not")
    if role.type is not entry.type:
        yield diagnose("E419", entry.place, f"the role `{role.name}` is {role.type}, {name} is {entry.type}")
    if role.type.string and entry.length > role.length:
        yield diagnose("E419", entry.place, f"the role `{role.name}` holds {role.length} octets, {name} {entry.length}")
    if role.count > 1 and entry.repeat >= role.count:
        yield diagnose(
            "E420", entry.place, f"the role `{role.name}` has {role.count} elements, {name} would be one more"
        )


def _roles_used_twice(device: Device) -> Iterator[Diagnostic]:
    users: dict[tuple[str, str, int], tuple[Object, Entry]] = {}
    for obj in device.objects:
        for entry in obj.entries:
            role = device.roles.get(entry.role)
            if role is None:
                continue
            key = (obj.pdo[:4], role.name, entry.repeat if role.count > 1 else 0)
            other = users.setdefault(key, (obj, entry))
            if other[1] is not entry:
                yield diagnose(
                    "E421",
                    entry.place,
                    f"the role `{role.name}` is taken by {label(*other)} and by {label(obj, entry)}",
                    "one value has one place in the dictionary",
                    notes=((other[1].place, "taken here first"),),
                )
