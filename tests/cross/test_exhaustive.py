"""Every entry of both devices, over the bus: what C and Python answer is what the oracle says.

Each subject is one long dialogue for each device: it is written down once, with what the specification expects, and
played to both runtimes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from tests.cross.expected import power_on_value
from tests.cross.oracle import PRE_OPERATIONAL, RESET_COMMUNICATION, RESET_NODE, START, STOP, Dialogue, Item
from tests.cross.situations import ALL, STALL, UP, Situation
from tests.cross.testee import Bench

from odsmith.canopen_types import PdoDirection
from odsmith.model import Device

NODE_ID = 5

Address = tuple[int, int]

INACTIVE = 0xC0000000


def octets(item: Item, value: int) -> bytes:
    return value.to_bytes(item.size, "little", signed=value < 0)


def write(dialogue: Dialogue, at: Address, value: int) -> None:
    dialogue.download(at, octets(dialogue.oracle.items[at], value))


def values(item: Item) -> Iterator[int]:
    """Both limits and what lies beside them, all named values, signatures, and the first hole in a set."""
    entry = item.entry
    intervals = entry.allowed.intervals if entry.allowed else ((entry.type.low, entry.type.high),)
    named = {named.value for named in entry.values} | {signature.value for signature in entry.signatures}
    chosen = {side for low, high in intervals for side in (low - 1, low, high, high + 1)}
    for value in sorted(chosen | named | {value ^ 1 for value in named if entry.signatures}):
        if entry.type.low <= value <= entry.type.high:
            yield value


# ---- subjects --------------------------------------------------------------------------------------------------------


def every_value(dialogue: Dialogue) -> None:
    """Each entry is read, and written with every value that decides something; commands act, and resets follow."""
    for at, item in dialogue.oracle.items.items():
        dialogue.upload(at)
        for value in values(item) if item.entry.type.integer else ():
            write(dialogue, at, value)
            dialogue.upload(at)
            if item.entry.role == "tmcl_mode":
                dialogue.nmt(RESET_NODE)
        if item.entry.signatures:
            dialogue.nmt(RESET_COMMUNICATION)
            dialogue.nmt(RESET_NODE)
    dialogue.dump()
    dialogue.nmt(RESET_NODE)
    dialogue.dump()


def every_length(dialogue: Dialogue) -> None:
    """Each entry is written with 0 to 8 octets and one more than fit, in each kind of transfer."""
    for at, item in dialogue.oracle.items.items():
        data = dialogue.oracle.values[at].ljust(9, b"\0")
        for length in {*range(9), item.size + 1}:
            dialogue.download(at, data[:length], segmented=True)
            if item.entry.access.writable:
                dialogue.download(at, data[:length], segmented=True, sized=False)
            if 1 <= length <= 4:
                dialogue.download(at, data[:length])
        dialogue.download(at, data[:4], sized=False)
    dialogue.dump()


def every_mapping(dialogue: Dialogue) -> None:
    """Each entry is mapped into an RPDO and a TPDO, with right and wrong lengths; in manufacturer mode, too."""
    oracle = dialogue.oracle
    addresses = [*oracle.items, *((at[0], at[1] + 1) for at in oracle.items), (0, 0), (5, 0), (7, 0), (0x5FFF, 0)]
    for kind in ("rpdo", "tpdo"):
        pdo = next(pdo for instance, pdo in oracle.pdos.items() if instance == (2 if kind == "rpdo" else 3, 1))
        cob_id, count, entry = (pdo[role][0].address for role in ("pdo_cob_id", "pdo_mapped_count", "pdo_mapping"))
        write(dialogue, cob_id, INACTIVE | 0x185)
        write(dialogue, count, 0)
        for index, sub in addresses:
            bits = oracle.items[index, sub].entry.bit_length if (index, sub) in oracle.items else 8
            for length in {bits, bits ^ 8, bits * 2, 0}:
                write(dialogue, entry, index << 16 | sub << 8 | length & 0xFF)
        dialogue.upload(entry)
        relax(dialogue, "make")
        for index, sub in (each for each in addresses if each in oracle.items):
            write(dialogue, count, 0)
            write(dialogue, entry, index << 16 | sub << 8 | oracle.items[index, sub].entry.bit_length)
            write(dialogue, count, 1)
            write(dialogue, entry, index << 16 | sub << 8 | oracle.items[index, sub].entry.bit_length)
        relax(dialogue, "kill")
    dialogue.dump()


def every_pdo(dialogue: Dialogue) -> None:
    """Each PDO of each axis: every rule of its COB-ID, of its number of entries and of the order of the procedure."""
    oracle = dialogue.oracle
    mappable = [item for item in oracle.items.values() if item.entry.mapping is not PdoDirection.NO]
    for mode in ("kill", "make"):
        relax(dialogue, mode)
        for (scope, _), pdo in oracle.pdos.items():
            cob_id, count = pdo["pdo_cob_id"][0].address, pdo["pdo_mapped_count"][0].address
            entries = [item.address for item in pdo["pdo_mapping"]]
            carried = [
                item.expanded.index << 16 | item.entry.sub << 8 | item.entry.bit_length
                for item in mappable
                if (item.entry.mapping.receivable if scope == 2 else item.entry.mapping.transmittable)
            ]
            wide = [value for value in carried if value & 0xFF == 32]
            # bits 11 to 31 of an inactive and an active one, and CAN-IDs at the borders of those that are reserved
            for value in (INACTIVE, 0x40000201):
                for bit in range(11, 32):
                    write(dialogue, cob_id, value ^ 1 << bit)
                write(dialogue, cob_id, value)
            for can_id in (0, 0x7F, 0x80, 0x100, 0x101, 0x180, 0x181, 0x580, 0x581, 0x5FF, 0x600, 0x601, 0x67F, 0x680):
                for value in (can_id, 0x40000000 | can_id, INACTIVE | can_id, 0x40000000 | can_id):
                    write(dialogue, cob_id, value)
            for can_id in (0x6DF, 0x6E0, 0x7FF):
                write(dialogue, cob_id, INACTIVE | can_id)
                write(dialogue, cob_id, 0x40000000 | can_id)
            # each step of the procedure while the others are not done
            for active in (0x40000201, INACTIVE | 0x201):
                write(dialogue, cob_id, INACTIVE)
                write(dialogue, cob_id, active)
                for number in (1, 0, 2, 3, 4):
                    write(dialogue, count, number)
                    for at in entries:
                        write(dialogue, at, carried[at[1] % len(carried)])
            write(dialogue, cob_id, INACTIVE)
            # a hole among the entries, and more than 64 bits
            for mapping in ((wide[0], 0, wide[0]), (0, 0, 0), (wide[0], wide[0], carried[0]), (wide[0], wide[0], 0)):
                write(dialogue, count, 0)
                for at, value in zip(entries, mapping, strict=True):
                    write(dialogue, at, value)
                for number in (3, 2, 1, 2, 3):
                    write(dialogue, count, number)
                for at, value in zip(entries, reversed(mapping), strict=True):
                    write(dialogue, at, value)
            write(dialogue, cob_id, 0x40000201)
        dialogue.dump()


def tmcl_mode(dialogue: Dialogue) -> None:
    """While the module obeys TMCL the axes are out of reach for every service, and OS commands are not."""
    oracle = dialogue.oracle
    mode = oracle.places["tmcl_mode"][0].address
    command, reply = (oracle.places[role][0].address for role in ("os_command", "os_reply"))
    write(dialogue, mode, oracle.device.signatures["make"].value)
    for at, item in oracle.items.items():
        dialogue.upload(at)
        if item.owner is not None:
            dialogue.download(at, bytes(item.size))
            dialogue.download(at, bytes(item.size), segmented=True)
            dialogue.download(at, bytes(item.size + 1), segmented=True)
    for status in (0, 1, 2, 3):
        dialogue.callback(status, b"\x11\x22\x33")
        for length in range(9):
            dialogue.download(command, bytes(range(1, length + 1)), segmented=True)
        dialogue.upload(command)
        dialogue.upload(reply)
    dialogue.dump()
    dialogue.nmt(RESET_COMMUNICATION)
    dialogue.dump()
    dialogue.nmt(RESET_NODE)
    dialogue.download(command, bytes(7), segmented=True)
    dialogue.dump()


def storage(dialogue: Dialogue) -> None:
    """Each command to save, then each to restore: what is read after each kind of reset, with every value changed."""
    oracle = dialogue.oracle
    commands = {
        effect: [item for item in oracle.items.values() if item.entry.effect == effect]
        for effect in ("store", "restore")
    }
    for turn, item in enumerate(commands["store"]):
        change_all(dialogue, turn)
        order(dialogue, item)
        change_all(dialogue, turn + 1)
        dialogue.nmt(RESET_COMMUNICATION)
        dialogue.dump()
        dialogue.nmt(RESET_NODE)
        dialogue.dump()
    for turn, item in enumerate(commands["restore"]):
        change_all(dialogue, turn)
        order(dialogue, commands["store"][0])
        order(dialogue, item)
        dialogue.dump()
        dialogue.nmt(RESET_COMMUNICATION)
        dialogue.dump()
        dialogue.power()
        dialogue.dump()
        # a memory that fails keeps what it has, and nothing of it is in force meanwhile
        dialogue.memory(fails=True)
        order(dialogue, item)
        order(dialogue, commands["store"][0])
        dialogue.nmt(RESET_NODE)
        dialogue.memory(fails=False)
        order(dialogue, commands["store"][-1])
        dialogue.nmt(RESET_NODE)
    dialogue.dump()


def every_state(dialogue: Dialogue) -> None:
    """In each situation of an axis its entries are written with what they hold, modes change, and its state ends."""
    oracle = dialogue.oracle
    ends: tuple[Callable[[], None], ...] = (
        lambda: dialogue.nmt(STOP),
        lambda: dialogue.enable(False),
        lambda: dialogue.fault(axis, "overtemperature", holds=True),
    )
    for axis in (0, oracle.device.axes - 1):
        statusword = oracle.parts[axis, "statusword"].address
        display = oracle.parts[axis, "modes_of_operation_display"].address
        for situation in ALL:
            reach(dialogue, situation, axis)
            for item in oracle.items.values():
                if item.owner == axis and item.entry.access.writable and item.entry.role != "controlword":
                    dialogue.download(item.address, oracle.values[item.address])
            for mode in oracle.device.modes:
                dialogue.write(axis, "modes_of_operation", mode.code)
                for at in (display, statusword):
                    dialogue.upload(at)
                dialogue.advance(1000)
                for at in (display, statusword):
                    dialogue.upload(at)
            dialogue.dump()
            for end in ends:
                reach(dialogue, situation, axis)
                dialogue.write(axis, "brake_delay_times_apply", 2)
                end()
                dialogue.upload(statusword)
                for _ in range(4):
                    dialogue.advance(1000)
                    dialogue.upload(statusword)
                dialogue.nmt(PRE_OPERATIONAL)
                dialogue.upload(statusword)
            dialogue.dump()


def faults(dialogue: Dialogue) -> None:
    """Each fault of the hardware, in and out of OPERATION ENABLED, with each reaction of the network to errors."""
    oracle = dialogue.oracle
    behaviour = [item.address for item in oracle.places["error_behaviour"]][1]
    names = [name for name, condition in oracle.device.conditions.items() if condition.scope == "axis"]
    for state in (0, 1, 2):
        for name in names:
            for steps in ((), UP):
                dialogue.nmt(RESET_NODE)
                dialogue.nmt(START)
                write(dialogue, behaviour, state)
                for role, value in steps:
                    dialogue.write(0, role, value)
                dialogue.advance(1000)
                for holds in (True, False):
                    dialogue.fault(0, name, holds=holds)
                    dialogue.upload(oracle.parts[0, "statusword"].address)
                    dialogue.advance(1000)
                    dialogue.dump()
                    dialogue.nmt(PRE_OPERATIONAL)
                    dialogue.write(0, "controlword", 0x80)
                    dialogue.upload(oracle.parts[0, "statusword"].address)
                    dialogue.write(0, "controlword", 0x06)
                    dialogue.upload(oracle.parts[0, "statusword"].address)


def transfers(dialogue: Dialogue) -> None:
    """What goes wrong in a transfer, whatever its entry: toggle bits, time, segments that nobody asked for."""
    oracle = dialogue.oracle
    name, mode = (0x1008, 0), (0x1015, 0)
    upload, download = bytes([0x40, 8, 16, 0, 0, 0, 0, 0]), bytes([0x21, 0x15, 16, 0, 2, 0, 0, 0])
    assert name in oracle.items
    assert oracle.items[mode].size == 2
    for state in (START, STOP, PRE_OPERATIONAL):
        dialogue.nmt(state)
        for begin in (upload, download, upload[:7], bytes([0x80]) + upload[1:]):
            for command in range(256):
                dialogue.sdo(begin)
                dialogue.sdo(bytes([command, 0x08, 0x10, 0, 0x34, 0x12, 0, 0]))
                dialogue.sdo(bytes([0x60, 0, 0, 0, 0, 0, 0, 0]))
                dialogue.sdo(bytes([0x1B, 0, 0, 0, 0, 0, 0, 0]))
            for us in (999_999, 1_000_000):
                dialogue.sdo(begin)
                dialogue.advance(us)
                dialogue.sdo(bytes([0x60, 0, 0, 0, 0, 0, 0, 0]))
                dialogue.advance(us)
    dialogue.dump()


QUICK = (tmcl_mode,)
SLOW = (every_value, every_state, faults, every_length, every_mapping, every_pdo, storage, transfers)
SUBJECTS = (*QUICK, *SLOW)


def relax(dialogue: Dialogue, signature: str) -> None:
    """Manufacturer mode on (`make`) or off (`kill`)."""
    oracle = dialogue.oracle
    write(dialogue, oracle.places["manufacturer_mode"][0].address, oracle.device.signatures[signature].value)


def reach(dialogue: Dialogue, situation: Situation, axis: int) -> None:
    """From anywhere."""
    dialogue.enable(True)
    for name in (STALL, "overtemperature"):
        dialogue.fault(axis, name, holds=False)
    dialogue.nmt(RESET_NODE)
    dialogue.advance(1000)
    situation.play(dialogue, axis)


def order(dialogue: Dialogue, command: Item) -> None:
    write(dialogue, command.address, command.entry.signatures[0].value)


def change_all(dialogue: Dialogue, turn: int) -> None:
    """Another value for everything that is stored, but for the little that an active PDO refuses."""
    for at, item in dialogue.oracle.items.items():
        entry = item.entry
        if entry.stored == "never":
            continue
        if entry.role == "pdo_cob_id":
            value = INACTIVE | 0x201 + turn
        elif entry.role == "pdo_mapped_count":
            value = 0
        elif entry.role in ("cob_id_sync", "cob_id_emcy"):
            value = 0x81 + turn
        else:
            low, high = entry.allowed.intervals[-1] if entry.allowed else (entry.type.low, entry.type.high)
            value = high - turn % (high - low + 1)
        write(dialogue, at, value)


# ---- playing ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(scope="module")
def written(device: Device) -> Callable[[Callable[[Dialogue], None]], Dialogue]:
    """The dialogue on a subject, written once for both runtimes."""

    @cache
    def find(subject: Callable[[Dialogue], None]) -> Dialogue:
        dialogue = Dialogue(device, NODE_ID)
        subject(dialogue)
        return dialogue

    return find


@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda subject: subject.__name__)
def test_c(
    subject: Callable[[Dialogue], None],
    device: Device,
    written: Callable[[Callable[[Dialogue], None]], Dialogue],
    c_testee: Callable[[Device], Path],
) -> None:
    dialogue = written(subject)
    difference = dialogue.difference(dialogue.played_by(c_testee(device)))
    assert not difference, difference


@pytest.mark.parametrize(
    "subject",
    [*QUICK, *(pytest.param(subject, marks=pytest.mark.slow) for subject in SLOW)],
    ids=lambda subject: subject.__name__,
)
def test_python(
    subject: Callable[[Dialogue], None],
    device: Device,
    written: Callable[[Callable[[Dialogue], None]], Dialogue],
    start_python: Callable[..., Bench],
) -> None:
    dialogue = written(subject)
    bench = start_python(device, node_id=NODE_ID)
    difference = dialogue.difference(map(bench.answer, dialogue.lines))
    assert not difference, difference


@pytest.mark.slow
def test_defaults(device: Device, c_testee: Callable[[Device], Path], start_python: Callable[..., Bench]) -> None:
    """The full dump after reset is that of the model, with the node-ID, for several of them."""
    for node_id in (1, NODE_ID, 127):
        dialogue = Dialogue(device, node_id)
        dialogue.dump()
        dialogue.nmt(RESET_NODE)
        dialogue.dump()
        assert dict(dialogue.oracle.dump()) == {
            at: power_on_value(item.expanded, node_id) for at, item in dialogue.oracle.items.items()
        }
        bench = start_python(device, node_id=node_id)
        assert not dialogue.difference(dialogue.played_by(c_testee(device)))
        assert not dialogue.difference(map(bench.answer, dialogue.lines))


@pytest.mark.slow
def test_every_abort_code_occurs(device: Device, written: Callable[[Callable[[Dialogue], None]], Dialogue]) -> None:
    """The dialogues bring out each abort code that the device declares as used, and no other."""
    seen = {
        line[-11:]
        for subject in SUBJECTS
        for expected in written(subject).expected
        for line in expected
        if line.startswith("TX") and line[7:9] == "80"
    }
    declared = {abort.code.to_bytes(4, "little").hex(" ").upper() for abort in device.abort_codes if abort.used}
    assert seen == declared
