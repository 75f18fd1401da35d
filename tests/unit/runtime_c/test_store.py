"""The record of stored values: whole at every loss of power, and read only if it is what this firmware wrote.

A save or restore writes its record octet by octet. Power is cut at each of them in turn: the next power-on finds the
old set or the new one, never a mix, and the next save works.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import pytest
from tests.cross.build import Build
from tests.cross.driver import Testee
from tests.cross.expected import role

from odsmith.model import Device

pytestmark = pytest.mark.slow

NODE_ID = 5

SAVE = b"save"
LOAD = b"load"
STORE, RESTORE = 0x1010, 0x1011
ALL = 1

INHIBIT_TIME = (0x1015, 0)
MAXIMUM_CURRENT = (0x2003, 0)
MICROSTEPS = (0x2000, 0)
"""Goes from 0 to 8, and is 8 by default."""

HEADER = 12
HARDWARE_ERROR = 0x06060000


@pytest.fixture(scope="session")
def c_build() -> Build:
    """One compiler is enough: what is looked at is the order of writes."""
    return Build()


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture
def node(device: Device, start: Callable[..., Testee]) -> Testee:
    """A device that has just been powered."""
    testee = start(device, node_id=NODE_ID)
    testee.power()
    return testee


# ---- sets of values --------------------------------------------------------------------------------------------------


def places(device: Device) -> list[tuple[int, int]]:
    """A value at each end of the record and one in its middle: of the device, of the last axis and of the last PDO."""
    axis = device.axes - 1
    return [INHIBIT_TIME, (0x6068 + 0x800 * axis, 0), (0x1803 + 0x40 * axis, 5)]


def put(node: Testee, device: Device, number: int) -> list[bytes]:
    """Write the same number, of 16 bits, at all places."""
    value = number.to_bytes(2, "little")
    for place in places(device):
        assert node.sdo_write(*place, value) == 0
    return [value] * len(places(device))


def get(node: Testee, device: Device) -> list[bytes | int]:
    return [node.sdo_read(*place) for place in places(device)]


def save(node: Testee, sub: int = ALL) -> int:
    return node.sdo_write(STORE, sub, SAVE)


def is_done(node: Testee, index: int, signature: bytes) -> bool:
    """Ask for a save or restore; whether an answer left before power was lost."""
    return node.request([0x23, index & 0xFF, index >> 8, ALL, *signature]) is not None


def cycle(node: Testee) -> None:
    node.cut()
    node.power()


# ---- power is lost ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("bank", [0, 1])
def test_save_is_cut_at_every_octet(device: Device, node: Testee, bank: int) -> None:
    """`bank` is the one that the first cut falls into; each save, cut or not, makes them change places."""
    for number in range(2 - bank):
        old: list[bytes] = put(node, device, number + 1)
        assert save(node) == 0
    for octet in range(1, len(node.image())):
        new = put(node, device, 2 * octet + 1)
        node.cut(octet)
        if is_done(node, STORE, SAVE):
            break
        node.power()
        assert get(node, device) in (old, new)
        old = put(node, device, 2 * octet + 2)
        assert save(node) == 0
    assert octet == len(node.image()) // 2 + 1
    cycle(node)
    assert get(node, device) == new


def test_restore_is_cut_at_every_octet(device: Device, node: Testee) -> None:
    defaults = get(node, device)
    for octet in range(1, len(node.image()) + 2):
        old = put(node, device, octet)
        assert save(node) == 0
        node.cut(octet)
        if is_done(node, RESTORE, LOAD):
            break
        node.power()
        assert get(node, device) in (old, defaults)
    assert octet == len(node.image()) // 2 + 1
    cycle(node)
    assert get(node, device) == defaults


def test_first_save_is_cut_at_every_octet(device: Device, start: Callable[..., Testee]) -> None:
    """The memory is erased: the old set are the defaults. Every seventh octet, and the header."""
    node = start(device, node_id=NODE_ID)
    node.power()
    defaults = get(node, device)
    erased = node.image()
    record = len(erased) // 2
    for octet in [*range(1, record - HEADER, 7), *range(record - HEADER, record + 1)]:
        put(node, device, octet)
        node.cut(octet)
        assert not is_done(node, STORE, SAVE)
        node.power()
        assert get(node, device) == defaults
        node.cut()
        node.set_image(0, erased)
        node.power()


def test_memory_fails_from_some_octet_on(device: Device, node: Testee) -> None:
    """The record in force is the old one until the next save that works."""
    old = put(node, device, 1)
    assert save(node) == 0
    put(node, device, 2)
    node.do("NVM fail")
    assert save(node) == HARDWARE_ERROR
    node.do("NVM ok")
    cycle(node)
    assert get(node, device) == old


# ---- what a record is ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Record:
    """As ods_store.h describes it."""

    layout: int
    sequence: int
    payload: bytes

    def __bytes__(self) -> bytes:
        head = self.layout.to_bytes(4, "little") + self.sequence.to_bytes(2, "little")
        head += len(self.payload).to_bytes(2, "little")
        return head + zlib.crc32(head + self.payload).to_bytes(4, "little") + self.payload


def record(node: Testee, bank: int) -> Record:
    """The record in a bank, which is what `Record` would write there."""
    image = node.image()
    size = len(image) // 2
    octets = image[bank * size : (bank + 1) * size]
    found = Record(int.from_bytes(octets[:4], "little"), int.from_bytes(octets[4:6], "little"), octets[HEADER:])
    assert bytes(found) == octets
    return found


def replace(node: Testee, bank: int, octets: bytes) -> None:
    """Put these octets into a bank while the device is off, and switch it on."""
    node.cut()
    node.set_image(bank * (len(node.image()) // 2), octets)
    node.power()


def test_records_take_turns(device: Device, node: Testee) -> None:
    for number in range(1, 5):
        put(node, device, number)
        assert save(node) == 0
        in_force = record(node, (number - 1) % 2)
        assert in_force.sequence == number
        assert in_force.layout == device.layout


@pytest.mark.parametrize("bank", [0, 1])
def test_sequence_wraps(device: Device, node: Testee, bank: int) -> None:
    """FFFFh is before 0, whichever bank it is in."""
    for number in range(bank + 1):
        put(node, device, number)
        assert save(node) == 0
    last = record(node, bank)
    replace(node, bank, bytes(Record(last.layout, 0xFFFF, last.payload)))
    if bank:  # the other bank's record is newer now: 1 is behind FFFFh
        node.cut()
        node.set_image(0, bytes(HEADER))
        node.power()
    for number in range(3):
        new = put(node, device, 100 + number)
        assert save(node) == 0
        cycle(node)
        assert get(node, device) == new
        assert record(node, (bank + 1 + number) % 2).sequence == number


def test_record_of_another_layout_is_not_read(device: Device, node: Testee) -> None:
    defaults = get(node, device)
    old = put(node, device, 1)
    assert save(node) == 0
    good = record(node, 0)
    replace(node, 0, bytes(Record(good.layout ^ 1, good.sequence, good.payload)))
    assert get(node, device) == defaults
    replace(node, 0, bytes(Record(good.layout, good.sequence + 1, good.payload)))
    assert get(node, device) == old


def test_record_of_another_length_is_not_read(device: Device, node: Testee) -> None:
    defaults = get(node, device)
    put(node, device, 1)
    assert save(node) == 0
    good = record(node, 0)
    replace(node, 0, bytes(Record(good.layout, good.sequence, good.payload[:-1])))
    assert get(node, device) == defaults


def test_spoilt_record_is_not_read(device: Device, node: Testee) -> None:
    """One bit of any octet of the header, or of every seventh octet of the payload: the older record is in force."""
    old = put(node, device, 1)
    assert save(node) == 0
    new = put(node, device, 2)
    assert save(node) == 0
    good = bytes(record(node, 1))
    for octet in [*range(HEADER), *range(HEADER, len(good), 7)]:
        spoilt = bytearray(good)
        spoilt[octet] ^= 1 << octet % 8
        replace(node, 1, bytes(spoilt))
        assert get(node, device) == old
    replace(node, 1, good)
    assert get(node, device) == new


def test_value_out_of_range_keeps_its_default(device: Device, node: Testee) -> None:
    """The record of a firmware with wider limits, say: everything else in it counts."""
    old = put(node, device, 1)
    for value in (1, 2):
        assert node.sdo_write(*MICROSTEPS, bytes([value])) == 0
        assert save(node) == 0
    first, second = record(node, 0), record(node, 1)
    [at] = [n for n, pair in enumerate(zip(first.payload, second.payload, strict=True)) if pair[0] != pair[1]]
    assert (first.payload[at], second.payload[at]) == (1, 2)

    for value, read in ((8, 8), (9, 8), (0xFF, 8), (0, 0)):
        payload = bytearray(second.payload)
        payload[at] = value
        replace(node, 1, bytes(Record(second.layout, second.sequence, bytes(payload))))
        assert node.sdo_read(*MICROSTEPS) == bytes([read])
        assert get(node, device) == old


def test_void_groups_are_0(device: Device, node: Testee) -> None:
    """A restore of all leaves bit rate and node-ID, which are what the record then holds."""
    put(node, device, 1)
    assert node.sdo_write(*role(device, "can_bit_rate"), (500).to_bytes(2, "little")) == 0
    assert save(node) == 0
    assert node.sdo_write(RESTORE, ALL, LOAD) == 0
    groups = 2 * (1 + device.axes)
    payload = record(node, 1).payload
    assert [octet for octet in payload[groups:] if octet] == [500 & 0xFF, 500 >> 8, NODE_ID]
    assert payload[2:groups] == bytes(groups - 2)  # none of an axis
