"""The tables of `ods/device.h` beside the dictionary: rows whose members are C text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from odsmith import names
from odsmith.backends.c.dictionary import place_of
from odsmith.backends.c.storage import Storage
from odsmith.backends.c.text import Constant, Group, hexadecimal
from odsmith.canopen_types import DataType
from odsmith.model import Bit, Device, Emergency, Entry, HomingMethod, Mode, Object
from odsmith.vocabulary import Led, Vocabulary

C_TYPE_CODES: Mapping[DataType, str] = {
    DataType.BOOLEAN: "ODS_BOOL",
    DataType.INTEGER8: "ODS_I8",
    DataType.INTEGER16: "ODS_I16",
    DataType.INTEGER32: "ODS_I32",
    DataType.INTEGER64: "ODS_I64",
    DataType.UNSIGNED8: "ODS_U8",
    DataType.UNSIGNED16: "ODS_U16",
    DataType.UNSIGNED32: "ODS_U32",
    DataType.UNSIGNED64: "ODS_U64",
    DataType.REAL32: "ODS_REAL32",
    DataType.REAL64: "ODS_REAL64",
    DataType.VISIBLE_STRING: "ODS_VISIBLE_STRING",
    DataType.OCTET_STRING: "ODS_OCTET_STRING",
    DataType.DOMAIN: "ODS_DOMAIN",
}


@dataclass(frozen=True, slots=True)
class ModeRow:
    code: int
    bit: str
    control: str
    status: str
    slow_down_ramp: str
    title: str


@dataclass(frozen=True, slots=True)
class StateRow:
    mask: str
    value: str
    state: str
    power: int


@dataclass(frozen=True, slots=True)
class CommandRow:
    mask: str
    value: str
    edge: str
    command: str


@dataclass(frozen=True, slots=True)
class TransitionRow:
    start: str
    by: str
    end: str
    number: int


@dataclass(frozen=True, slots=True)
class HomingRow:
    method: int
    direction: int
    edge: int
    reference: str
    reverse_at: str
    flags: str
    title: str


@dataclass(frozen=True, slots=True)
class RampRow:
    parameter: str
    field: str
    type: str


@dataclass(frozen=True, slots=True)
class MotorParameterRow:
    index: str
    field: str
    type: str


@dataclass(frozen=True, slots=True)
class EmergencyRow:
    code: str
    bytes: str
    axis_byte: str
    register: str
    condition: str
    reaction: str
    momentary: int
    driver_flag: int
    title: str


@dataclass(frozen=True, slots=True)
class StoreRow:
    index: str
    groups: str
    sub: int
    axis: str
    title: str


@dataclass(frozen=True, slots=True)
class LedRow:
    led: str
    when: str
    priority: int
    steady: int
    first: int
    phases: int
    title: str


@dataclass(frozen=True, slots=True)
class ServiceRow:
    state: str
    services: str


def group_name(device: Device, group: str) -> str:
    """The macro that numbers a storage group."""
    return names.constant(device.identity.identifier, "GROUP", group)


def flags(*items: str, join: str = " | ") -> str:
    """Flags that are set, joined; 0 for none."""
    return join.join(item for item in items if item) or "0"


def storage_groups(device: Device) -> Group:
    constants = tuple(
        Constant(group_name(device, group.name), f"{number}u", group.text, group.place)
        for number, group in enumerate(device.storage_groups.values(), 1)
    )
    return Group("Storage groups: what is stored together.", constants)


def mode_bits(device: Device) -> Iterator[Group]:
    """Bits of controlword and statusword that depend on the mode of operation, supported or not."""
    for mode in device.modes:
        tables = (("CONTROL", mode.control_bits), ("STATUS", mode.status_bits))
        yield Group(
            f"{mode.title}: its bits of controlword and statusword.",
            tuple(
                Constant(
                    names.constant(device.identity.identifier, kind, mode.short, bit.name),
                    hexadecimal(bit.mask, 4),
                    bit.text,
                    bit.place,
                )
                for kind, bits in tables
                for bit in bits
            ),
        )


def emergency_codes(device: Device) -> Group:
    return Group(
        "Emergency error codes.",
        tuple(
            Constant(
                names.constant(device.identity.identifier, "EMCY", row.name),
                hexadecimal(row.code, 4),
                row.title,
                row.place,
            )
            for row in device.emergencies
        ),
    )


def modes(storage: Storage) -> list[ModeRow]:
    return [_mode(storage, mode) for mode in storage.device.modes]


def _mode(storage: Storage, mode: Mode) -> ModeRow:
    ramp = storage.device.object(mode.slow_down_ramp)
    field = _axis_field(storage, ramp, ramp.entries[0]) if ramp else ""
    return ModeRow(
        mode.code,
        "ODS_NONE" if mode.bit is None else str(mode.bit),
        _mask(mode.control_bits),
        _mask(mode.status_bits),
        f"AT_AXIS({field})" if field else "ODS_NOWHERE",
        mode.title,
    )


def _mask(bits: tuple[Bit, ...]) -> str:
    """What the device supports of a table of bits."""
    return hexadecimal(sum(bit.mask for bit in bits if bit.supported), 4)


def _axis_field(storage: Storage, obj: Object, entry: Entry) -> str:
    """The member of the values of an axis that holds an entry; empty for a constant."""
    location = storage.location(obj, entry)
    return location.designator if location and location.struct == "axis" else ""


def pds_states(vocabulary: Vocabulary) -> list[StateRow]:
    return [
        StateRow(hexadecimal(item.mask, 4), hexadecimal(item.value, 4), _state(item.name), int(item.power))
        for item in vocabulary.pds_states
    ]


def pds_commands(vocabulary: Vocabulary) -> list[CommandRow]:
    return [
        CommandRow(
            hexadecimal(item.mask, 4),
            hexadecimal(item.value, 4),
            hexadecimal(item.edge, 4),
            names.constant("ODS_PDS_COMMAND", item.name),
        )
        for item in vocabulary.pds_commands
    ]


def pds_transitions(vocabulary: Vocabulary) -> list[TransitionRow]:
    commands = {item.name for item in vocabulary.pds_commands}
    return [
        TransitionRow(
            _state(start) if start else "ODS_NONE",
            names.constant("ODS_PDS_COMMAND" if by in commands else "ODS_PDS_EVENT", by),
            _state(transition.end),
            transition.number,
        )
        for transition in vocabulary.transitions
        for start in transition.start or ("",)
        for by in transition.by
    ]


def _state(name: str) -> str:
    return names.constant("ODS_PDS_STATE", name)


def homing_methods(device: Device) -> list[HomingRow]:
    return [_homing(method) for method in device.homing_methods]


def _homing(method: HomingMethod) -> HomingRow:
    return HomingRow(
        method.method,
        method.direction,
        method.edge,
        names.constant("ODS_SWITCH", method.switch),
        names.constant("ODS_SWITCH", method.reverse_at),
        flags("ODS_HOMING_INDEX_PULSE" if method.index_pulse else "", "ODS_HOMING_POWER" if method.needs_power else ""),
        method.title,
    )


def ramp(storage: Storage) -> list[RampRow]:
    rows = []
    for parameter in storage.device.ramp:
        obj = storage.device.object(parameter.object)
        field = _axis_field(storage, obj, obj.entries[0]) if obj else ""
        if obj and field:
            parameter_name = names.constant("ODS_RAMP", parameter.name)
            rows.append(RampRow(parameter_name, f"AT_AXIS({field})", C_TYPE_CODES[obj.entries[0].type]))
    return rows


def motor_parameters(storage: Storage) -> list[MotorParameterRow]:
    """Values that the motor driver is told: all of them variables of an axis, as E424 has it."""
    return [
        MotorParameterRow(
            hexadecimal(obj.index, 4), f"AT_AXIS({_axis_field(storage, obj, entry)})", C_TYPE_CODES[entry.type]
        )
        for obj in storage.device.objects
        for entry in obj.entries
        if entry.effect and storage.device.effects[entry.effect].to_driver
    ]


def emergencies(device: Device) -> list[EmergencyRow]:
    return [_emergency(device, row) for row in device.emergencies]


def _emergency(device: Device, row: Emergency) -> EmergencyRow:
    return EmergencyRow(
        hexadecimal(row.code, 4),
        ", ".join("0" if byte == "axis" else str(byte) for byte in row.bytes),
        str(row.bytes.index("axis")) if row.per_axis else "ODS_NONE",
        hexadecimal(sum(1 << device.register_bits[name].bit for name in row.register), 2),
        names.constant("ODS_CONDITION", row.condition),
        names.constant("ODS_REACTION", row.reaction),
        int(row.momentary),
        row.driver_flag,
        row.title,
    )


def stores(device: Device) -> list[StoreRow]:
    """Entries that store or restore groups of values."""
    return [_store(device, obj, entry) for obj in device.objects for entry in obj.entries if entry.groups]


def _store(device: Device, obj: Object, entry: Entry) -> StoreRow:
    numbers = list(device.storage_groups)
    return StoreRow(
        hexadecimal(obj.index, 4),
        hexadecimal(sum(1 << numbers.index(group) for group in entry.groups), 4),
        entry.sub,
        str(entry.repeat) if entry.per_axis else "ODS_ALL_AXES",
        entry.title,
    )


def leds(vocabulary: Vocabulary) -> tuple[list[LedRow], list[int]]:
    """Rows, and the pool of phases that they take theirs from."""
    rows: list[LedRow] = []
    pool: list[int] = []
    for led in vocabulary.leds:
        rows += _led(led, pool)
    return rows, pool


def _led(led: Led, pool: list[int]) -> Iterator[LedRow]:
    for pattern in led.patterns:
        first = place_of(list(pattern.phases), pool)
        for when in pattern.when:
            yield LedRow(
                names.constant("ODS_LED", led.name),
                names.constant("ODS_LED_WHEN", when),
                pattern.priority,
                int(pattern.steady == "on"),
                first,
                len(pattern.phases),
                pattern.title,
            )


def nmt_services(vocabulary: Vocabulary) -> list[ServiceRow]:
    return [
        ServiceRow(
            names.constant("ODS_NMT_STATE", state.name),
            flags(*(names.constant("ODS_SERVICE", item) for item in state.services), join=f" |\n{' ' * 12}"),
        )
        for state in vocabulary.nmt_states
    ]
