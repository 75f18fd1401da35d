"""Random mappings of every device: an RPDO writes what SDO then reads, a TPDO carries what SDO reads.

Entries are packed without gaps from bit 0 on, little-endian; a BOOLEAN takes one bit (CiA 301, 7.2.2, 7.4.4).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.cross.driver import Testee
from tests.cross.expected import encode, entries, size

from odsmith.compile import compile_file
from odsmith.model import Device, ExpandedEntry

pytestmark = pytest.mark.slow

Start = Callable[..., Testee]

START = 1
MS = 1000
SYNC = 0x80
CAN_ID = 0x6A0
"""Of the PDO under test; no other one has it."""

EMCY = 0x85
OFF, NO_RTR = 1 << 31, 1 << 30
SYNCHRONOUS_LAST = 240

DEVICES = ("tmcm3230", "tmcm6212", "io_module", "packing")

examples = settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])


@pytest.fixture(scope="session")
def packing() -> Device:
    """A device with mappable values of every length."""
    model = compile_file(Path(__file__).parent / "packing.yaml")
    assert isinstance(model, Device)
    return model


@pytest.fixture(params=DEVICES)
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture
def node(device: Device, start: Start) -> Testee:
    """One for all examples of a test: each begins with `power_anew`."""
    return start(device, node_id=5)


@pytest.fixture
def packed(packing: Device, start: Start) -> Testee:
    node = start(packing, node_id=5)
    node.power()
    return node


def power_anew(node: Testee) -> None:
    node.line("POWER cut")  # refused before the first time
    node.power()


def u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


# ---- mappings and frames by the model --------------------------------------------------------------------------------


def communication_records(device: Device, kind: str) -> list[int]:
    """The indices of the communication parameters of all PDOs of a kind, `rpdo` or `tpdo`."""
    return [obj.index for obj in device.expanded if obj.object.pdo == f"{kind}_communication"]


def mappable(device: Device, kind: str) -> list[ExpandedEntry]:
    """What a PDO of this kind may carry."""
    if kind == "rpdo":
        return [item for item in entries(device) if item.entry.mapping.receivable]
    return [item for item in entries(device) if item.entry.mapping.transmittable]


def mappings(device: Device, kind: str) -> st.SearchStrategy[list[ExpandedEntry]]:
    """Legal ones, of one entry at least; an entry may be there twice."""
    return st.lists(st.sampled_from(mappable(device, kind)), min_size=1, max_size=device.max_pdo_entries).filter(
        lambda mapping: sum(item.entry.bit_length for item in mapping) <= 64
    )


def values(item: ExpandedEntry) -> st.SearchStrategy[bytes]:
    """Octets that may be written."""
    entry = item.entry
    if entry.allowed is not None:
        ranges = [st.integers(low, high) for low, high in entry.allowed.intervals]
        return st.one_of(ranges).map(lambda value: encode(entry, value))
    if entry.bit_length == 1:
        return st.sampled_from([b"\0", b"\1"])
    return st.binary(min_size=size(entry), max_size=size(entry))


def pack(mapping: Sequence[ExpandedEntry], contents: Sequence[bytes]) -> bytes:
    number = at = 0
    for item, octets in zip(mapping, contents, strict=True):
        number |= int.from_bytes(octets, "little") << at
        at += item.entry.bit_length
    return number.to_bytes((at + 7) // 8, "little")


def map_pdo(node: Testee, communication: int, mapping: Sequence[ExpandedEntry], transmission_type: int = 0xFF) -> None:
    record = communication + 0x200
    assert node.sdo_write(communication, 1, u32(OFF | NO_RTR | CAN_ID)) == 0
    assert node.sdo_write(communication, 2, bytes([transmission_type])) == 0
    assert node.sdo_write(record, 0, b"\0") == 0
    for sub, item in enumerate(mapping, start=1):
        value = item.index << 16 | item.entry.sub << 8 | item.entry.bit_length
        assert node.sdo_write(record, sub, u32(value)) == 0
    assert node.sdo_write(record, 0, bytes([len(mapping)])) == 0
    assert node.sdo_write(communication, 1, u32(NO_RTR | CAN_ID)) == 0


def read(node: Testee, mapping: Sequence[ExpandedEntry]) -> list[bytes]:
    contents = []
    for item in mapping:
        octets = node.sdo_read(item.index, item.entry.sub)
        assert isinstance(octets, bytes)
        contents.append(octets)
    return contents


def named(device: Device, *places: tuple[int, int]) -> list[ExpandedEntry]:
    by_place = {(item.index, item.entry.sub): item for item in entries(device)}
    return [by_place[place] for place in places]


def stir(data: st.DataObject, node: Testee, device: Device, mapping: Sequence[ExpandedEntry]) -> list[bytes]:
    """Give an input, an axis or a mapped entry something new. Returns the frames in which the PDO tells of it."""
    node.input("digital", data.draw(st.integers(0, 0xFFFF), "digital inputs"))
    for channel in range(device.identity.analog_inputs):
        node.input(f"analog{channel}", data.draw(st.integers(0, 0x7FFF), "analog input"))
    for axis in range(device.axes):
        node.fault(axis, "temperature_warning", data.draw(st.booleans(), "warning"))
    frames = node.advance(MS).sent(CAN_ID)
    for item in mapping:
        if item.entry.access.writable:
            assert node.sdo_write(item.index, item.entry.sub, data.draw(values(item))) == 0
            frames += node.last.sent(CAN_ID)
    return frames


# ---- properties ------------------------------------------------------------------------------------------------------


@examples
@given(data=st.data())
def test_an_rpdo_writes_what_sdo_reads(data: st.DataObject, device: Device, node: Testee) -> None:
    communication = data.draw(st.sampled_from(communication_records(device, "rpdo")), "RPDO")
    mapping = data.draw(mappings(device, "rpdo"), "mapping")
    contents = [data.draw(values(item)) for item in mapping]
    transmission_type = data.draw(st.sampled_from([1, 2, 3, 0xFE, 0xFF]), "transmission type")
    power_anew(node)
    map_pdo(node, communication, mapping, transmission_type)
    node.nmt(START)
    before = read(node, mapping)
    assert not node.rx(CAN_ID, pack(mapping, contents)).sent(EMCY)  # other PDOs may tell what becomes of an axis
    if transmission_type <= SYNCHRONOUS_LAST:
        for _ in range(transmission_type):
            assert read(node, mapping) == before
            node.rx(SYNC)
    # of an entry that is there twice the last value stays
    last = {(item.index, item.entry.sub): octets for item, octets in zip(mapping, contents, strict=True)}
    assert read(node, mapping) == [last[item.index, item.entry.sub] for item in mapping]


@examples
@given(data=st.data())
def test_a_tpdo_carries_what_sdo_reads(data: st.DataObject, device: Device, node: Testee) -> None:
    """When OPERATIONAL begins, and then after each change, but only then."""
    communication = data.draw(st.sampled_from(communication_records(device, "tpdo")), "TPDO")
    mapping = data.draw(mappings(device, "tpdo"), "mapping")
    power_anew(node)
    map_pdo(node, communication, mapping)
    assert node.sdo_write(communication, 3, b"\0\0") == 0  # nothing is held back
    assert not stir(data, node, device, mapping)
    frames = node.nmt(START).sent(CAN_ID)
    assert frames == [pack(mapping, read(node, mapping))]
    for _ in range(3):
        frames = [frames[-1], *stir(data, node, device, mapping)]
        assert frames[-1] == pack(mapping, read(node, mapping))
        assert all(one != next_one for one, next_one in pairwise(frames))


@examples
@given(data=st.data())
def test_a_wrong_length_writes_nothing(data: st.DataObject, device: Device, node: Testee) -> None:
    communication = data.draw(st.sampled_from(communication_records(device, "rpdo")), "RPDO")
    mapping = data.draw(mappings(device, "rpdo"), "mapping")
    right = pack(mapping, [data.draw(values(item)) for item in mapping])
    length = data.draw(st.integers(0, 8).filter(lambda length: length != len(right)), "length")
    codes = [
        row.code
        for row in device.emergencies
        if row.condition == f"pdo_too_{'short' if length < len(right) else 'long'}"
    ]
    power_anew(node)
    map_pdo(node, communication, mapping)
    node.nmt(START)
    before = read(node, mapping)
    told = node.rx(CAN_ID, right.ljust(8, b"\xff")[:length]).sent(0x85)
    assert [int.from_bytes(frame[:2], "little") for frame in told] == codes
    assert read(node, mapping) == before


# ---- examples --------------------------------------------------------------------------------------------------------

RPDO, TPDO = 0x1400, 0x1800
FLAGS = ((0x2000, 1), (0x2000, 2), (0x2000, 3))
INTEGER8, UNSIGNED16, INTEGER32, UNSIGNED64 = ((0x2001, sub) for sub in (1, 2, 3, 4))


def test_packing(packed: Testee, packing: Device) -> None:
    """Worked out by hand: 1 + 16 + 1 + 8 + 32 + 1 = 59 bits."""
    mapping = named(packing, FLAGS[0], UNSIGNED16, FLAGS[1], INTEGER8, INTEGER32, FLAGS[2])
    map_pdo(packed, RPDO, mapping)
    packed.nmt(START)
    # 1, 1234h << 1, 0, FEh << 18, 89ABCDEFh << 26, 1 << 58
    packed.rx(CAN_ID, bytes.fromhex("69 24 F8 BF 37 AF 26 06"))
    expected = [b"\1", b"\x34\x12", b"\0", b"\xfe", bytes.fromhex("EF CD AB 89"), b"\1"]
    assert read(packed, mapping) == expected
    # the five bits at the end are nobody's
    packed.rx(CAN_ID, bytes.fromhex("69 24 F8 BF 37 AF 26 FE"))
    assert read(packed, mapping) == expected
    map_pdo(packed, RPDO, named(packing, UNSIGNED64))
    packed.rx(CAN_ID, bytes(range(1, 9)))
    assert packed.sdo_read(*UNSIGNED64) == bytes(range(1, 9))


def test_sync_samples_before_it_applies(packed: Testee, packing: Device) -> None:
    """A synchronous TPDO carries what was there before the RPDOs of the same SYNC; an event-driven one follows them."""
    held = named(packing, UNSIGNED16)
    map_pdo(packed, RPDO, held, 1)
    assert packed.sdo_write(RPDO, 1, u32(OFF | NO_RTR)) == 0
    assert packed.sdo_write(RPDO, 1, u32(NO_RTR | 0x200)) == 0
    map_pdo(packed, TPDO, held, 1)
    map_pdo(packed, TPDO + 1, held)
    assert packed.sdo_write(TPDO + 1, 3, b"\0\0") == 0
    assert packed.sdo_write(TPDO, 1, u32(OFF | NO_RTR)) == 0
    assert packed.sdo_write(TPDO, 1, u32(NO_RTR | 0x380)) == 0
    packed.nmt(START)
    assert not packed.rx(0x200, b"\x34\x12").frames
    assert [str(frame) for frame in packed.rx(SYNC).frames] == ["380 00 00", "6A0 34 12"]
    assert [str(frame) for frame in packed.rx(SYNC).frames] == ["380 34 12"]


def test_an_rpdo_that_sends_a_tpdo(packed: Testee, packing: Device) -> None:
    """What a received frame changes leaves in the same turn."""
    map_pdo(packed, TPDO, named(packing, *FLAGS))
    packed.nmt(START)
    map_pdo(packed, RPDO, named(packing, FLAGS[1]))
    assert packed.rx(CAN_ID, b"\1").sent(CAN_ID) == [b"\2"]
    assert packed.rx(CAN_ID, b"\1").sent(CAN_ID) == []
    assert packed.rx(CAN_ID, b"\0").sent(CAN_ID) == [b"\0"]


@pytest.mark.parametrize("transmission_type", [1, 2, 239, SYNCHRONOUS_LAST])
def test_every_nth_sync(transmission_type: int, packed: Testee, packing: Device) -> None:
    """Over three rounds; RPDO and TPDO count alike."""
    flag = named(packing, FLAGS[0])
    map_pdo(packed, RPDO, flag, transmission_type)
    map_pdo(packed, TPDO, flag, transmission_type)
    packed.nmt(START)
    for number in range(1, 3 * transmission_type + 1):
        round_is_over = number % transmission_type == 0
        value = bytes([number // transmission_type % 2])
        packed.rx(CAN_ID, value)
        assert len(packed.rx(SYNC).sent(CAN_ID)) == round_is_over
        if round_is_over:
            assert packed.sdo_read(*FLAGS[0]) == value
