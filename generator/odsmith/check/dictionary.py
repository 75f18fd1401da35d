"""Checks of the object dictionary: values, types, ranges, indices, roles."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, pairwise

from odsmith.canopen_types import Access, PdoDirection
from odsmith.check.places import Places
from odsmith.errors import Diagnostic
from odsmith.fields import allowed_values
from odsmith.model import Default, Device, Entry, ExpandedObject, NamedValue, Object
from odsmith.rules import diagnose
from odsmith.vocabulary import Role

MANDATORY = {0x1000: "device type", 0x1001: "error register", 0x1018: "identity object"}
"""Objects that every CANopen device has (CiA 301, clause 7.5.1)."""

ERROR_BEHAVIOUR = "error_behaviour"
"""The effect of entries whose values say what an error does to the NMT state (CiA 301, clause 7.5.2.32)."""

NODE_IDS = (1, 127)
"""The smallest and the largest node-ID: what a default with $NODEID may become."""


SET_UP = frozenset(
    {"consumer_heartbeat", "store", "restore", "pdo_cob_id", "pdo_parameter", "pdo_mapped_count", "pdo_mapping"}
)
"""Effects that set up communication or storing; those that set up a motor driver say so themselves."""


def check_dictionary(device: Device, places: Places) -> Iterator[Diagnostic]:
    yield from _mandatory(device)
    yield from _indices(device)
    for obj in device.objects:
        yield from _area(device, obj)
        for entry in obj.entries:
            yield from _EntryCheck(obj, entry, places).run(device)
    yield from _roles_used_twice(device, places)
    yield from _nmt_states(device)
    yield from _driver_values(device, places)
    yield from _set_up_in_pdos(device, places)


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
    taken: dict[int, ExpandedObject] = {}
    reported: set[tuple[str, str]] = set()  # axes repeat everything: the first clash of two objects tells it all
    for item in device.expanded:
        other = taken.setdefault(item.index, item)
        past_the_end = item.index > 0xFFFF
        pair = (item.object.name, "" if past_the_end else other.object.name)
        if (other is item and not past_the_end) or pair in reported:
            continue
        reported.add(pair)
        if past_the_end:
            yield diagnose(
                "E402",
                item.object.place,
                f"`{item.object.name}` of axis {item.axis} lies at {item.index:X}h, past the end of the dictionary",
                "fewer axes, or a smaller stride",
            )
            continue
        yield diagnose(
            "E403",
            item.object.place,
            f"{item.index:04X}h is taken twice: by `{other.object.name}`{_of_axis(other.axis)}"
            f" and by `{item.object.name}`{_of_axis(item.axis)}",
            "the strides of the axes overlap: move one of the objects, or change `axes.areas`",
            notes=((other.object.place, f"`{other.object.name}` is written here"),),
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


class _EntryCheck:
    """The checks of one entry, each a generator of findings at the key that they are about."""

    def __init__(self, obj: Object, entry: Entry, places: Places) -> None:
        self.obj = obj
        self.entry = entry
        self.places = places
        self.name = label(obj, entry)

    def finding(self, rule: str, key: str, message: str, hint: str = "") -> Diagnostic:
        return diagnose(rule, self.places.of(self.obj, self.entry, key), message, hint)

    def run(self, device: Device) -> Iterator[Diagnostic]:
        yield from self.numbers() if self.entry.type.integer else self.no_numbers()
        yield from self.bits()
        yield from self.access()
        yield from self.nmt_states()
        role = device.roles.get(self.entry.role)
        if role:
            yield from self.role(role, bool(device.axes))

    def numbers(self) -> Iterator[Diagnostic]:
        name, data_type, allowed = self.name, self.entry.type, self.entry.allowed
        holds = f"{data_type} holds {data_type.low}..{data_type.high}"
        written = allowed if allowed != allowed_values([value.value for value in self.entry.values]) else None
        if written and not data_type.low <= written.low <= written.high <= data_type.high:
            yield self.finding("E407", "range", f"the range {written} of {name} is outside {data_type}", holds)
        if self.entry.default:
            yield from self.default(self.entry.default, holds)
        for value in self.entry.values:
            if not data_type.low <= value.value <= data_type.high:
                yield diagnose("E405", value.place, f"the value {value.value} of {name} is outside {data_type}", holds)
            elif allowed and value.value not in allowed:
                yield diagnose("E410", value.place, f"the value {value.value} of {name} is not in its range {allowed}")

    def default(self, default: Default, holds: str) -> Iterator[Diagnostic]:
        data_type, allowed = self.entry.type, self.entry.allowed
        for node_id in NODE_IDS if default.node_id else (0,):
            number = default.number + node_id
            shown = f"{number} of {self.name}" + (f" at node-ID {node_id}" if node_id else "")
            if not data_type.low <= number <= data_type.high:
                yield self.finding("E408", "default", f"the default {shown} is outside {data_type}", holds)
                return
            if allowed and number not in allowed:
                message = f"the default {shown} is not among the allowed values {allowed}"
                yield self.finding("E409", "default", message)
                return

    def no_numbers(self) -> Iterator[Diagnostic]:
        entry = self.entry
        if entry.allowed or entry.bits:
            yield self.finding("E411", "type", f"{self.name} is a {entry.type}: it has neither a range nor bits")
        if entry.type.string and not entry.length:
            message = f"{self.name} is a {entry.type} without a length"
            yield self.finding("E413", "type", message, "add `length:` in octets")
        octets = len((entry.default.text or "").encode()) if entry.default else 0
        if octets > entry.length:
            message = f"the default of {self.name} has {octets} octets, its length is {entry.length}"
            yield self.finding("E408", "default", message)

    def bits(self) -> Iterator[Diagnostic]:
        bits = self.entry.bits
        for bit in bits:
            if self.entry.type.integer and bit.high >= self.entry.type.bits:
                message = f"bit {bit.label} of {self.name} is outside {self.entry.type}"
                yield diagnose("E406", bit.place, message)
        for first, second in pairwise(bits):
            if second.low <= first.high:
                message = f"bit {second.label} of {self.name} is described twice"
                yield diagnose("E412", second.place, message, notes=((first.place, f"`{first.name}` takes it too"),))

    def access(self) -> Iterator[Diagnostic]:
        entry, name = self.entry, self.name
        if entry.access.writable and not entry.effect:
            yield diagnose("E414", entry.place, f"{name} can be written but says not what that does", "add `effect:`")
        if entry.access is Access.CONST and entry.role:
            message = f"{name} is constant and yet has a role"
            yield self.finding("E415", "role", message, "make it `access: ro`, or drop the role")
        if entry.hidden_default and entry.default is None:
            message = f"{name} hides a default that it does not have"
            yield self.finding("E416", "hidden_default", message, "add `default:`")
        if entry.mapping.transmittable and not entry.access.readable:
            message = f"{name} cannot be read, so no TPDO can carry it"
            yield self.finding("E417", "mapping", message, "make it `mapping: rx`")
        if entry.mapping.receivable and not entry.access.writable:
            message = f"{name} cannot be written, so no RPDO can carry it"
            yield self.finding("E417", "mapping", message, "make it `mapping: tx`")

    def nmt_states(self) -> Iterator[Diagnostic]:
        for value in self.entry.values:
            if value.nmt_state and self.entry.effect != ERROR_BEHAVIOUR:
                yield diagnose(
                    "E422",
                    value.place,
                    f"the value {value.value} of {self.name} names an NMT state, but {self.name} is no error behaviour",
                    f"drop `nmt_state`, or make it `effect: {ERROR_BEHAVIOUR}`",
                )

    def role(self, role: Role, has_axes: bool) -> Iterator[Diagnostic]:
        entry, name = self.entry, self.name
        scope = "pdo" if self.obj.pdo else "axis" if self.obj.per_axis else "device"
        if role.scope != scope and (has_axes or "pdo" in (role.scope, scope)):
            yield self.finding("E418", "role", f"the role `{role.name}` is one of each {role.scope}, {name} is not")
        elif role.effect and entry.effect not in ("", role.effect):
            message = f"the role `{role.name}` needs the effect `{role.effect}`, {name} has `{entry.effect}`"
            yield self.finding("E425", "effect", message, f"make it `effect: {role.effect}`")
        if role.type is not entry.type:
            yield self.finding("E419", "role", f"the role `{role.name}` is {role.type}, {name} is {entry.type}")
        if role.type.string and entry.length > role.length:
            message = f"the role `{role.name}` holds {role.length} octets, {name} {entry.length}"
            yield self.finding("E419", "role", message)
        if role.count > 1 and entry.repeat >= role.count:
            message = f"the role `{role.name}` has {role.count} elements, {name} would be one more"
            yield self.finding("E420", "role", message)


def _roles_used_twice(device: Device, places: Places) -> Iterator[Diagnostic]:
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
                    places.of(obj, entry, "role"),
                    f"the role `{role.name}` is taken by {label(*other)} and by {label(obj, entry)}",
                    "one value has one place in the dictionary",
                    notes=((other[1].place, "taken here first"),),
                )


def _nmt_states(device: Device) -> Iterator[Diagnostic]:
    """The choices of error behaviour are one table, whatever the error."""
    seen: dict[int, NamedValue] = {}
    choices = (entry.values for obj in device.objects for entry in obj.entries if entry.effect == ERROR_BEHAVIOUR)
    for value in chain.from_iterable(choices):
        first = seen.setdefault(value.value, value)
        if first.nmt_state != value.nmt_state:
            yield diagnose(
                "E423",
                value.place,
                f"error behaviour {value.value} {_leads(value)} here, but {_leads(first)} elsewhere",
                "one value means the same for every error",
                notes=((first.place, f"it {_leads(first)} here"),),
            )


def _driver_values(device: Device, places: Places) -> Iterator[Diagnostic]:
    """What an effect hands to the motor driver is told by the index alone, as a number of 32 bits."""
    for obj in device.objects:
        for entry in obj.entries:
            if not _is_for_driver(device, entry):
                continue
            if obj.scope != "axis" or entry.sub != 0 or not entry.type.integer or entry.bit_length > 32:
                yield diagnose(
                    "E424",
                    places.of(obj, entry, "effect"),
                    f"the effect `{entry.effect}` hands {label(obj, entry)} to the motor driver",
                    "that has to be a variable of an axis, an integer of up to 32 bits",
                )


def _is_for_driver(device: Device, entry: Entry) -> bool:
    return bool(entry.effect) and device.effects[entry.effect].to_driver


def _set_up_in_pdos(device: Device, places: Places) -> Iterator[Diagnostic]:
    """Some effects depend on the address that was written, which a PDO does not carry."""
    for obj in device.objects:
        for entry in obj.entries:
            set_up = entry.effect in SET_UP or _is_for_driver(device, entry)
            if set_up and entry.mapping in (PdoDirection.RX, PdoDirection.BOTH):
                yield diagnose(
                    "E434",
                    places.of(obj, entry, "mapping"),
                    f"{label(obj, entry)} has the effect `{entry.effect}`, which no PDO may carry",
                    "leave `mapping` out",
                )


def _leads(value: NamedValue) -> str:
    return f"leads to `{value.nmt_state}`" if value.nmt_state else "changes no NMT state"
