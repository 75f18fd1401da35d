"""Stretches of plain traffic: a master that keeps a device busy, its PDOs and all its axes, millisecond by millisecond.

Hypothesis takes longer for one choice than both runtimes for ten answers. So it leads a device somewhere, and from
there on a stretch makes many frames of one seed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from random import Random

from tests.cross import expected
from tests.cross.events import NO_REMOTE, NOT_VALID, START, SYNC, Lines, download, octets, rx, upload
from tests.cross.set_points import HOMING, STARTS, WORDS, some_number

from odsmith.model import Device, Entry, ExpandedEntry
from odsmith_runtime.device.simulation import INPUTS, SUPPLY

CAN_IDS = range(0x181, 0x580)
"""Those that any PDO may have."""

SYNCHRONOUS, OF_EVENTS = (1, 1, 1, 2, 3, 240), (0, 254, 255)
"""Transmission types."""

SPEEDS = ("profile_velocity", "profile_acceleration", "profile_deceleration", "target_position", "target_velocity")
HOMING_SPEEDS = ("homing_speeds_fast", "homing_speeds_slow", "homing_acceleration")
"""Roles of what a motion needs."""

REPAIRED = ("blocked", "temperature", "left", "right")
"""Inputs of the hardware that would hold an axis."""


@dataclass(frozen=True)
class Record:
    """A PDO: the index of its communication parameters, and what may be mapped."""

    index: int
    most: int
    mappable: Sequence[ExpandedEntry]


class Stretch:
    """Traffic with one device that answers to `node_id`: `begin`, and then the lines of about 1 ms with each `step`.

    All choices are those of `random`.
    """

    def __init__(self, device: Device, node_id: int, random: Random) -> None:
        self.device = device
        self.node_id = node_id
        self.random = random
        self.items = list(expected.entries(device))
        self.writable = [item for item in expected.writable(device) if item.index >= 0x2000]
        self.places = {(item.axis, item.entry.role): item for item in self.items if item.entry.role}
        self.methods = [method.method for method in device.homing_methods] or [0]
        self.received: list[tuple[int, list[ExpandedEntry]]] = []  # CAN-ID and mapping of the RPDOs

    def begin(self) -> Iterator[str]:
        """PDOs are set up anew, and axes set out."""
        yield rx(0, [0x80, self.node_id])
        yield from self._put(None, "producer_heartbeat_time", self.random.choice((0, 1, 5, 100)))
        records = self._records()
        for record, can_id in zip(records, self.random.sample(CAN_IDS, len(records)), strict=True):
            yield from self._configure(record, can_id)
        yield START
        for axis in range(self.device.axes):
            yield from self._set_out(axis)

    def step(self) -> Iterator[str]:
        for can_id, mapping in self.received:
            if not self.random.randrange(8):
                yield rx(can_id, b"".join(self._value(item) for item in mapping))
        if not self.random.randrange(4):
            yield from self._event()
        if self.random.randrange(8):
            yield SYNC
        yield f"T {1000 if self.random.randrange(16) else self.random.randrange(20_000)}"

    def _event(self) -> Lines:
        """One thing that happens beside PDOs, seldom what keeps an axis from going on."""
        random = self.random
        if not self.device.axes or not random.randrange(4):
            return random.choice((self._read, self._input))()
        axis = random.randrange(self.device.axes)
        match random.randrange(16):
            case 0:
                return self._disturb(axis)
            case 1 | 2 | 3:
                return self._set_out(axis)
            case 4 | 5 | 6:
                return self._put(axis, "controlword", random.choice(WORDS))
            case 7:
                return self._write(random.choice([item for item in self.writable if item.axis == axis]))
            case _:
                role = random.choice(("target_position", "target_velocity"))
                return [
                    *self._put(axis, role, some_number(role, random)),
                    *self._put(axis, "controlword", 0xF),
                    *self._put(axis, "controlword", 0x3F),
                ]

    # ---- axes --------------------------------------------------------------------------------------------------------

    def _set_out(self, axis: int) -> Lines:
        """Out of whatever holds it, into any mode, and off."""
        mode, *start = self.random.choice(STARTS)
        speeds = HOMING_SPEEDS if mode == HOMING else SPEEDS
        values = {role: some_number(role, self.random) for role in speeds}
        words = [("controlword", word) for word in (0x80, 6, 7, 0xF, *start)]
        steps = [
            ("modes_of_operation", mode),
            ("homing_method", self.random.choice(self.methods)),
            *values.items(),
            *words,
        ]
        hardware = [f"IN axis{axis}.{name} {INPUTS[name].initial}" for name in REPAIRED]
        return [*hardware, *(line for role, value in steps for line in self._put(axis, role, value))]

    def _disturb(self, axis: int) -> Lines:
        """The hardware of an axis is not as it should be; for a while, or until the axis sets out again."""
        faults = [name for name, condition in self.device.conditions.items() if condition.scope == "axis"]
        if self.random.randrange(2):
            fault = f"FAULT axis{axis} {self.random.choice(faults)}"
            return [f"{fault} on", f"T {self.random.randrange(3000)}", f"{fault} off"]
        name = self.random.choice([name for name in INPUTS if name != SUPPLY])
        limits = INPUTS[name]
        value = self.random.randint(max(limits.low, -2000), min(limits.high, 2000))
        return [f"IN axis{axis}.{name} {value}"]

    # ---- entries -----------------------------------------------------------------------------------------------------

    def _put(self, axis: int | None, role: str, value: int) -> Lines:
        """Nothing where the device has no such value."""
        item = self.places.get((axis, role))
        return (
            download(self.node_id, item.index, item.entry.sub, octets(value, expected.size(item.entry))) if item else []
        )

    def _write(self, item: ExpandedEntry) -> Lines:
        return download(self.node_id, item.index, item.entry.sub, self._value(item))

    def _value(self, item: ExpandedEntry) -> bytes:
        """One for an entry: mostly one that is allowed."""
        entry, random = item.entry, self.random
        if entry.role == "controlword":
            return octets(random.choice(WORDS), 2)
        try:
            return octets(some_number(entry.role, random), expected.size(entry))
        except KeyError:
            allowed = entry.allowed
        if allowed and random.randrange(8):
            return octets(random.randint(allowed.low, allowed.high), expected.size(entry))
        return random.randbytes(expected.size(entry))

    def _read(self) -> Lines:
        item = self.random.choice(self.items)
        size = expected.size(item.entry)
        return upload(self.node_id, item.index, item.entry.sub, (size + 6) // 7 if size > 4 else 0)

    def _input(self) -> Lines:
        name = self.random.choice(("digital", "analog0", "analog1"))
        return [f"IN {name} {self.random.randrange(256)}"]

    # ---- PDOs --------------------------------------------------------------------------------------------------------

    def _records(self) -> list[Record]:
        def mappable(entry: Entry, sent: bool) -> bool:
            return entry.mapping.transmittable if sent else entry.mapping.receivable

        found = []
        for obj in self.device.expanded:
            if 0x1400 <= obj.index < 0x1600 or 0x1800 <= obj.index < 0x1A00:
                items = [item for item in self.items if mappable(item.entry, obj.index >= 0x1800)]
                moving = [item for item in items if item.entry.role]
                found.append(Record(obj.index, self.device.max_pdo_entries, (*items, *moving, *moving)))
        return found

    def _configure(self, record: Record, can_id: int) -> Lines:
        """As CiA 301 has it: invalid, emptied, mapped, counted, valid again."""
        random = self.random
        mapping: list[ExpandedEntry] = []
        for item in random.sample(record.mappable, min(len(record.mappable), random.randint(1, record.most))):
            if sum(each.entry.bit_length for each in (*mapping, item)) <= 64:
                mapping.append(item)
        if record.index < 0x1800 and all(item.entry.bit_length % 8 == 0 for item in mapping):
            self.received.append((can_id, mapping))
        cob_id = can_id | NO_REMOTE
        entries = [item.index << 16 | item.entry.sub << 8 | item.entry.bit_length for item in mapping]
        writes = [
            (record.index, 1, cob_id | NOT_VALID, 4),
            (record.index + 0x200, 0, 0, 1),
            *((record.index + 0x200, sub, entry, 4) for sub, entry in enumerate(entries, start=1)),
            (record.index + 0x200, 0, len(entries), 1),
            (record.index, 2, random.choice(random.choice((SYNCHRONOUS, OF_EVENTS))), 1),
            (record.index, 3, random.choice((0, 0, 10, 50)), 2),
            (record.index, 5, random.choice((0, 0, 1, 10)), 2),
            (record.index, 1, cob_id, 4),
        ]
        return [
            line
            for index, sub, value, size in writes
            for line in download(self.node_id, index, sub, octets(value, size))
        ]
