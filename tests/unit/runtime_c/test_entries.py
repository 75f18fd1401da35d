"""Every entry of both dictionaries over the bus: read, written inside and beside its limits and with wrong lengths.

What a write does beside keeping the value is named by its effect. Each effect has a case of its own, found by its name,
here or, if it is one of an axis, in `tests/cross/test_axis_effects.py`.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from tests.cross import test_axis_effects
from tests.cross.driver import Testee
from tests.cross.expected import code, encode, entries, places, power_on_value, role, size, writable

from odsmith.model import Device, Entry

pytestmark = pytest.mark.slow

NODE_ID = 5
SERIAL = 0x12345678

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 0x80, 0x81, 0x82

MS = 1000

KEPT = {
    "value",
    "bus_setting",
    # of an axis: they act as well
    "controlword",
    "mode",
    "target_position",
    "target_velocity",
    "set_point_offset",
    "interpolation_time",
    "option_code",
    "ramp_parameter",
    "homing_method",
    "homing_parameter",
    "position_limit",
    "following_window",
    "position_window",
    "stop_on_stall",
    "microstep_resolution",
    "current",
    "brake",
    "switch_parameters",
    "unit_selection",
    "encoder_parameter",
    "encoder_latch",
    "driver_parameter",
    "driver_current",
    "speed_threshold",
}
"""Effects whose entries keep every value that they allow."""

IDLE = {"value", "bus_setting"}
"""Effects that do nothing before the next power-on."""

JUDGED = {
    "cob_id_sync",
    "cob_id_emcy",
    "os_command",
    "pdo_cob_id",
    "pdo_mapped_count",
    "pdo_mapping",
    "store",
    "restore",
    "tmcl_mode",
    "manufacturer_mode",
}
"""Effects that refuse values by more than limits, or do not keep them: their cases say which."""


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture
def node(device: Device, start: Callable[..., Testee]) -> Testee:
    """A device that has just been powered."""
    testee = start(device, node_id=NODE_ID, serial=SERIAL)
    testee.power()
    return testee


# ---- values ----------------------------------------------------------------------------------------------------------


def u16(value: int) -> bytes:
    return value.to_bytes(2, "little")


def u32(value: int) -> bytes:
    return value.to_bytes(4, "little")


def good_values(entry: Entry) -> list[int]:
    """The ends of all intervals, or of the type, and what was there before."""
    if entry.allowed is None:
        return [entry.type.low, entry.type.high, 0x5A]
    return [value for interval in entry.allowed.intervals for value in interval]


def bad_values(device: Device, entry: Entry) -> list[tuple[int, int]]:
    """Values just beside those that are allowed, with the abort code that each one deserves."""
    if entry.allowed is None:
        return []
    allowed = entry.allowed
    values = [(low - 1, "value_too_low") for low, _ in allowed.intervals]
    values += [(high + 1, "value_too_high") for _, high in allowed.intervals]
    values += [(entry.type.low, "value_too_low"), (entry.type.high, "value_too_high")]
    return [
        (value, code(device, "invalid_value" if allowed.listed else why))
        for value, why in values
        if entry.type.low <= value <= entry.type.high and value not in allowed
    ]


def test_each_effect_has_its_case(device: Device) -> None:
    effects = {item.entry.effect for item in writable(device)}
    names = (*globals(), *vars(test_axis_effects))
    cases = {name.removeprefix("test_effect_") for name in names if name.startswith("test_effect_")}
    assert effects - IDLE <= cases
    assert not cases & IDLE
    assert cases >= JUDGED


# ---- every entry -----------------------------------------------------------------------------------------------------


def test_power_on_values(device: Device, node: Testee) -> None:
    """SDO uploads and a dump say the same, and the dictionary has the entries of the model and no other."""
    expected = {(item.index, item.entry.sub): power_on_value(item, NODE_ID, SERIAL) for item in entries(device)}
    assert node.dump() == expected
    assert {place: node.sdo_read(*place) for place in expected} == expected


def test_read_only(device: Device, node: Testee) -> None:
    """Writing is refused before anything is looked at that the write may carry."""
    before = node.dump()
    for item in entries(device):
        if not item.entry.access.writable:
            for length in {1, 4, 8, size(item.entry)}:
                assert node.sdo_write(item.index, item.entry.sub, bytes(length)) == code(device, "read_only")
    assert node.dump() == before


def test_lengths(device: Device, node: Testee) -> None:
    """One octet more or less is refused whichever way it comes, and changes nothing."""
    before = node.dump()
    long, short = code(device, "too_long"), code(device, "too_short")
    for item in writable(device):
        place, octets = (item.index, item.entry.sub), size(item.entry)
        for length in (octets - 1, octets + 1):
            expected = long if length > octets else short
            if length:
                assert node.sdo_write(*place, bytes(length)) == expected, place
            assert node.sdo_write(*place, bytes(length), segmented=True) == expected, place
            assert node.sdo_write(*place, bytes(length), segmented=True, sized=False) == expected, place
    assert node.dump() == before


def test_values(device: Device, node: Testee) -> None:
    """The ends of what is allowed are kept, what lies just beside is refused, and every value can be read back."""
    before = node.dump()
    for item in writable(device):
        entry, place = item.entry, (item.index, item.entry.sub)
        if entry.effect in JUDGED:
            continue
        for value in good_values(entry):
            octets = encode(entry, value)
            for sized, segmented in ((True, False), (False, False), (True, True), (False, True)):
                assert node.sdo_write(*place, octets, sized=sized, segmented=segmented) == 0, (place, value)
                assert node.sdo_read(*place) == octets, (place, value)
            for bad, refusal in bad_values(device, entry):
                for segmented in (False, True):
                    assert node.sdo_write(*place, encode(entry, bad), segmented=segmented) == refusal, (place, bad)
            assert node.sdo_read(*place) == octets, place
        assert node.sdo_write(*place, power_on_value(item, NODE_ID, SERIAL)) == 0, place
    assert node.dump() == before


def test_axes_do_not_share_values(device: Device, node: Testee) -> None:
    """Each entry that keeps anything gets a value of its own, and all of them are still there at the end."""
    written = {}
    for number, item in enumerate(writable(device)):
        entry = item.entry
        if entry.effect in KEPT and entry.type.integer:
            good = entry.allowed.members if entry.allowed else None
            low, high = (entry.allowed.low, entry.allowed.high) if entry.allowed else (entry.type.low, entry.type.high)
            value = good[number % len(good)] if good else low + number % (high - low + 1)
            written[item.index, entry.sub] = encode(entry, value)
            assert node.sdo_write(item.index, entry.sub, encode(entry, value)) == 0
    assert len(written) > 60 * device.axes
    dump = node.dump()
    assert {place: dump[place] for place in written} == written


# ---- the order of checks ---------------------------------------------------------------------------------------------


def test_order_of_checks(device: Device, node: Testee) -> None:
    """Index, sub-index, access, length, state, value: the first failure answers."""
    modes, mode = 0x6060, 0x7F  # no mode has this code
    no_state = code(device, "device_state")
    assert node.sdo_write(0x5FFF, 9, bytes(8)) == code(device, "no_object")
    assert node.sdo_write(0x1018, 9, bytes(8)) == code(device, "no_sub_index")
    assert node.sdo_write(0x1018, 1, bytes(8)) == code(device, "read_only")
    (tmcl,) = places(device, "tmcl_mode")
    assert node.sdo_write(*tmcl, b"make") == 0
    assert node.sdo_write(modes, 0, bytes([mode, 0])) == code(device, "too_long")
    assert node.sdo_write(modes, 0, bytes([mode])) == no_state
    assert node.sdo_write(modes, 0, bytes([mode]), segmented=True) == no_state
    node.nmt(RESET_NODE)
    assert node.sdo_write(modes, 0, bytes([mode])) == code(device, "invalid_value")


# ---- effects ---------------------------------------------------------------------------------------------------------

RESTRICTED = (0x000, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x7FF)
"""The ends of the ranges of CAN-IDs that no COB-ID may have (CiA 301, 7.3.5)."""

UNRESTRICTED = (0x080, 0x100, 0x181, 0x580, 0x600, 0x680, 0x6DF)

NOT_A_CAN_ID = (1 << 11, 1 << 28, 1 << 29)

RPDO, TPDO = 0x1400, 0x1800

OFF, NO_RTR = 1 << 31, 1 << 30


def map_pdo(node: Testee, pdo: int, *mapped: int, kind: int = 0xFF, can_id: int = 0x190) -> None:
    """Configure the PDO with the communication record `pdo`, by the procedure of CiA 301, 7.5.2.36."""
    steps = [(pdo, 1, u32(OFF | NO_RTR | can_id)), (pdo, 2, bytes([kind])), (pdo + 0x200, 0, b"\0")]
    steps += [(pdo + 0x200, sub, u32(value)) for sub, value in enumerate(mapped, 1)]
    steps += [(pdo + 0x200, 0, bytes([len(mapped)])), (pdo, 1, u32(NO_RTR | can_id))]
    for index, sub, value in steps:
        assert node.sdo_write(index, sub, value) == 0


def silence(node: Testee, device: Device) -> None:
    """Switch all PDOs off."""
    for index, sub in places(device, "pdo_cob_id"):
        assert node.sdo_write(index, sub, u32(OFF | NO_RTR)) == 0


def emergencies(node: Testee) -> list[int]:
    """The codes of the emergencies in the last answer."""
    return [int.from_bytes(data[:2], "little") for data in node.last.sent(0x80 + NODE_ID)]


def test_effect_cob_id_sync(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "cob_id_sync")
    for value in (*RESTRICTED, *NOT_A_CAN_ID, NO_RTR | 0x80):
        assert node.sdo_write(index, sub, u32(value)) == code(device, "invalid_value"), hex(value)
    for value in (*UNRESTRICTED, OFF | 0x80, 0x81):
        assert node.sdo_write(index, sub, u32(value)) == 0, hex(value)
        assert node.sdo_read(index, sub) == u32(value)
    silence(node, device)
    map_pdo(node, TPDO, 0x60410010, kind=1)
    node.nmt(START)
    assert not node.rx(0x80).frames
    assert node.rx(0x81).sent(0x190)


def test_effect_guard_time(device: Device, node: Testee) -> None:
    for (index, sub), value in zip(places(device, "guard_time"), (u16(100), b"\2"), strict=True):
        assert node.sdo_write(index, sub, value) == 0
    guard = 0x700 + NODE_ID
    assert node.remote(guard).sent(guard) == [b"\x7f"]
    node.advance(150 * MS)
    assert node.remote(guard).sent(guard) == [b"\xff"]
    node.advance(199 * MS)
    assert not emergencies(node)
    node.advance(2 * MS)
    assert emergencies(node) == [0x8130]
    index, sub = places(device, "guard_time")[0]
    assert node.sdo_write(index, sub, u16(100)) == 0
    assert emergencies(node) == [0x0000]
    node.advance(1000 * MS)
    assert not emergencies(node)


def test_effect_cob_id_emcy(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "cob_id_emcy")
    assert node.can("error").sent(0x80 + NODE_ID)
    for value in (*RESTRICTED, *NOT_A_CAN_ID, OFF | NOT_A_CAN_ID[0]):
        assert node.sdo_write(index, sub, u32(value)) == code(device, "invalid_value"), hex(value)
    for value in (*UNRESTRICTED, OFF, OFF | RESTRICTED[0], 0x123 | OFF):
        assert node.sdo_write(index, sub, u32(value)) == 0, hex(value)
        assert node.sdo_read(index, sub) == u32(value)
    assert not node.can("error").frames
    assert node.sdo_write(index, sub, u32(0x191)) == 0
    assert node.can("error").sent(0x191)


def test_effect_inhibit_time_emcy(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "inhibit_time_emcy")
    assert node.sdo_write(index, sub, u16(25)) == 0
    assert node.can("error").sent(0x80 + NODE_ID)
    assert not node.can("error").frames
    assert [frame.at - node.last.begin for frame in node.advance(10 * MS).frames] == [2500]


def test_effect_consumer_heartbeat(device: Device, node: Testee) -> None:
    other = 0x42
    place = places(device, "consumer_heartbeat")[0]
    assert node.sdo_write(*place, u32(other << 16 | 100)) == 0
    node.advance(1000 * MS)
    assert not emergencies(node)
    node.rx(0x700 + other, b"\x05")
    assert [frame.at - node.last.begin for frame in node.advance(1000 * MS).frames] == [100 * MS]
    assert emergencies(node) == [0x8130]
    assert node.sdo_write(*place, u32(other << 16 | 200)) == 0
    assert emergencies(node) == [0x0000]


def test_effect_producer_heartbeat(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "producer_heartbeat")
    node.advance(300)
    assert node.sdo_write(index, sub, u16(20)) == 0
    beats = node.advance(50 * MS).frames
    assert [(beat.at - node.last.begin, beat.id, beat.data) for beat in beats] == [
        (at, 0x700 + NODE_ID, b"\x7f") for at in (20 * MS, 40 * MS)
    ]
    assert not node.remote(0x700 + NODE_ID).frames
    assert node.sdo_write(index, sub, u16(0)) == 0
    assert not node.advance(100 * MS).frames
    assert node.remote(0x700 + NODE_ID).frames


def test_effect_error_behaviour(device: Device, node: Testee) -> None:
    """The first entry says what a communication error does; the second one is of faults of an axis."""
    choice, _ = places(device, "error_behaviour")
    for value, stops in ((0, True), (1, False), (2, True)):
        node.nmt(RESET_NODE)
        silence(node, device)
        assert node.sdo_write(*choice, bytes([value])) == 0
        node.nmt(START)
        node.can("busoff")
        node.can("ok")
        silent = node.request([0x40, 0x00, 0x10, 0, 0, 0, 0, 0]) is None
        assert silent == stops, value
        node.nmt(RESET_NODE)


def test_effect_store(device: Device, node: Testee) -> None:
    index, sub = places(device, "store")[0]
    kept = role(device, "producer_heartbeat_time")
    for item in writable(device):
        if item.entry.effect == "store":
            for word in (b"load", b"evas", bytes(4)):
                assert node.sdo_write(item.index, item.entry.sub, word) == code(device, "not_stored")
            node.do("NVM fail")
            assert node.sdo_write(item.index, item.entry.sub, b"save") == code(device, "hardware")
            node.do("NVM ok")
            assert node.sdo_write(item.index, item.entry.sub, b"save") == 0
            assert node.sdo_read(item.index, item.entry.sub) == power_on_value(item, NODE_ID, SERIAL)
    assert node.sdo_write(*kept, u16(1234)) == 0
    assert node.sdo_write(index, sub, b"save") == 0
    assert node.sdo_write(*kept, u16(4321)) == 0
    node.cut()
    node.power()
    assert node.sdo_read(*kept) == u16(1234)


def test_effect_restore(device: Device, node: Testee) -> None:
    index, sub = places(device, "restore")[0]
    store, kept = places(device, "store")[0], role(device, "producer_heartbeat_time")
    for item in writable(device):
        if item.entry.effect == "restore":
            for word in (b"save", b"daol", bytes(4)):
                assert node.sdo_write(item.index, item.entry.sub, word) == code(device, "not_stored")
            assert node.sdo_write(item.index, item.entry.sub, b"load") == 0
            assert node.sdo_read(item.index, item.entry.sub) == power_on_value(item, NODE_ID, SERIAL)
    assert node.sdo_write(*kept, u16(1234)) == 0
    assert node.sdo_write(*store, b"save") == 0
    node.do("NVM fail")
    assert node.sdo_write(index, sub, b"load") == code(device, "hardware")
    node.do("NVM ok")
    assert node.sdo_write(index, sub, b"load") == 0
    assert node.sdo_read(*kept) == u16(1234)
    node.nmt(RESET_NODE)
    assert node.sdo_read(*kept) == u16(0)


def test_effect_os_command(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "os_command")
    (tmcl,) = places(device, "tmcl_mode")
    status, reply = role(device, "os_status"), role(device, "os_reply")
    assert node.sdo_write(index, sub, b"command") == code(device, "device_state")
    assert node.sdo_write(*tmcl, b"make") == 0
    assert node.sdo_write(index, sub, b"command") == 0
    assert node.sdo_read(index, sub) == b"command"
    assert node.sdo_read(*status) == b"\2"
    assert node.sdo_read(*reply) == bytes(7)
    for word, octets in (("1 01 02 03 04 05 06 07", bytes(range(1, 8))), ("0", bytes(7)), ("3 FF", b"\xff" + bytes(6))):
        node.do(f"OS {word}")
        assert node.sdo_write(index, sub, b"another") == 0
        assert "OS 61 6E 6F 74 68 65 72" in node.last.lines
        assert node.sdo_read(*status) == bytes([int(word[0])])
        assert node.sdo_read(*reply) == octets


def test_effect_pdo_cob_id(device: Device, node: Testee) -> None:
    """The rules hold for every PDO; those of an axis other than the first are not active."""
    refused = code(device, "invalid_value")
    for index, sub in places(device, "pdo_cob_id"):
        assert node.sdo_write(index, sub, u32(OFF | NO_RTR)) == 0
        for value in (*RESTRICTED, *NOT_A_CAN_ID):
            assert node.sdo_write(index, sub, u32(NO_RTR | value)) == refused, (hex(index), hex(value))
        assert node.sdo_write(index, sub, u32(OFF | NOT_A_CAN_ID[0])) == refused
        assert node.sdo_write(index, sub, u32(0x190)) == refused
        for value in (*UNRESTRICTED, OFF | RESTRICTED[-1]):
            assert node.sdo_write(index, sub, u32(OFF | value)) == 0
            assert node.sdo_write(index, sub, u32(NO_RTR | OFF | value)) == 0
            assert node.sdo_read(index, sub) == u32(NO_RTR | OFF | value)
        assert node.sdo_write(index, sub, u32(NO_RTR | 0x190)) == 0
        assert node.sdo_write(index, sub, u32(NO_RTR | 0x191)) == refused
        assert node.sdo_write(index, sub, u32(NO_RTR | 0x190)) == 0
        assert node.sdo_read(index, sub) == u32(NO_RTR | 0x190)
    map_pdo(node, TPDO, 0x60410010)
    assert node.nmt(START).sent(0x190)
    assert node.sdo_write(TPDO, 1, u32(OFF | NO_RTR | 0x190)) == 0
    assert not node.last.sent(0x190)
    assert node.sdo_write(TPDO, 1, u32(NO_RTR | 0x191)) == 0
    assert len(node.last.sent(0x191)) == 1


def test_effect_pdo_parameter(device: Device, node: Testee) -> None:
    """A new event timer starts when it is written, a new inhibit time counts from the last frame."""
    silence(node, device)
    map_pdo(node, TPDO, 0x60410010)
    node.nmt(START)
    node.advance(5 * MS)
    assert node.sdo_write(TPDO, 5, u16(20)) == 0
    assert [frame.at - node.last.begin for frame in node.advance(50 * MS).frames] == [20 * MS, 40 * MS]
    assert node.sdo_write(TPDO, 3, u16(350)) == 0
    assert [frame.at - node.last.begin for frame in node.advance(50 * MS).frames] == [25 * MS]
    assert node.sdo_write(TPDO, 2, b"\1") == 0
    assert not node.advance(100 * MS).frames
    assert node.rx(0x80).sent(0x190)


def test_effect_pdo_mapped_count(device: Device, node: Testee) -> None:
    most = device.max_pdo_entries
    for index, sub in places(device, "pdo_mapped_count"):
        communication = index - 0x200
        long = 0x607A0020 if communication < TPDO else 0x60640020
        assert node.sdo_write(communication, 1, u32(OFF | NO_RTR)) == 0
        assert node.sdo_write(index, sub, bytes([most + 1])) == code(device, "value_too_high")
        assert node.sdo_write(index, sub, b"\0") == 0
        for number in range(most):
            assert node.sdo_write(index, number + 1, u32(long)) == 0
        assert node.sdo_write(index, sub, b"\3") == code(device, "pdo_length")
        assert node.sdo_read(index, sub) == b"\0"
        assert node.sdo_write(index, sub, b"\2") == 0
        assert node.sdo_read(index, sub) == b"\2"
        assert node.sdo_write(communication, 1, u32(NO_RTR | 0x190)) == 0
        assert node.sdo_write(index, sub, b"\0") == code(device, "device_state")
        assert node.sdo_read(index, sub) == b"\2"


def test_effect_pdo_mapping(device: Device, node: Testee) -> None:
    state, unmappable = code(device, "device_state"), code(device, "not_mappable")
    for index, sub in places(device, "pdo_mapping"):
        communication = index - 0x200
        good, other_way = (0x60400010, 0x60410010) if communication < TPDO else (0x60410010, 0x10000020)
        assert node.sdo_write(communication, 1, u32(OFF | NO_RTR)) == 0
        assert node.sdo_write(index, 0, b"\1") in (0, code(device, "no_object"))
        assert node.sdo_write(index, 0, b"\0") == 0
        for value, refusal in (
            (0x60400008, unmappable),  # not its length
            (other_way, unmappable),
            (0x10180120, unmappable),
            (0x5FFF0010, code(device, "no_object")),
            (0x00050008, code(device, "no_object")),  # a dummy
            (0x60400110, code(device, "no_sub_index")),
        ):
            assert node.sdo_write(index, sub, u32(value)) == refusal, (hex(index), hex(value))
        for value in (good, 0, good):
            assert node.sdo_write(index, sub, u32(value)) == 0
            assert node.sdo_read(index, sub) == u32(value)
        if sub == 1:
            assert node.sdo_write(index, 0, b"\1") == 0
            assert node.sdo_write(index, sub, u32(good)) == state
            assert node.sdo_write(communication, 1, u32(NO_RTR | 0x190)) == 0
            assert node.sdo_write(index, sub, u32(good)) == state


def test_effect_tmcl_mode(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "tmcl_mode")
    axis_entries = [item for item in entries(device) if item.axis is not None and not 0x1000 <= item.index < 0x2000]
    for word in (b"save", b"kill", b"ekam", bytes(4)):
        assert node.sdo_write(index, sub, word) == code(device, "not_stored")
    assert node.sdo_write(index, sub, b"make") == 0
    assert node.sdo_read(index, sub) == u32(1)
    state = code(device, "device_state")
    dump = node.dump()
    for item in axis_entries:
        place = (item.index, item.entry.sub)
        assert node.sdo_read(*place) == dump[place] == state, place
        if item.entry.access.writable:
            assert node.sdo_write(*place, power_on_value(item, NODE_ID, SERIAL)) == state
    node.nmt(RESET_COMMUNICATION)
    assert node.sdo_read(index, sub) == u32(1)
    node.nmt(RESET_NODE)
    assert node.sdo_read(index, sub) == u32(0)
    assert node.sdo_read(axis_entries[0].index, 0) == power_on_value(axis_entries[0], NODE_ID, SERIAL)


def test_effect_manufacturer_mode(device: Device, node: Testee) -> None:
    ((index, sub),) = places(device, "manufacturer_mode")
    strict = {
        (RPDO, 1, u32(0x200 + NODE_ID)): code(device, "invalid_value"),  # bit 30 is missing
        (RPDO + 0x200, 0, b"\0"): code(device, "device_state"),
        (RPDO + 0x200, 1, u32(0)): code(device, "device_state"),
    }
    for word in (b"save", b"lliK", bytes(4)):
        assert node.sdo_write(index, sub, word) == code(device, "not_stored")
    for word, on in ((b"kill", 0), (b"make", 1), (b"kill", 0)):
        assert node.sdo_write(index, sub, word) == 0
        assert node.sdo_read(index, sub) == u32(on)
        for (pdo, part, value), refusal in strict.items():
            assert node.sdo_write(pdo, part, value) == (0 if on else refusal), (word, hex(pdo))


FIRST_OUTPUT = 16
"""OUT0 is this bit of the wanted outputs and of their mask."""


def test_effect_digital_outputs(device: Device, node: Testee) -> None:
    """Outputs whose mask bit is set follow at once; the others keep their state."""
    (wanted,), (mask,) = places(device, "digital_outputs"), places(device, "output_mask")
    assert node.sdo_write(*mask, u32(0b101 << FIRST_OUTPUT)) == 0
    assert node.sdo_write(*wanted, u32(0xFFFFFFFF)) == 0
    assert node.last.outputs == [(0, "digital", 0b101)]
    assert node.sdo_write(*wanted, u32(0b011 << FIRST_OUTPUT)) == 0
    assert node.last.outputs == [(0, "digital", 0b001)]
    assert node.sdo_write(*wanted, u32(0b001 << FIRST_OUTPUT)) == 0
    assert not node.last.outputs
    every = (1 << device.identity.digital_outputs) - 1
    assert node.sdo_write(*mask, u32(0xFFFFFFFF)) == 0
    assert node.sdo_write(*wanted, u32(0xFFFFFFFF)) == 0
    assert node.last.outputs == [(0, "digital", every)]


def test_effect_output_mask(device: Device, node: Testee) -> None:
    """Outputs that the mask takes in get their wanted state at once, those that it drops keep theirs."""
    (wanted,), (mask,) = places(device, "digital_outputs"), places(device, "output_mask")
    assert node.sdo_write(*mask, u32(0)) == 0
    assert node.sdo_write(*wanted, u32(0b110 << FIRST_OUTPUT)) == 0
    assert not node.last.outputs
    for taken, outputs in ((0b010, [0b010]), (0b100, [0b110]), (0b001, [])):
        assert node.sdo_write(*mask, u32(taken << FIRST_OUTPUT)) == 0
        assert [value for _, _, value in node.last.outputs] == outputs


def test_bus_settings_count_after_the_next_reset(device: Device, node: Testee) -> None:
    (rate_index, _), (id_index, _) = places(device, "bus_setting")
    assert node.sdo_write(rate_index, 0, u16(250)) == 0
    assert node.sdo_write(id_index, 0, b"\x2a") == 0
    assert node.sdo_write(*places(device, "store")[0], b"save") == 0
    assert node.sdo_read(*role(device, "node_id_load")) == bytes([NODE_ID])
    node.nmt(RESET_COMMUNICATION)
    assert node.node_id == NODE_ID
    assert node.nmt(RESET_NODE).lines[0] == "BUS 250 42"
    assert node.last.sent(0x72A) == [b"\0"]
    assert node.sdo_read(*role(device, "node_id_load")) == b"\x2a"
    assert node.sdo_read(*role(device, "can_bit_rate_load")) == u16(250)


# ---- abort codes -----------------------------------------------------------------------------------------------------


def test_every_declared_abort_code_is_given(device: Device, node: Testee) -> None:
    """And `start` watches every other test for codes that are not declared."""
    most = device.max_pdo_entries
    (mode, _) = places(device, "tmcl_mode")[0]

    def wrong_toggle() -> int:
        assert node.request([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]) is not None
        return abort_code(node.request([0x70, 0, 0, 0, 0, 0, 0, 0]))

    def time_out() -> int:
        assert node.request([0x40, 0x08, 0x10, 0, 0, 0, 0, 0]) is not None
        (frame,) = node.advance(2000 * MS).frames
        assert frame.at - node.last.begin == 1000 * MS
        return abort_code(frame.data)

    def broken_memory() -> int:
        node.do("NVM fail")
        return node.sdo_write(*places(device, "store")[0], b"save")

    def too_much_mapped() -> int:
        assert node.sdo_write(RPDO, 1, u32(OFF | NO_RTR)) == 0
        assert node.sdo_write(RPDO + 0x200, 0, b"\0") == 0
        assert [node.sdo_write(RPDO + 0x200, 1 + n, u32(0x607A0020)) for n in range(most)] == [0] * most
        return node.sdo_write(RPDO + 0x200, 0, bytes([most]))

    def not_mappable() -> int:
        return node.sdo_write(RPDO + 0x200, 1, u32(0x10000020))

    def limit(name: str) -> int:
        """The first entry that refuses a value for this reason."""
        for item in writable(device):
            for value, refusal in bad_values(device, item.entry):
                if refusal == code(device, name) and item.entry.effect in KEPT:
                    return node.sdo_write(item.index, item.entry.sub, encode(item.entry, value))
        return 0

    provoked: dict[str, Callable[[], int | bytes]] = {
        "toggle_bit": wrong_toggle,
        "timeout": time_out,
        "command": lambda: abort_code(node.request([0xA0, 0, 0x10, 0, 0, 0, 0, 0])),
        "read_only": lambda: node.sdo_write(0x1000, 0, bytes(4)),
        "no_object": lambda: node.sdo_read(0x5FFF, 0),
        "no_sub_index": lambda: node.sdo_read(0x1000, 1),
        "too_long": lambda: node.sdo_write(0x1017, 0, bytes(4)),
        "too_short": lambda: node.sdo_write(0x1017, 0, bytes(1)),
        "invalid_value": lambda: limit("invalid_value"),
        "value_too_high": lambda: limit("value_too_high"),
        "value_too_low": lambda: limit("value_too_low"),
        "device_state": lambda: node.sdo_write(0x1023, 1, bytes(7)),
        "not_stored": lambda: node.sdo_write(mode, 0, bytes(4)),
        "pdo_length": too_much_mapped,
        "not_mappable": not_mappable,
        "hardware": broken_memory,
    }
    for name, provoke in provoked.items():
        assert provoke() == code(device, name), name
    assert node.abort_codes == {abort.code for abort in device.abort_codes if abort.used}


def abort_code(frame: bytes | None) -> int:
    assert frame is not None
    assert frame[0] == 0x80
    return int.from_bytes(frame[4:], "little")
