"""The line protocol itself: what testees refuse, how they tell time, what is left when power goes."""

from __future__ import annotations

import sys
from collections.abc import Callable

import pytest
from tests.cross.driver import Testee, TesteeError
from tests.cross.expected import code, places

from odsmith.model import Device
from odsmith.vocabulary import Vocabulary
from odsmith_runtime.device.simulation import INPUTS

pytestmark = pytest.mark.slow

Start = Callable[..., Testee]

WRAPS = 0xFFFFFF00
"""A clock that wraps 256 us after the start."""


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


MALFORMED = [
    "",
    " ",
    "RX",
    "RX ",
    "RX 0000",
    "RX 601  40",
    "RX 601 4",
    "RX 601 G0",
    "RX 601 0x",
    "RX 601 00 00 00 00 00 00 00 00 00",
    "RX 601 R 10",
    "RX 601 R 1 1",
    "rx 601",
    "T",
    "T -1",
    "T +1",
    "T 1.0",
    "T 12345678901",
    "T 1 ",
    "IN address",
    "IN Address 1",
    "IN address 1 2",
    "IN address --1",
    "IN address +1",
    "IN address -",
    "IN axis0.shaft -12345678901",
    "IN axis0.Left 1",
    "FAULT axis0 stall",
    "FAULT 0 stall on",
    "FAULT axis stall on",
    "FAULT axis0 stall ON",
    "CAN",
    "CAN OK",
    "CAN ok ok",
    "NVM on",
    "NVM ok 0",
    "NVM fail 00000",
    "NVM fail 0 0",
    "NVM set",
    "NVM set 0",
    "NVM set 00000 00",
    "NVM set 0 0",
    "NVM set 0" + 33 * " 00",
    "OS",
    "OS none 1",
    "OS 1 00 00 00 00 00 00 00 00",
    "TELL",
    "TELL driver",
    "TELL driver ON",
    "TELL driver on off",
    "TELL motor on",
    "POWER",
    "POWER off",
    "POWER cut 1 1",
    "POWER cut -1",
    "DUMP",
    "DUMP 1000",
    "DUMP 1000-1",
    "DUMP 1000 1001",
    "DUMP 1000-10000",
    "NEXT",
    "T 0" + 300 * "0",
    "NVM" + 100 * " 00",
    "T \N{SUPERSCRIPT TWO}",
]

OUT_OF_RANGE = [
    "RX 800",
    "RX FFF 00",
    "RX 701 R 9",
    "T 1073741825",
    "T 9999999999",
    "IN address 256",
    "IN address -1",
    "IN enable 2",
    "IN enable -1",
    "IN digital -1",
    "IN digital 4294967296",
    "IN analog8 0",
    "IN button 1",
    "IN axis6.left 1",
    "IN axis4294967296.left 1",
    "IN axis.left 1",
    "IN axis0 1",
    "IN axis0.button 1",
    "IN axis0.left.left 1",
    "IN axis0.supply 1",
    "IN left 1",
    *(
        f"IN {'' if name == 'supply' else 'axis0.'}{name} {value}"
        for name, limits in INPUTS.items()
        for value in (limits.low - 1, limits.high + 1)
    ),
    "FAULT axis6 stall on",
    "FAULT axis4294967296 stall on",
    "FAULT axis0 bus_off on",
    "FAULT axis0 hiccup on",
    "NVM fail FFFF",
    "NVM set FFFF 00",
    "OS 4",
    "POWER cut 0",
    "POWER cut 4294967296",
    "DUMP 1001-1000",
]

NEED_POWER = [
    "RX 000 81 00",
    "RX 701 R",
    "IN enable 0",
    "IN digital 1",
    "FAULT axis0 stall on",
    "CAN busoff",
    "DUMP 1000-1000",
    "POWER cut",
    "POWER cut 1",
]


@pytest.mark.parametrize("powered", [False, True])
def test_refusals_have_no_effect(start: Start, device: Device, powered: bool) -> None:
    node = start(device)
    if powered:
        node.power()
        before = node.dump(), node.image(), node.last.next
    for line in MALFORMED:
        assert node.line(line).lines == ("NACK malformed",), line
    for line in OUT_OF_RANGE:
        assert node.line(line).lines == ("NACK range",), line
    if powered:
        assert node.line("POWER on").lines == ("NACK on",)
        assert (node.dump(), node.image(), node.last.next) == before


def test_before_power(start: Start, device: Device) -> None:
    node = start(device)
    for line in NEED_POWER:
        assert node.line(line).lines == ("NACK off",), line
    for line in (
        "IN address 7",
        "IN axis0.shaft -7",
        "T 12345",
        "NVM ok",
        "NVM set 0 00",
        "OS none",
        "TELL driver off",
    ):
        assert node.line(line).lines == ("NEXT -",), line
    assert node.line("NVM").lines[0] == "NVM 0000 00" + 31 * " FF"
    assert node.power().lines[0] == "BUS 1000 7"


def test_after_power(start: Start, device: Device) -> None:
    """A dead device takes everything and does nothing, until it begins anew with what the bench kept."""
    node = start(device)
    first = node.power().lines
    node.do("FAULT axis0 overtemperature on")
    node.do("IN address 9")
    assert node.cut().lines == ("NEXT -",)
    for line in (*NEED_POWER, "T 5000000"):
        assert node.line(line).lines == ("NEXT -",), line
    again = node.power().lines
    assert again[0] == "BUS 1000 9"
    assert [line for line in again if line.startswith("OUT ")] == [line for line in first if line.startswith("OUT ")]
    assert not node.advance(2000).sent(0x80 + 9)


