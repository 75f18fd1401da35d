"""Resets, whatever came before: reset node is a power-on, reset communication spares the application.

What is left of the past is the bench: inputs, the faults of the hardware and the state of the CAN controller. So a
device that was reset is compared with one that was just powered on the same bench.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cross.driver import Answer, Testee
from tests.cross.expected import encode, places, role, size, writable

from odsmith.model import Device, Entry

pytestmark = pytest.mark.slow

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 0x80, 0x81, 0x82

TICK = 1000

CONTROLLER = ("ok", "warning", "passive", "busoff")

Event = tuple[int, str]
"""A line for the testee. It begins with a CAN-ID to which the node-ID in force is added, where that is not 0."""


@pytest.fixture(scope="module", params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(scope="module")
def program(device: Device, c_testee: Callable[[Device], Path]) -> str:
    return str(c_testee(device))


# ---- events ----------------------------------------------------------------------------------------------------------


def octets(data: bytes) -> str:
    return data.hex(" ").upper()


def values(entry: Entry) -> st.SearchStrategy[int]:
    """All that an entry takes, and some of what it refuses."""
    if entry.signatures:
        return st.sampled_from([signature.value for signature in entry.signatures])
    low, high = (entry.allowed.low, entry.allowed.high) if entry.allowed else (entry.type.low, entry.type.high)
    near = st.integers(max(low, -10), min(high, 10)) if low <= 10 <= high else st.just(low)
    return st.one_of(near, st.integers(low, high), st.sampled_from([low, high]))


def write(index: int, sub: int, data: bytes) -> Event:
    """An expedited download that leaves the size to the type."""
    return 0x600, octets(bytes([0x22, index & 0xFF, index >> 8, sub]) + data.ljust(4, b"\0"))


def writes(device: Device) -> st.SearchStrategy[Event]:
    """Anything but `save`: the memory stays erased."""
    items = [
        item
        for item in writable(device)
        if item.entry.type.integer and size(item.entry) <= 4 and item.entry.effect != "store"
    ]
    # as many of the module as of its axes, which are many
    common = [item for item in items if item.entry.effect not in ("driver_parameter", "ramp_parameter", "pdo_mapping")]
    return (
        st.one_of(st.sampled_from(common), st.sampled_from(items))
        .flatmap(lambda item: st.tuples(st.just(item), values(item.entry)))
        .map(lambda pair: write(pair[0].index, pair[0].entry.sub, encode(pair[0].entry, pair[1])))
    )


def beginnings(device: Device) -> st.SearchStrategy[list[Event]]:
    """What goes on after its last line: a transfer, heartbeats, watching, guarding, errors, outputs, TMCL mode."""
    (consumer,) = places(device, "consumer_heartbeat")
    (producer,) = places(device, "producer_heartbeat")
    (tmcl_mode,) = places(device, "tmcl_mode")
    guard_time, life_time_factor = places(device, "guard_time")
    mask, outputs = role(device, "output_mask"), role(device, "digital_outputs")
    inhibit_time = role(device, "inhibit_time_emcy")
    return st.sampled_from(
        [
            [(0x600, octets(bytes([0x40, 8, 0x10, 0, 0, 0, 0, 0])))],
            [write(*producer, b"\x64")],
            [write(*consumer, bytes.fromhex("64000A00")), (0, "RX 70A 05")],
            [write(*guard_time, b"\x64"), write(*life_time_factor, b"\x01"), (0x700, "R")],
            [write(*inhibit_time, bytes.fromhex("E803")), (0, "CAN error"), (0, "CAN overrun")],
            [(0, "FAULT axis0 open_load_a on"), (0, "IN enable 0"), (0, f"T {TICK}")],
            [write(*mask, bytes.fromhex("00000500")), write(*outputs, bytes.fromhex("00000400"))],
            [write(*tmcl_mode, b"make")],
        ]
    )


def events(device: Device) -> st.SearchStrategy[list[Event]]:
    conditions = sorted({row.condition for row in device.emergencies if row.per_axis} - {"fault_reset"})
    axis = st.integers(0, device.axes - 1)
    fault = st.tuples(axis, st.sampled_from(conditions), st.sampled_from(["on", "off"]))
    wire = st.one_of(
        writes(device), st.tuples(st.sampled_from([0x200, 0x300, 0x400, 0x500]), st.binary(max_size=8).map(octets))
    )
    commands = st.sampled_from([START, START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION])
    bench = st.one_of(
        commands.map(lambda command: f"RX 000 {command:02X} 00"),
        st.sampled_from(["RX 080", "RX 70A 05", "IN enable 0", "IN enable 1"]),
        st.integers(0, 300 * TICK).map(lambda us: f"T {us}"),
        st.integers(0, 255).map(lambda value: f"IN address {value}"),
        st.integers(0, 255).map(lambda value: f"IN digital {value}"),
        st.integers(0, 65535).map(lambda value: f"IN analog0 {value}"),
        st.sampled_from([*CONTROLLER, "error", "overrun"]).map(lambda event: f"CAN {event}"),
        fault.map(lambda words: f"FAULT axis{words[0]} {words[1]} {words[2]}"),
    )
    one = st.one_of(wire, bench.map(lambda line: (0, line))).map(lambda event: [event])
    parts = st.lists(st.one_of(one, beginnings(device)), max_size=10)
    return st.tuples(parts, beginnings(device)).map(lambda pair: list(chain(*pair[0], pair[1])))


def play(testee: Testee, dialogue: list[Event]) -> list[str]:
    """Send all of it; the lines that set the bench up, of each the last one."""
    bench = {}
    for can_id, line in dialogue:
        testee.do(f"RX {can_id + testee.node_id:X} {line}".rstrip() if can_id else line)
        words = line.split(" ")
        if words[0] == "CAN" and words[1] in CONTROLLER:
            bench["CAN"] = line
        elif words[0] in ("IN", "FAULT"):
            bench[" ".join(words[:-1])] = line
    if bench.get("CAN") == "CAN busoff":
        bench["CAN"] = "CAN passive"  # a command has to come through
        testee.do(bench["CAN"])
    return list(bench.values())


def power(testee: Testee, bench: list[str]) -> list[str]:
    """Power-on. The address switches are looked at there; everything else can only be told afterwards.

    Returns the frames that all of it brings about.
    """
    address = [line for line in bench if line.startswith("IN address")]
    sent: list[str] = []
    for line in [*address, "POWER on", *(line for line in bench if line not in address)]:
        sent += frames(testee.do(line))
    return sent


def frames(answer: Answer) -> list[str]:
    return [str(frame) for frame in answer.frames]


# ---- properties ------------------------------------------------------------------------------------------------------


AFTERWARDS: tuple[Callable[[Testee], Answer], ...] = (
    lambda testee: testee.can("error"),  # whose emergency waits for nothing
    lambda testee: testee.advance(TICK),  # at which inputs and faults are found
    lambda testee: testee.nmt(START),
    lambda testee: testee.rx(0x080),
    lambda testee: testee.advance(2000 * TICK),  # in which timers would run out that have survived
)


def test_reset_node_is_a_power_on(device: Device, program: str) -> None:
    @settings(max_examples=20, deadline=None)
    @given(events(device))
    def holds(dialogue: list[Event]) -> None:
        with Testee([program], node_id=5) as old, Testee([program], node_id=5) as new:
            old.power()
            begun = power(new, play(old, dialogue))
            assert frames(old.nmt(RESET_NODE)) == begun
            assert old.node_id == new.node_id
            assert old.dump() == new.dump()
            for event in AFTERWARDS:
                assert frames(event(old)) == frames(event(new))
                assert old.dump() == new.dump()

    holds()


def test_reset_communication_spares_the_application(device: Device, program: str) -> None:
    error_register = role(device, "error_register")

    @settings(max_examples=20, deadline=None)
    @given(events(device))
    def holds(dialogue: list[Event]) -> None:
        with Testee([program], node_id=5) as old, Testee([program], node_id=5) as new:
            old.power()
            play(old, dialogue)
            before = {place: value for place, value in old.dump().items() if not 0x1000 <= place[0] <= 0x1FFF}
            answer = old.nmt(RESET_COMMUNICATION)
            assert not [line for line in answer.lines if line.startswith(("BUS", "OUT digital"))]
            after = old.dump()
            assert {place: after[place] for place in before} == before

            # communication as after power-on under the node-ID in force; conditions go on, and with them 1001h
            new.do(f"IN address {old.node_id}")
            new.power()
            fresh = new.dump(0x1000, 0x1FFF)
            del fresh[error_register]
            assert {place: after[place] for place in fresh} == fresh
            assert after.keys() == before.keys() | fresh.keys() | {error_register}

    holds()
