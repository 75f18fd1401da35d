"""Lines for testees, drawn by hypothesis: likely ones, and ones that nobody would send.

Each strategy gives the lines of one thing that happens: a frame, a whole SDO transfer, the configuration of a PDO.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from hypothesis import strategies as st
from tests.cross import expected
from tests.cross.set_points import HOMING, LEVELS, RAMP, SET_POINTS, STARTS, SWITCHES, WORDS

from odsmith.canopen_types import DataType, PdoDirection
from odsmith.model import Device, Entry
from odsmith_runtime.device.simulation import INPUTS, SUPPLY

Lines = list[str]
Address = tuple[int, int]
"""Index and sub-index."""

T = TypeVar("T")
Event = st.SearchStrategy[Lines]

SAVE, LOAD = 0x65766173, 0x64616F6C
SIGNATURES = (SAVE, LOAD, 0x656B616D, 0x6C6C696B)
"""save, load, make, kill"""

NOT_VALID = 1 << 31
"""The bit of a COB-ID that switches its object off."""

NO_REMOTE = 1 << 30
"""The bit of the COB-ID of a TPDO that says that no remote frame asks for it."""

CAN_EVENTS = ("ok", "warning", "passive", "busoff", "error", "overrun", "rxfull", "txfull")

START, SYNC = "RX 000 01 00", "RX 080"

TIME_OUT = 1_000_000
"""Microseconds after which the SDO server gives a transfer up."""


_waits = st.one_of(st.sampled_from([1000, 3000, 10_000, 30_000, 100_000]), st.integers(1, 500_000)).map(
    lambda us: [f"T {us}"]
)
"""Time that an axis has."""


def _joined(groups: Iterable[Lines]) -> Lines:
    return [line for lines in groups for line in lines]


def rx(can_id: int, data: Iterable[int]) -> str:
    return " ".join([f"RX {can_id & 0x7FF:03X}", *(f"{octet & 0xFF:02X}" for octet in data)])


def octets(value: int, size: int) -> bytes:
    """The lowest octets of a number."""
    return (value & (1 << 8 * size) - 1).to_bytes(size, "little")


def download(node_id: int, index: int, sub: int, value: bytes, *, segmented: bool = False) -> Lines:
    """The frames of a client that writes an entry, and expects no abort."""
    address = [index & 0xFF, index >> 8, sub]
    if 0 < len(value) <= 4 and not segmented:
        return [rx(0x600 + node_id, [0x23 | 4 - len(value) << 2, *address, *value.ljust(4, b"\0")])]
    lines = [rx(0x600 + node_id, [0x21, *address, *octets(len(value), 4)])]
    for number, at in enumerate(range(0, max(len(value), 1), 7)):
        part = value[at : at + 7]
        command = (number & 1) << 4 | 7 - len(part) << 1 | (at + 7 >= len(value))
        lines.append(rx(0x600 + node_id, [command, *part.ljust(7, b"\0")]))
    return lines


def upload(node_id: int, index: int, sub: int, segments: int) -> Lines:
    """The frames of a client that reads an entry, and believes that it comes in so many segments."""
    toggles = [0x60 | (number & 1) << 4 for number in range(segments)]
    requests = [[0x40, index & 0xFF, index >> 8, sub, 0, 0, 0, 0], *([toggle, *bytes(7)] for toggle in toggles)]
    return [rx(0x600 + node_id, request) for request in requests]


def _mostly(usual: st.SearchStrategy[T], seldom: st.SearchStrategy[T]) -> st.SearchStrategy[T]:
    """One in eight is of the seldom ones."""
    return _one_of(*[usual] * 7, seldom)


def _one_of(*choices: st.SearchStrategy[T]) -> st.SearchStrategy[T]:
    """All as likely as each other. (`one_of` takes its choices apart, and leaves out what it is given twice.)"""
    return st.integers(0, len(choices) - 1).flatmap(lambda number: choices[number])


class Events:
    """What may happen to a device that answers to `node_id`."""

    def __init__(self, device: Device, node_id: int) -> None:
        self.device = device
        self.node_id = node_id
        self._entries: dict[Address, Entry] = {
            (item.index, item.entry.sub): item.entry for item in expected.entries(device)
        }
        self._indices = [obj.index for obj in device.expanded]
        self._places: dict[str, list[Address]] = {}  # of a role, in each axis
        for address, entry in self._entries.items():
            self._places.setdefault(entry.role, []).append(address)

        self.nmt = self._nmt()
        self.sdo_frame = self._sdo_frame()
        self.frame = self._frame()
        self.read = self._read()
        self.write = self._write()
        self.traffic = self._traffic()
        self.pdo = self._pdo()
        self.store = self._store()
        self.time = self._time()
        self.motion = self._motion()
        self.departure = _one_of(st.just([]), self.motion)  # what may come first
        self.command = self._command()
        self.bench = self._bench()
        self.power = st.sampled_from([["POWER cut"], ["POWER on"]])
        self.cut = st.one_of(st.integers(1, 40), st.integers(1, 3000)).map(lambda writes: [f"POWER cut {writes}"])
        self.disturbed = st.one_of(self.read, self.write, self.pdo, self.store).flatmap(self._disturb)

        calm = st.one_of(
            self.sdo_frame,
            self.frame,
            self.time,
            self.read,
            self.write,
            self.pdo,
            self.store,
            self.disturbed,
            self.traffic,
            self.nmt,
            self.bench,
        )
        self.lively = _one_of(calm, calm, self.motion, self.command)
        """All but what takes the power away, which nothing survives that comes later."""

        self.anything = _mostly(self.lively, st.one_of(self.cut, self.power))

    # ---- words -------------------------------------------------------------------------------------------------------

    def _some(self, wanted: Callable[[Entry], bool]) -> st.SearchStrategy[Address]:
        """Entries; those of the communication profile, and those that something moves, more often than their share."""
        addresses = [address for address, entry in self._entries.items() if wanted(entry)]
        communication = [address for address in addresses if 0x1000 <= address[0] < 0x2000]
        moving = [address for address in addresses if self._entries[address].role]
        return st.one_of([st.sampled_from(choices) for choices in (communication, moving, addresses) if choices])

    def _addresses(self) -> st.SearchStrategy[Address]:
        """Mostly those of entries that are there."""
        beside = st.tuples(st.sampled_from(self._indices), st.integers(0, 255))
        anywhere = st.tuples(st.integers(0, 0xFFFF), st.integers(0, 255))
        return st.one_of(self._some(lambda entry: True), beside, anywhere)

    def _mapping(self, address: Address) -> int:
        return address[0] << 16 | address[1] << 8 | self._entries[address].bit_length

    def _mappings(self, allowed: Callable[[PdoDirection], bool]) -> st.SearchStrategy[int]:
        """PDO mapping entries: most are in order."""
        if not any(allowed(entry.mapping) for entry in self._entries.values()):
            return self._some(lambda entry: True).map(lambda address: self._mapping(address))
        right = self._some(lambda entry: allowed(entry.mapping)).map(lambda address: self._mapping(address))
        wrong = st.builds(
            lambda address, bits: address[0] << 16 | address[1] << 8 | bits,
            st.sampled_from(list(self._entries)),
            st.sampled_from([0, 1, 8, 16, 32, 64]),
        )
        return _mostly(right, wrong)

    def _cob_ids(self) -> st.SearchStrategy[int]:
        can_ids = [0x80, 0x181, 0x185, 0x201, 0x205, 0x301, 0x401, 0x581, 0x700]
        own = [base + self.node_id for base in (0x80, 0x180, 0x200, 0x300, 0x600)]
        return st.builds(
            lambda can_id, bits: can_id | bits << 30, st.sampled_from([*can_ids, *own]), st.sampled_from([0, 0, 1, 2])
        )

    def _values(self) -> st.SearchStrategy[int]:
        watched = st.builds(lambda node_id, time: node_id << 16 | time, st.integers(0, 130), st.integers(0, 20))
        small = st.integers(0, 12)
        mappings = self._mappings(lambda direction: direction is not PdoDirection.NO)
        return st.one_of(
            small, self._cob_ids(), watched, mappings, st.sampled_from(SIGNATURES), st.integers(0, 0xFFFFFFFF)
        )

    def _fitting(self, entry: Entry) -> st.SearchStrategy[bytes]:
        """Values of an entry: allowed ones, those at the limits and beside them, and of another length."""
        size = expected.size(entry)
        if not entry.type.integer:
            return st.binary(max_size=size + 1)
        values = self._values()
        if entry.allowed:
            limits = {limit for interval in entry.allowed.intervals for limit in interval}
            beside = sorted({limit + step for limit in limits for step in (-1, 0, 1)})
            values = st.one_of(st.sampled_from(beside), st.integers(entry.allowed.low, entry.allowed.high), values)
        sizes = st.sampled_from([size] * 12 + [size + 1, max(size - 1, 1)])
        return st.builds(octets, values, sizes)

    # ---- events ------------------------------------------------------------------------------------------------------

    def _nmt(self) -> Event:
        return st.builds(
            lambda command, to: [rx(0, [command, to])],
            st.sampled_from([1, 1, 1, 2, 128, 129, 130, 3]),
            st.sampled_from([0, self.node_id, self.node_id, self.node_id + 1]),
        )

    def _sdo_frame(self) -> Event:
        """One frame to the SDO server, whatever it expects."""

        def initiate(command: int, address: tuple[int, int], value: int) -> Lines:
            data = [command, address[0] & 0xFF, address[0] >> 8, address[1], *octets(value, 4)]
            return [rx(0x600 + self.node_id, data)]

        usual = st.sampled_from([0x40, 0x40, 0x23, 0x2B, 0x2F, 0x22, 0x21, 0x20])
        segment = st.sampled_from([0x60, 0x70, 0x00, 0x10, 0x01, 0x11, 0x80, 0x0F, 0x1F])
        segments = st.builds(
            lambda command, rest: [rx(0x600 + self.node_id, [command, *rest])],
            segment,
            st.binary(min_size=6, max_size=7),
        )
        initiates = st.builds(initiate, st.one_of(usual, st.integers(0, 255)), self._addresses(), self._values())
        return st.one_of(initiates, segments)

    def _frame(self) -> Event:
        """One frame that is none for the SDO server; most are for somebody."""
        own = [base + self.node_id for base in (0x200, 0x300, 0x400, 0x500)]
        rpdos = st.builds(rx, st.sampled_from([*own, 0x201, 0x205, 0x301]), st.binary(max_size=8))
        syncs = st.sampled_from([rx(0x80, b""), rx(0x80, b"\x01")])
        heartbeats = st.builds(
            lambda other, state: rx(0x700 + other, [state]), st.integers(1, 127), st.sampled_from([0, 4, 5, 127])
        )
        remotes = st.builds(
            "RX {:X} R {}".format,
            st.sampled_from([0x700 + self.node_id, 0x180 + self.node_id, 0x80]),
            st.integers(0, 8),
        )
        anything = st.builds(rx, st.integers(0, 0x7FF), st.binary(max_size=8))
        return st.one_of(rpdos, syncs, heartbeats, remotes, anything).map(lambda line: [line])

    def _read(self) -> Event:
        """A whole upload; now and then a segment more or less."""
        addresses = self._addresses()
        if any(entry.type is DataType.VISIBLE_STRING for entry in self._entries.values()):
            addresses = st.one_of(addresses, self._some(lambda entry: entry.type is DataType.VISIBLE_STRING))
        return st.builds(
            lambda address, segments: upload(self.node_id, address[0], address[1], segments),
            addresses,
            st.integers(0, 4),
        )

    def _write(self) -> Event:
        """A whole download, expedited or in segments."""

        def to(address: Address) -> Event:
            return st.builds(
                lambda value, segmented: download(self.node_id, *address, value, segmented=segmented),
                self._fitting(self._entries[address]),
                st.sampled_from([False, False, True]),
            )

        return self._some(lambda entry: entry.access.writable).flatmap(to)

    def _pdo(self) -> Event:
        """A PDO is configured as CiA 301 has it: invalid, emptied, mapped, counted, valid again. Then it may work."""

        def configure(
            record: int, cob_id: int, type: int, times: tuple[int, int], entries: Sequence[int], then: Lines
        ) -> Lines:
            mapping = record + 0x200
            writes = [
                (record, 1, cob_id | NOT_VALID, 4),
                (mapping, 0, 0, 1),
                *((mapping, sub, entry, 4) for sub, entry in enumerate(entries, start=1)),
                (mapping, 0, len(entries), 1),
                (record, 2, type, 1),
                *((record, sub, time, 2) for sub, time in zip((3, 5), times, strict=True) if time),
                (record, 1, cob_id, 4),
            ]
            lines = [download(self.node_id, index, sub, octets(value, size)) for index, sub, value, size in writes]
            return [*(line for download in lines for line in download), *then]

        def of(record: int) -> Event:
            sent = record >= 0x1800
            own = record % 0x40 % 4 * 0x100 + (0x180 if sent else 0x200) + self.node_id
            return st.builds(
                configure,
                st.just(record),
                st.sampled_from([own, own | NO_REMOTE, own | NO_REMOTE, 0x181 | NO_REMOTE, 0x201, 0x205 | NO_REMOTE]),
                st.sampled_from([0, 1, 2, 240, 0xFE, 0xFE, 0xFF, 0xFF]),
                st.tuples(st.sampled_from([0, 1, 15, 100]), st.sampled_from([0, 0, 1, 5, 1000])),
                st.lists(transmittable if sent else receivable, max_size=4),
                st.one_of(st.just([]), self.traffic.map(lambda lines: [START, *lines])),
            )

        receivable = self._mappings(lambda direction: direction.receivable)
        transmittable = self._mappings(lambda direction: direction.transmittable)
        records = [index for index in self._indices if 0x1400 <= index < 0x1600 or 0x1800 <= index < 0x1A00]
        return st.sampled_from(records).flatmap(of) if records else self.write

    def _traffic(self) -> Event:
        """What happens in an application: quickly one thing after the other."""
        can_ids = [base + self.node_id for base in (0x200, 0x300, 0x400, 0x500)]
        rpdos = st.builds(rx, st.sampled_from([*can_ids, 0x201, 0x205, 0x301]), st.binary(min_size=1, max_size=8))
        inputs = st.builds("IN {} {}".format, st.sampled_from(["digital", "analog0", "enable"]), st.integers(0, 3))
        waits = st.sampled_from([100, 700, 1000, 1000, 5000, 10_000]).map("T {}".format)
        one = st.one_of(st.just(SYNC), rpdos)
        then = st.builds(lambda input, wait: [input, wait], inputs, waits)
        return st.lists(st.one_of(one.map(lambda line: [line]), then), min_size=1, max_size=8).map(
            lambda groups: [line for lines in groups for line in lines]
        )

    def _store(self) -> Event:
        """Values are stored or restored; then the device may be reset, or power lost in the middle."""
        places = [
            (index, sub, signature)
            for index, signature in ((0x1010, SAVE), (0x1010, SAVE), (0x1011, LOAD))
            for sub in range(1, 11)
            if (index, sub) in self._entries
        ]
        if not places:
            return self.write
        resets = [[], [], ["RX 000 81 00"], ["RX 000 82 00"], ["POWER cut", "POWER on"]]
        write = st.sampled_from(places).map(
            lambda place: download(self.node_id, place[0], place[1], octets(place[2], 4))
        )
        return st.builds(lambda first, then: [*first, *then], write, st.sampled_from(resets))

    def _put(self, axis: int, name: str, values: st.SearchStrategy[int]) -> Event:
        """A value for a role of an axis; nothing where the device has no such value."""
        if name not in self._places:
            return st.just([])
        address = self._places[name][axis]
        size = expected.size(self._entries[address])
        return values.map(lambda value: download(self.node_id, *address, octets(value, size)))

    def _axes(self) -> st.SearchStrategy[int]:
        """One axis more often than the others."""
        return _one_of(st.just(0), st.integers(0, len(self._places["controlword"]) - 1))

    def _words(self, axis: int, *controlwords: int) -> Event:
        return st.tuples(*(self._put(axis, "controlword", st.just(word)) for word in controlwords)).map(_joined)

    def _set(self, axis: int, names: Iterable[str]) -> Event:
        return st.tuples(*(self._put(axis, name, SET_POINTS[name]) for name in names)).map(_joined)

    def _motion(self) -> Event:
        """An axis is prepared, moves, as far as that depends on its master, and things happen to it on its way."""

        def journey(axis: int, mode: int, *start: int) -> Event:
            return st.tuples(
                st.one_of(st.just([]), self._scenery(axis)),
                st.lists(self._parameter(axis), max_size=3).map(_joined),
                self._set(axis, RAMP),
                self._put(axis, "modes_of_operation", st.just(mode)),
                self._put(axis, "homing_method", methods) if mode == HOMING else st.just([]),
                st.sampled_from([[], ["T 1000"], [START]]),
                self._words(axis, 0x80, 6, 7, 0xF),
                st.sampled_from([["T 1000"], ["T 20000"], []]),
                self._set(axis, ("target_position", "target_velocity")),
                self._words(axis, *start),
                _waits,
                st.lists(st.tuples(self._incident(axis), _waits).map(_joined), max_size=8).map(_joined),
            ).map(_joined)

        if "controlword" not in self._places:
            return self.write
        methods = st.sampled_from([method.method for method in self.device.homing_methods] or [0])
        return st.tuples(self._axes(), st.sampled_from(STARTS)).flatmap(lambda drawn: journey(drawn[0], *drawn[1]))

    def _command(self) -> Event:
        """An axis is commanded and gets new set-points, whatever it does, and things happen to it."""

        def change(axis: int) -> Event:
            one = st.tuples(self._incident(axis), st.one_of(st.just([]), _waits)).map(_joined)
            return st.lists(one, min_size=1, max_size=6).map(_joined)

        return self._axes().flatmap(change) if "controlword" in self._places else self.write

    def _parameter(self, axis: int) -> Event:
        return st.sampled_from(sorted(SET_POINTS)).flatmap(lambda name: self._set(axis, [name]))

    def _incident(self, axis: int) -> Event:
        """What may happen to an axis on its way."""
        words = self._put(axis, "controlword", st.sampled_from(WORDS))
        modes = self._set(axis, ["modes_of_operation", "target_position", "target_velocity"])
        condition = st.sampled_from([name for name, each in self.device.conditions.items() if each.scope == "axis"])
        faults = st.builds("FAULT axis{} {} {}".format, st.just(axis), condition, st.sampled_from(["on", "off"]))
        stops = st.sampled_from(["RX 000 02 00", "RX 000 80 00", START, START, "RX 000 81 00", "RX 000 82 00"])
        enable = st.sampled_from(["IN enable 0", "IN enable 1", "IN enable 1"])
        hardware = self._hardware(axis)
        line = _mostly(_one_of(hardware, hardware, faults), _one_of(stops, enable)).map(lambda line: [line])
        return _one_of(words, words, self._parameter(axis), modes, line, line)

    def _scenery(self, axis: int) -> Event:
        """Switches on the way of an axis, and an encoder that counts like the one that 608Fh is told of."""
        encoder = self._put(axis, "encoder_increments", st.just(400)).map(
            lambda lines: [f"IN axis{axis}.increments 400", *lines]
        )

        def stands(name: str) -> Event:
            return SWITCHES[name].map(lambda at: [f"IN axis{axis}.{name} {at}"])

        return st.tuples(*map(stands, SWITCHES), st.one_of(st.just([]), encoder)).map(_joined)

    def _hardware(self, axis: int) -> st.SearchStrategy[str]:
        """Inputs of the simulated hardware."""

        def put(name: str) -> st.SearchStrategy[str]:
            limits = INPUTS[name]
            near = st.integers(max(limits.low, -2000), min(limits.high, 2000))
            likely = st.sampled_from([limits.initial, *LEVELS.get(name, ())])
            line = f"IN {SUPPLY}" if name == SUPPLY else f"IN axis{axis}.{name}"
            return _mostly(st.one_of(near, likely), st.integers(limits.low, limits.high)).map(lambda v: f"{line} {v}")

        return st.sampled_from(list(INPUTS)).flatmap(put)

    def _time(self) -> Event:
        steps = st.one_of(
            st.sampled_from([1, 100, 500, 999, 1000, 1001, 5000, 100_000, 1_000_000]),
            st.integers(0, 20_000),
            st.integers(0, 1 << 21),
        )
        return steps.map(lambda step: [f"T {step}"])

    def _bench(self) -> Event:
        """What happens to a device beside frames, time and power."""
        inputs = st.builds(
            "IN {} {}".format,
            st.sampled_from(["digital", "analog0", "analog3", "address", "enable"]),
            st.sampled_from([0, 0, 1, 5, 255]),
        )
        can = st.sampled_from(CAN_EVENTS).map("CAN {}".format)
        memory = st.sampled_from(["NVM ok", "NVM ok", "NVM fail", "NVM fail 8", "NVM fail 20"])
        commands = st.sampled_from(["OS none", "OS 0", "OS 1 01 02", "OS 2", "OS 3 FF"])
        choices = [inputs, can, memory, commands]
        if self.device.axes:
            conditions = [name for name, condition in self.device.conditions.items() if condition.scope == "axis"]
            faults = st.builds(
                "FAULT axis{} {} {}".format,
                st.integers(0, self.device.axes - 1),
                st.sampled_from(conditions),
                st.sampled_from(["on", "on", "off"]),
            )
            hardware = st.integers(0, self.device.axes - 1).flatmap(self._hardware)
            tell = st.sampled_from(["TELL driver on", "TELL driver off"])
            choices += [faults, hardware, tell]
        return st.one_of(choices).map(lambda line: [line])

    def _disturb(self, lines: Lines) -> Event:
        """The same, but broken off, with a frame lost, sent twice or damaged, or with something in between."""
        between = st.one_of(st.just([f"T {TIME_OUT}"]), self.nmt, self.sdo_frame, self.frame)
        at = st.integers(0, len(lines) - 1)
        return st.one_of(
            at.map(lambda at: lines[:at]),
            at.map(lambda at: [*lines[:at], *lines[at + 1 :]]),
            at.map(lambda at: [*lines[: at + 1], *lines[at:]]),
            st.builds(lambda at, more: [*lines[: at + 1], *more, *lines[at + 1 :]], at, between),
            st.builds(
                lambda at, where, flipped: [*lines[:at], _damage(lines[at], where, flipped), *lines[at + 1 :]],
                at,
                st.integers(0, 8),
                st.integers(1, 255),
            ),
        )


def _damage(line: str, at: int, flipped: int) -> str:
    """A frame with other bits in one of its octets, or without the last one."""
    word, can_id, *data = line.split(" ")
    if word != "RX" or can_id == "000":
        return line
    if at < len(data):
        data[at] = f"{int(data[at], 16) ^ flipped:02X}"
    else:
        data = data[:-1]
    return " ".join([word, can_id, *data])


_made: dict[tuple[str, int], Events] = {}


def events_of(device: Device, node_id: int) -> Events:
    """Made once, for strategies are slow to make."""
    key = (device.digest, node_id)
    if key not in _made:
        _made[key] = Events(device, node_id)
    return _made[key]


def dialogues(device: Device, node_id: int) -> st.SearchStrategy[Lines]:
    """Lines from power-on to a dump of everything."""
    events = events_of(device, node_id)
    return st.tuples(events.departure, st.lists(events.anything, min_size=5, max_size=40).map(_joined)).map(
        lambda groups: ["POWER on", *_joined(groups), "DUMP 0000-FFFF", "NVM"]
    )