def test_names_of_conditions(start: Start, device: Device, vocabulary: Vocabulary) -> None:
    """All conditions of an axis are there under their names, and stand for what the model says of them."""
    node = start(device)
    node.power()
    node.nmt(0x80)
    for axis, row in ((axis, row) for axis in range(device.axes) for row in device.emergencies if row.per_axis):
        if row.condition == "fault_reset":
            continue
        node.fault(axis, row.condition)
        expected = row.code.to_bytes(2, "little")
        found = [data for data in node.advance(1000).sent(0x81) if data[:2] == expected]
        assert [list(data[3:]) for data in found] == [[axis if byte == "axis" else byte for byte in row.bytes]]
        node.fault(axis, row.condition, False)
        node.advance(1000)
    for condition in vocabulary.conditions.values():
        refused = node.line(f"FAULT axis0 {condition.name} off").nack
        assert refused == ("" if condition.scope == "axis" else "range")


def test_remote_frames_and_their_length(start: Start, device: Device) -> None:
    node = start(device)
    node.power()
    for line in ("RX 701 R", "RX 701 R 1", "rx 701 r".upper(), "RX 701 R 8"):
        assert node.line(line).sent(0x701)


def busy(node: Testee, device: Device) -> None:
    """A device with much to do: heartbeat, blinking LEDs, an event timer, a watched node that is silent."""
    node.power()
    for index, sub, value in (
        (0x1017, 0, (7).to_bytes(2, "little")),
        (0x1016, 1, (0x42_0010).to_bytes(4, "little")),
        (0x1015, 0, (13).to_bytes(2, "little")),
        (0x1800, 5, (3).to_bytes(2, "little")),
    ):
        assert node.sdo_write(index, sub, value) == 0
    node.nmt(1)
    node.rx(0x742, b"\x05")
    node.can("warning")
    node.can("error")
    node.can("error")
    node.fault(device.axes - 1, "overtemperature")
    node.input("digital", 3)


def test_time_passes_as_it_likes(start: Start, device: Device) -> None:
    """One long step, many short ones, and steps from one deadline to the next give the same events."""
    span = 700_000
    whole, pieces, hops, wrapping = (start(device, time=time) for time in (0, 0, 0, WRAPS))
    for node in (whole, pieces, hops, wrapping):
        busy(node, device)
    expected = whole.advance(span)
    assert len(expected.frames) > 50
    assert len({at for at, _ in expected.events}) > 50
    assert wrapping.advance(span).lines == expected.lines
    events = []
    while pieces.now < span:
        events += pieces.advance(min(777, span - pieces.now)).events
    assert events == expected.events
    assert pieces.last.next == expected.next
    events = []
    while hops.now < span:
        step = hops.last.next
        assert step
        answer = hops.advance(min(step, span - hops.now))
        assert {at for at, _ in answer.events} <= {hops.now}, "nothing happens between two deadlines"
        events += answer.events
    assert events == expected.events
    assert whole.dump() == pieces.dump() == hops.dump() == wrapping.dump()


def test_three_times_a_tick(start: Start, device: Device) -> None:
    one, three = start(device), start(device)
    busy(one, device)
    busy(three, device)
    events = [event for _ in range(3) for event in three.advance(1000).events]
    assert one.advance(3000).events == events


KEPT = ((0x1017, 0, 2), (0x6083, 0, 4))
"""Stored entries of the device and of the first axis, with their sizes."""


def keep(node: Testee, number: int) -> None:
    for index, sub, size in KEPT:
        assert node.sdo_write(index, sub, number.to_bytes(size, "little")) == 0


def kept(node: Testee) -> set[int]:
    values = [node.sdo_read(index, sub) for index, sub, _ in KEPT]
    return {int.from_bytes(value, "little") for value in values if isinstance(value, bytes)}


@pytest.mark.parametrize("time", [0, WRAPS])
def test_power_lost_at_every_write(start: Start, device: Device, time: int) -> None:
    """After a cut at any write the device comes back with the old values or the new ones, never a mix.

    The values are stored, then replaced in turn by other ones and by the defaults. A write that fails before does not
    make the next one go to the place of the record in force.
    """
    store, restore = places(device, "store")[0], places(device, "restore")[0]
    node = start(device, time=time)
    node.power()
    keep(node, 1000)
    assert node.sdo_write(*store, b"save") == 0
    for (index, sub), signature, new in ((store, b"save", 2000), (restore, b"load", 0)):
        (old,) = kept(node)
        cuts = 0
        done = False
        while not done:
            cuts += 1
            keep(node, new)
            node.do("NVM fail")
            assert node.sdo_write(index, sub, signature) == code(device, "hardware")
            node.do("NVM ok")
            node.cut(cuts)
            done = node.request([0x23, index & 0xFF, index >> 8, sub, *signature]) is not None
            if not done:
                assert node.last.lines == ("NEXT -",), "a dead device says nothing"
            node.line("POWER cut")
            node.power()
            assert kept(node) in (({new},) if done else ({old}, {new})), cuts
            if not done and kept(node) == {new}:
                keep(node, old)
                assert node.sdo_write(*store, b"save") == 0
        assert cuts > 100
        assert kept(node) == {new}


def test_a_testee_that_dies_is_told() -> None:
    script = "import sys; sys.stderr.write('runtime error: of a sanitizer'); sys.exit(3)"
    for end in (Testee.power, Testee.close):
        testee = Testee([sys.executable, "-c", script])
        with pytest.raises(TesteeError, match=r"status 3\nruntime error: of a sanitizer"):
            end(testee)
