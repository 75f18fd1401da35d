"""The compiled tables say what the model says: every address of the dictionary, every row of the other tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from odsmith.backends.c.dictionary import REFUSING
from odsmith.canopen_types import DataType
from odsmith.model import Allowed, Device, Entry, ExpandedEntry, ExpandedObject, PdoKind
from odsmith.vocabulary import Vocabulary

Dump = Callable[..., list[str]]

RUNTIME = Path(__file__).parents[3] / "runtime_c"

NODE_ID = 5
"""That of dump_od.c."""

PDO_KINDS: tuple[PdoKind, ...] = ("rpdo", "tpdo")

pytestmark = pytest.mark.slow

DEVICES = ("tmcm3230", "tmcm6212", "io_module", "toy")

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")

BUILDS = [
    pytest.param("cc", (), id="cc"),
    pytest.param("gcc", ("-m32",), id="gcc-m32"),
    pytest.param("clang", ("-m64",), id="clang-m64"),
    pytest.param("gcc", SANITIZERS, id="gcc-sanitizers"),
    pytest.param("clang", SANITIZERS, id="clang-sanitizers"),
]


@pytest.fixture(params=DEVICES)
def device(request: pytest.FixtureRequest) -> Device:
    model = request.getfixturevalue(request.param)
    assert isinstance(model, Device)
    return model


@pytest.mark.parametrize(("compiler", "flags"), BUILDS)
def test_every_address(
    device: Device, vocabulary: Vocabulary, run_dump: Dump, compiler: str, flags: tuple[str, ...]
) -> None:
    """All 2^24 addresses are asked; those of the model answer, with all they are, and no other."""
    printed = run_dump("dump_od", device.identity.identifier, compiler, *flags)
    assert printed == list(_expected_dictionary(device, vocabulary))


def _expected_dictionary(device: Device, vocabulary: Vocabulary) -> Iterator[str]:
    for item in device.expanded:
        for expanded in item.entries:
            yield " ".join(
                (
                    f"{item.index:04X}:{expanded.entry.sub:02X}",
                    expanded.entry.type.value,
                    _access(expanded.entry),
                    expanded.entry.mapping.value,
                    _default(expanded),
                    *_rule(device, vocabulary, expanded.entry),
                    str(_instance(device, item)),
                )
            )


def _access(entry: Entry) -> str:
    return ("rw" if entry.access.readable else "wo") if entry.access.writable else "ro"


def _default(expanded: ExpandedEntry) -> str:
    entry, default = expanded.entry, expanded.default
    value = default.value(NODE_ID) if default else 0
    if entry.type in (DataType.VISIBLE_STRING, DataType.OCTET_STRING, DataType.DOMAIN):
        octets = value.encode() if isinstance(value, str) else b""
        return f"x{octets.ljust(entry.length, bytes(1)).hex()}"
    assert isinstance(value, int)
    return str(value % (1 << max(entry.type.bits, 8)))


def _rule(device: Device, vocabulary: Vocabulary, entry: Entry) -> Iterator[str]:
    if not entry.access.writable:
        yield from "-----"
        return
    every = Allowed(((entry.type.low, entry.type.high),), listed=True) if entry.type.integer else None
    limited = entry.allowed and every and entry.allowed.intervals != every.intervals
    if entry.signatures:
        yield ",".join(f"{item.value}..{item.value}" for item in entry.signatures)
    elif entry.allowed and limited:
        yield ",".join(f"{low}..{high}" for low, high in entry.allowed.intervals)
    else:
        yield "any"
    listed = entry.allowed is not None and entry.allowed.listed
    limits = 1 if entry.signatures else 0 if not limited else 2 if listed else 4
    yield str(limits | (8 if entry.writable_in or entry.effect in REFUSING else 0))
    states = [state.name for state in vocabulary.pds_states]
    yield str(sum(1 << states.index(state) for state in entry.writable_in))
    yield str(0 if entry.stored == "never" else list(device.storage_groups).index(entry.stored) + 1)
    yield str(list(vocabulary.effects).index(entry.effect))


def _instance(device: Device, item: ExpandedObject) -> int:
    """The device, the axes, the RPDOs, the TPDOs; each in order."""
    axis = item.axis or 0
    if item.object.scope == "device":
        return 0
    if item.object.scope == "axis":
        return 1 + axis
    pdos = {kind: len(device.pdos_of(kind)) for kind in ("rpdo", "tpdo")}
    kind = item.object.scope
    first = 1 + device.axes + (pdos["rpdo"] * max(device.axes, 1) if kind == "tpdo" else 0)
    return first + axis * pdos[kind] + item.index - item.object.index - axis * item.object.stride


@pytest.mark.parametrize(("compiler", "flags"), BUILDS)
def test_the_memory_of_a_node(device: Device, run_dump: Dump, compiler: str, flags: tuple[str, ...]) -> None:
    """The generated header has room for everything, and the generated function says where it is."""
    rpdos, tpdos = (len(device.pdos_of(kind)) * max(device.axes, 1) for kind in PDO_KINDS)
    variables = [entry for obj in device.objects for entry in obj.entries if entry.access.writable or entry.role]
    assert run_dump("dump_init", device.identity.identifier, compiler, *flags) == [
        "values 1",
        f"axes {device.axes}",
        f"rpdos {rpdos}",
        f"tpdos {tpdos}",
        f"mapped {(rpdos + tpdos) * device.max_pdo_entries}",
        f"buffer {max(8, *(entry.bit_length // 8 for entry in variables))}",
    ]


def test_the_other_tables(device: Device, vocabulary: Vocabulary, run_dump: Dump) -> None:
    printed = run_dump("dump_device", device.identity.identifier)
    assert printed == list(_expected_tables(device, vocabulary))


def _expected_tables(device: Device, vocabulary: Vocabulary) -> Iterator[str]:
    identity = device.identity
    yield (
        f"identity {identity.name} {identity.vendor_id} {identity.product_code} {identity.revision_number} "
        f"{device.axes} {identity.digital_inputs} {identity.digital_outputs} "
        f"{identity.analog_inputs} {identity.analog_outputs}"
    )
    for rate in identity.bit_rates:
        yield f"bit_rate {rate}"
    services = list(dict.fromkeys(name for state in vocabulary.nmt_states for name in state.services))
    codes = {state.name: state.code for state in vocabulary.nmt_states}
    for state in device.nmt_states:
        yield f"nmt_state {state.code} {sum(1 << services.index(name) for name in state.services)}"
    for command in device.nmt_commands:
        yield f"nmt_command {command.code} {codes[command.to]}"
    choices = (value for obj in device.objects for entry in obj.entries for value in entry.values if value.nmt_state)
    for number, state_name in sorted({value.value: value.nmt_state for value in choices}.items()):
        yield f"error_behaviour {number} {codes[state_name]}"
    leds = [led.name for led in vocabulary.leds]
    whens = list(dict.fromkeys(when for led in vocabulary.leds for p in led.patterns for when in p.when))
    for led in device.leds:
        for pattern in led.patterns:
            for when in pattern.when:
                row = (leds.index(led.name), whens.index(when), pattern.priority, int(pattern.steady == "on"))
                yield " ".join(map(str, ("led", *row, *pattern.phases)))
    conditions = sorted(vocabulary.conditions.values(), key=lambda item: item.scope != "axis")
    numbers = {condition.name: number for number, condition in enumerate(conditions)}
    for emergency in device.emergencies:
        yield " ".join(
            map(
                str,
                (
                    "emergency",
                    emergency.code,
                    *(0 if byte == "axis" else byte for byte in emergency.bytes),
                    emergency.bytes.index("axis") if emergency.per_axis else 255,
                    sum(1 << device.register_bits[name].bit for name in emergency.register),
                    numbers[emergency.condition],
                    list(vocabulary.reactions).index(emergency.reaction),
                    int(emergency.momentary),
                    emergency.driver_flag,
                ),
            )
        )
    groups = list(device.storage_groups)
    for obj in device.objects:
        for entry in obj.entries:
            if entry.groups:
                mask = sum(1 << groups.index(group) for group in entry.groups)
                yield f"store {obj.index} {entry.sub} {mask} {entry.repeat if entry.per_axis else 255}"
    yield from _expected_drive(device, vocabulary)
    yield f"layout {device.layout}"
    for area in device.areas:
        if area.stride and not any(area.first <= obj.index <= area.last for obj in device.objects if obj.pdo):
            yield f"area {area.first} {area.last} {area.stride}"
    for code in device.abort_codes:
        if code.used:
            yield f"abort {code.code}"


def _expected_drive(device: Device, vocabulary: Vocabulary) -> Iterator[str]:
    states = [state.name for state in vocabulary.pds_states]
    triggers = [item.name for item in vocabulary.pds_commands] + [item.name for item in vocabulary.pds_events]
    for mode in device.modes:
        control = sum(bit.mask for bit in mode.control_bits if bit.supported)
        status = sum(bit.mask for bit in mode.status_bits if bit.supported)
        ramp = device.object(mode.slow_down_ramp)
        bit = 255 if mode.bit is None else mode.bit
        yield " ".join(map(str, ("mode", mode.code, bit, control, status, *([ramp.index] if ramp else []))))
    for pds_state in device.pds_states:
        row = (states.index(pds_state.name), pds_state.mask, pds_state.value, int(pds_state.power))
        yield " ".join(map(str, ("state", *row)))
    for command in device.pds_commands:
        yield f"command {triggers.index(command.name)} {command.mask} {command.value} {command.edge}"
    for transition in device.transitions:
        for start in transition.start or ("",):
            for by in transition.by:
                begin = states.index(start) if start else 255
                yield f"transition {transition.number} {begin} {triggers.index(by)} {states.index(transition.end)}"
    switches = ("none", "negative_limit", "positive_limit", "home")
    for method in device.homing_methods:
        switch, reverse_at = switches.index(method.switch), switches.index(method.reverse_at)
        flags = int(method.index_pulse) | int(method.needs_power) << 1
        yield f"homing {method.method} {method.direction} {method.edge} {switch} {reverse_at} {flags}"
    types = {"UNSIGNED8": 4, "UNSIGNED16": 5, "UNSIGNED32": 6, "INTEGER8": 8}
    for number, parameter in enumerate(device.ramp):
        held_by = device.object(parameter.object)
        assert held_by
        yield f"ramp {number} {held_by.index} {types[held_by.entries[0].type]}"
    for obj in device.objects:
        if any(entry.effect and device.effects[entry.effect].to_driver for entry in obj.entries):
            yield f"motor_parameter {obj.index} {obj.index} {types[obj.entries[0].type]}"


def test_what_refuses_is_guarded() -> None:
    """A rule is only asked for more than its intervals if its effect is among those of ods_effect.c that refuse."""
    text = (RUNTIME / "src" / "ods_effect.c").read_text(encoding="utf-8")
    asked = re.findall(r"case ODS_EFFECT_(\w+):", text[: text.index("void ods_effect_apply(")])
    assert {name.lower() for name in asked} == REFUSING
