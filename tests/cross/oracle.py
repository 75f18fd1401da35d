"""What a device must answer to SDO requests, worked out from its model and the contract alone.

A third opinion beside the two runtimes, with which it shares no code, so that a mistake which both make does not pass.
It knows the values written so far, what was saved, the NMT state, the running transfer and what axis.py says of the
axes. Comments quote the section of CONTRACT.md, or the effect of writing in the specification, that a rule stands in.

A `Dialogue` is a list of lines for testees together with what this judge expects of each. Where an axis moves, it says
nothing of values that follow the motion, and ends by reset node what the motion decides: axis.py says what that is.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

from tests.cross.axis import FAULTS, Astray, Axis

from odsmith.canopen_types import DataType
from odsmith.model import Device, Emergency, Entry, ExpandedEntry, ExpandedObject

Address = tuple[int, int]
"""Index and sub-index."""

RESTRICTED = ((0x000, 0x07F), (0x101, 0x180), (0x581, 0x5FF), (0x601, 0x67F), (0x6E0, 0x7FF))
"""CAN-IDs that no COB-ID may name (CiA 301, 7.3.5)."""

TIME_OUT_US = 1_000_000

TICK_US = 1000

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130


class Refused(Exception):  # noqa: N818  (an answer, not an error)
    """A request that is answered with the abort code of this name."""


@dataclass(frozen=True)
class Item:
    """An entry at its address. `owner` is the axis that it belongs to, None for the module, PDOs included."""

    object: ExpandedObject
    expanded: ExpandedEntry

    @property
    def entry(self) -> Entry:
        return self.expanded.entry

    @property
    def address(self) -> Address:
        return self.expanded.index, self.entry.sub

    @property
    def owner(self) -> int | None:
        return self.expanded.axis if self.object.object.scope == "axis" else None

    @property
    def size(self) -> int:
        """Octets on the bus; of a text the most."""
        return (self.entry.bit_length + 7) // 8


@dataclass
class Transfer:
    """A segmented transfer; `data` is what is still to be sent, `unknown` its bits that nobody knows; or what has come
    so far."""

    item: Item
    upload: bool
    data: bytes = b""
    unknown: bytes = b""
    room: int = 0
    told: bool = False
    toggle: int = 0
    left: int = TIME_OUT_US


@dataclass
class Oracle:
    """One node. `node_id` 0 leaves the choice to the specification; `now_id` is the node-ID in force.

    Methods that obey an event raise Astray where what comes next depends on a motion; only reset node and power-on lead
    out of that. `unknown` are the bits that nobody knows of the last answer.
    """

    device: Device
    node_id: int = 0
    serial: int = 0
    nmt: str = "off"
    now_id: int = 0
    memory_fails: bool = False
    os_answer: tuple[int, bytes] = (2, b"")
    values: dict[Address, bytes] = field(default_factory=dict)
    saved: dict[tuple[int | None, str], dict[Address, bytes]] = field(default_factory=dict)
    transfer: Transfer | None = None
    last: Address = (0, 0)
    unknown: bytes = bytes(8)
    now: int = 0  # microseconds since power-on
    is_enabled: bool = True  # the enable input
    conditions: frozenset[str] = frozenset()  # of the whole device
    next_nmt: str = ""  # where an error leads at the end of the turn

    def __post_init__(self) -> None:
        self.items: dict[Address, Item] = {}
        self.places: dict[str, list[Item]] = {}
        self.axes = [Axis(self.device, self, number) for number in range(self.device.axes)]
        self.parts: dict[tuple[int, str], Item] = {}  # of axes, by their roles
        self.codes = {abort.name: abort.code for abort in self.device.abort_codes}
        for obj in self.device.expanded:
            for expanded in obj.entries:
                item = Item(obj, expanded)
                self.items[item.address] = item
                self.places.setdefault(expanded.entry.role, []).append(item)
                if item.owner is not None:
                    self.parts[item.owner, item.entry.role] = item
        self.indices = {index for index, _ in self.items}
        # an entry of a PDO finds the others by what they are: its COB-ID, its mapping
        self.pdos: dict[tuple[int, int], dict[str, list[Item]]] = {}
        for item in self.items.values():
            if item.object.object.pdo:
                self.pdos.setdefault(item.object.instance, {}).setdefault(item.entry.role, []).append(item)

    # ---- NMT and time ------------------------------------------------------------------------------------------------

    def power_on(self) -> None:
        self.last = (0, 0)
        self.now = 0
        self.is_enabled = True
        for axis in self.axes:
            axis.faults, axis.has_run = frozenset(), False
        self.reset(communication_only=False)

    def command(self, code: int) -> None:
        """An NMT command to this node."""
        if code in (RESET_NODE, RESET_COMMUNICATION):
            self.reset(communication_only=code == RESET_COMMUNICATION)
        else:
            self.enter({START: "operational", STOP: "stopped"}.get(code, "pre_operational"))

    def enter(self, state: str) -> None:
        was, self.nmt = self.nmt, state
        if state == "stopped" != was:
            self.transfer = None
            for axis in self.axes:
                axis.network_stopped()

    def reset(self, *, communication_only: bool) -> None:
        """Stored or default values (contract, "NMT and error control"); what cannot be read is not in force."""
        self.nmt, self.next_nmt, self.transfer = "pre_operational", "", None
        saved = (
            {} if self.memory_fails else {at: octets for group in self.saved.values() for at, octets in group.items()}
        )
        if not communication_only:
            self.now_id = self._stored("node_id", saved, self.node_id or self._default_of("node_id") or 1)
            self.conditions = frozenset()
            for axis in self.axes:
                axis.reset()
        for at, item in self.items.items():
            if not communication_only or 0x1000 <= at[0] < 0x2000:
                self.values[at] = saved.get(at, self._default(item, saved))
        self.show_conditions()

    def advance(self, us: int) -> bytes | None:
        """Time passes: 1 s without a segment ends a transfer, before the tick of that instant."""
        end, limit = self.now + us, self.transfer.left if self.transfer else us + 1
        self.tick((self.now + min(limit - 1, us)) // TICK_US)
        sent = None
        if self.transfer:
            self.transfer.left -= us
            sent = self._abort(self.transfer.item.address, "timeout") if self.transfer.left <= 0 else None
        self.tick(end // TICK_US)
        self.now = end
        return sent

    def tick(self, last: int) -> None:
        """All ticks since power-on up to this one; those after which nothing changes any more are all alike."""
        before = None
        for tick in range(self.now // TICK_US + 1, last + 1):
            self.now = tick * TICK_US
            self._sample()
            for axis in self.axes:
                axis.tick()
            self.show_conditions()
            self._follow_error()
            after = [vars(axis).copy() for axis in self.axes], self.nmt
            if after == before:
                break
            before = after
        self.now = max(self.now, last * TICK_US)

    def _sample(self) -> None:
        """The enable input, which all axes have in common."""
        before, self.conditions = self.conditions, frozenset(() if self.is_enabled else ("shutdown_switch",))
        for row in self.device.emergencies:
            if row.condition in self.conditions - before and row.reaction in FAULTS:
                for axis in self.axes:
                    axis.fault(off=row.reaction == "fault_off")

    def raised(self, row: Emergency) -> None:
        """1029h:02 says where a fault of an axis leads, from OPERATIONAL only (contract, "NMT and error control")."""
        places = self.places.get("error_behaviour", [])
        if row.reaction in FAULTS and self.nmt == "operational" and len(places) > 1:
            state = self.device.error_behaviour.get(self._number(places[1]))
            self.next_nmt = state.name if state else self.next_nmt

    def _follow_error(self) -> None:
        if self.next_nmt:
            state, self.next_nmt = self.next_nmt, ""
            self.enter(state)

    def show_conditions(self) -> None:
        """1001h."""
        self._set("error_register", bytes([self._register(self.conditions.union(*(a.conditions for a in self.axes)))]))

    def _register(self, conditions: frozenset[str]) -> int:
        bits = self.device.register_bits
        rows = (row for row in self.device.emergencies if not row.momentary and row.condition in conditions)
        return sum({1 << bits[name].bit for row in rows for name in row.register})

    # ---- what axes ask for -------------------------------------------------------------------------------------------

    def get(self, axis: int, role: str) -> int:
        item = self.parts.get((axis, role))
        if item is None:
            return 0
        return int.from_bytes(self.values[item.address], "little", signed=item.entry.type.signed)

    def put(self, axis: int, role: str, value: int) -> None:
        item = self.parts.get((axis, role))
        if item is not None:
            self.values[item.address] = value.to_bytes(item.size, "little", signed=value < 0)

    # ---- defaults ----------------------------------------------------------------------------------------------------

    def _default(self, item: Item, saved: dict[Address, bytes]) -> bytes:
        entry, default = item.entry, item.expanded.default
        known = {
            "serial_number": self.serial or self._default_of("serial_number"),
            "node_id": self.node_id or self._default_of("node_id"),  # the configuration gives it
            "node_id_load": self.now_id,
            "can_bit_rate_load": self._stored("can_bit_rate", saved, self._default_of("can_bit_rate")),
        }
        if entry.role in known:
            return known[entry.role].to_bytes(item.size, "little")
        value = default.value(self.now_id) if default else "" if entry.type is DataType.VISIBLE_STRING else 0
        if isinstance(value, str):
            return value.encode()
        return value.to_bytes(item.size, "little", signed=value < 0)

    def _default_of(self, role: str) -> int:
        default = self.places[role][0].expanded.default if role in self.places else None
        return default.number if default else 0

    def _stored(self, role: str, saved: dict[Address, bytes], default: int) -> int:
        octets = saved.get(self.places[role][0].address) if role in self.places else None
        return int.from_bytes(octets, "little") if octets else default

    # ---- the server (contract, "SDO") --------------------------------------------------------------------------------

    def answer(self, frame: bytes) -> bytes | None:
        """What comes back for a frame to the server, if anything."""
        self.unknown = bytes(8)
        if len(frame) != 8 or self.nmt == "stopped":
            return None
        command, at = frame[0], (int.from_bytes(frame[1:3], "little"), frame[3])
        try:
            match command >> 5:
                case 0:
                    at = self.last
                    return self._download_segment(command, frame[1:])
                case 1:
                    self.transfer = None
                    return self._download(at, command, frame[4:])
                case 2:
                    self.transfer = None
                    return self._upload(at)
                case 3:
                    at = self.last
                    return self._upload_segment(command)
                case 4:
                    self.transfer = None
                    return None
                case _:
                    raise Refused("command")
        except Refused as refusal:
            return self._abort(at, str(refusal))

    def _abort(self, at: Address, name: str) -> bytes:
        self.transfer = None
        return _frame(0x80, at, self.codes[name].to_bytes(4, "little"))

    def _begin(self, transfer: Transfer) -> None:
        self.transfer, self.last = transfer, transfer.item.address

    def _running(self, command: int, *, upload: bool) -> Transfer:
        """The transfer that a segment belongs to."""
        if self.transfer is None or self.transfer.upload != upload:
            raise Refused("command")
        if command & 0x10 != self.transfer.toggle:
            raise Refused("toggle_bit")
        self.transfer.toggle ^= 0x10
        self.transfer.left = TIME_OUT_US
        return self.transfer

    def _upload(self, at: Address) -> bytes:
        item = self.find(at)
        data, unknown = self.read(item), self.unknown_of(item)
        if 0 < len(data) <= 4:
            self.unknown = bytes(4) + unknown.ljust(4, b"\0")
            return _frame(0x43 | (4 - len(data)) << 2, at, data)
        self._begin(Transfer(item, upload=True, data=data, unknown=unknown))
        return _frame(0x41, at, len(data).to_bytes(4, "little"))

    def _upload_segment(self, command: int) -> bytes:
        transfer = self._running(command, upload=True)
        part, transfer.data = transfer.data[:7], transfer.data[7:]
        unknown, transfer.unknown = transfer.unknown[:7], transfer.unknown[7:]
        self.unknown = bytes(1) + unknown.ljust(7, b"\0")
        if not transfer.data:
            self.transfer = None
        return bytes([command & 0x10 | (7 - len(part)) << 1 | (not transfer.data), *part.ljust(7, b"\0")])

    def _download(self, at: Address, command: int, data: bytes) -> bytes:
        item = self.find(at)
        if not item.entry.access.writable:
            raise Refused("read_only")
        if command & 2:
            # without a size the type says how much of the frame is meant
            part = data[: 4 - (command >> 2 & 3)] if command & 1 else data[: item.size]
            self.check_length(item, len(part))
            self.write(item, part)
        else:
            told = bool(command & 1)
            length = int.from_bytes(data, "little") if told else item.size
            self.check_length(item, length)
            self._begin(Transfer(item, upload=False, room=length, told=told))
        return _frame(0x60, at)

    def _download_segment(self, command: int, data: bytes) -> bytes:
        transfer = self._running(command, upload=False)
        transfer.data += data[: 7 - (command >> 1 & 7)]
        if len(transfer.data) > transfer.room:
            raise Refused("too_long")
        if command & 1:
            if transfer.told and len(transfer.data) < transfer.room:
                raise Refused("too_short")
            self.check_length(transfer.item, len(transfer.data))
            self.write(transfer.item, transfer.data)
            self.transfer = None
        return bytes([0x20 | command & 0x10]).ljust(8, b"\0")

    # ---- checks, in the order of the contract ------------------------------------------------------------------------

    def find(self, at: Address) -> Item:
        if at[0] not in self.indices:
            raise Refused("no_object")
        if at not in self.items:
            raise Refused("no_sub_index")
        return self.items[at]

    def check_length(self, item: Item, length: int) -> None:
        if length > item.size:
            raise Refused("too_long")
        if length < item.size and item.entry.type is not DataType.VISIBLE_STRING:
            raise Refused("too_short")

    def read(self, item: Item) -> bytes:
        if not item.entry.access.readable:
            raise Refused("write_only")
        if self.mode("tmcl_mode") and item.owner is not None:
            raise Refused("device_state")
        if item.owner is not None and item.entry.role == "statusword":
            return self.axes[item.owner].statusword()[0].to_bytes(2, "little")
        return self.values[item.address]

    def unknown_of(self, item: Item) -> bytes:
        """The bits of its value that nobody knows."""
        bits = 0
        if item.owner is not None:
            bits = self.axes[item.owner].unknown(item.entry.role)
        elif item.entry.role == "error_register":
            sure = self.conditions.union(*(axis.conditions for axis in self.axes))
            bits = self._register(sure.union(*(axis.doubtful for axis in self.axes))) & ~self._register(sure)
        return (bits & (1 << 8 * item.size) - 1).to_bytes(item.size, "little")

    def write(self, item: Item, data: bytes) -> None:
        """Access and length are in order: the present state, the value, what its effect refuses; then it counts."""
        entry = item.entry
        self._check_state(item)
        value = int.from_bytes(data, "little", signed=entry.type.signed)
        if entry.type.integer:
            self._check_value(entry, value)
        match entry.effect:
            case "cob_id_sync":
                _require(not value & 0x7FFFF800 and not _is_restricted(value), "invalid_value")
            case "cob_id_emcy":
                _require(not value & 0x3FFFF800, "invalid_value")
                _require(bool(value >> 31) or not _is_restricted(value), "invalid_value")
            case "consumer_heartbeat":
                self._check_consumer(item, value)
            case "pdo_cob_id":
                self._check_pdo_cob_id(item, value)
            case "pdo_mapped_count":
                mapping = [self._number(each) for each in self._pdo(item)["pdo_mapping"]]
                self._check_mapping(item, mapping[:value])
            case "pdo_mapping":
                self._check_mapping_entry(item, value)
            case "store" | "restore":
                self._check_memory(entry)
                self._command_memory(entry)
                return  # the word is not kept
            case "tmcl_mode" | "manufacturer_mode":
                value = int(value == self.device.signatures["make"].value)
                data = value.to_bytes(item.size, "little")
            case "os_command":
                status, reply = self.os_answer
                self._set("os_status", bytes([status]))
                self._set("os_reply", reply.ljust(7, b"\0") if status in (1, 3) else bytes(7))
        self.values[item.address] = data
        if item.owner is not None:
            self.axes[item.owner].written(entry.role)

    def _check_state(self, item: Item) -> None:
        entry, relaxed = item.entry, self.mode("manufacturer_mode")
        forbidden = False
        if item.owner is not None:
            state = self.axes[item.owner].state
            forbidden = self.mode("tmcl_mode") or bool(entry.writable_in and state not in entry.writable_in)
        if entry.effect == "os_command":
            forbidden = not self.mode("tmcl_mode")
        if entry.effect in ("pdo_mapped_count", "pdo_mapping") and not relaxed:
            forbidden = self._is_active(item)
            forbidden |= entry.effect == "pdo_mapping" and self._number(self._pdo(item)["pdo_mapped_count"][0]) != 0
        _require(not forbidden, "device_state")

    @staticmethod
    def _check_value(entry: Entry, value: int) -> None:
        if entry.signatures:
            _require(value in [signature.value for signature in entry.signatures], "not_stored")
        elif entry.allowed and value not in entry.allowed:
            _require(not entry.allowed.listed, "invalid_value")
            raise Refused("value_too_low" if value < entry.allowed.low else "value_too_high")

    def _check_consumer(self, item: Item, value: int) -> None:
        """A node that another entry watches already is refused (effect `consumer_heartbeat`)."""
        others = [self._number(each) for each in self.places["consumer_heartbeat_time"] if each is not item]
        watched = [other >> 16 & 0xFF for other in others if _watches(other)]
        _require(not _watches(value) or value >> 16 & 0xFF not in watched, "parameter_incompatible")

    # ---- PDOs (contract, "PDO and SYNC"; effects `pdo_...`) ----------------------------------------------------------

    def _pdo(self, item: Item) -> dict[str, list[Item]]:
        return self.pdos[item.object.instance]

    def _is_active(self, item: Item) -> bool:
        return not self._number(self._pdo(item)["pdo_cob_id"][0]) >> 31

    def _check_pdo_cob_id(self, item: Item, value: int) -> None:
        _require(not value & 0x3FFFF800, "invalid_value")
        if value >> 31:
            return
        _require(bool(value >> 30 & 1) or self.mode("manufacturer_mode"), "invalid_value")
        _require(not _is_restricted(value), "invalid_value")
        if self._is_active(item):
            _require(value & 0x7FF == self._number(item) & 0x7FF, "invalid_value")

    def _check_mapping_entry(self, item: Item, value: int) -> None:
        """One that is in force, as only manufacturer mode allows, is checked together with the others."""
        count = self._number(self._pdo(item)["pdo_mapped_count"][0])
        if item.entry.repeat < count:
            mapping = [self._number(each) for each in self._pdo(item)["pdo_mapping"]]
            mapping[item.entry.repeat] = value
            self._check_mapping(item, mapping[:count])
        elif value:
            self._check_mapped(item, value)

    def _check_mapping(self, item: Item, mapping: Sequence[int]) -> None:
        for value in mapping:
            self._check_mapped(item, value)
        _require(sum(value & 0xFF for value in mapping) <= 64, "pdo_length")

    def _check_mapped(self, item: Item, value: int) -> None:
        entry = self.find((value >> 16, value >> 8 & 0xFF)).entry
        receives = item.object.object.scope == "rpdo"
        fits = entry.mapping.receivable if receives else entry.mapping.transmittable
        _require(fits and entry.bit_length == value & 0xFF, "not_mappable")

    # ---- storage (contract, "Non-volatile memory"; effects `store` and `restore`) ------------------------------------

    def _check_memory(self, command: Entry) -> None:
        _require(not command.groups or not self.memory_fails, "hardware")

    def _command_memory(self, command: Entry) -> None:
        for item in self.items.values():
            group = item.entry.stored
            if group in command.groups and (not command.per_axis or item.owner == command.repeat):
                values = self.saved.setdefault((item.owner, group), {})
                if command.effect == "store":
                    values[item.address] = self.values[item.address]
                else:
                    values.clear()

    # ---- values ------------------------------------------------------------------------------------------------------

    def mode(self, role: str) -> bool:
        """Whether the module is in TMCL or in manufacturer mode."""
        return role in self.places and self._number(self.places[role][0]) != 0

    def dump(self) -> Iterator[tuple[Address, bytes | int]]:
        """All entries as they can be read: octets or an abort code."""
        for at, item in self.items.items():
            try:
                yield at, self.read(item)
            except Refused as refusal:
                yield at, self.codes[str(refusal)]

    def _number(self, item: Item) -> int:
        return int.from_bytes(self.values[item.address], "little")

    def _set(self, role: str, octets: bytes) -> None:
        for item in self.places.get(role, ()):
            self.values[item.address] = octets


def _require(condition: bool, name: str) -> None:
    if not condition:
        raise Refused(name)


def _is_restricted(cob_id: int) -> bool:
    return any(first <= cob_id & 0x7FF <= last for first, last in RESTRICTED)


def _watches(consumer: int) -> bool:
    return consumer & 0xFFFF != 0 and 1 <= consumer >> 16 & 0xFF <= 127


def _frame(command: int, at: Address, data: bytes = b"") -> bytes:
    return bytes([command, at[0] & 0xFF, at[0] >> 8, at[1], *data.ljust(4, b"\0")])


# ---- lines for testees, with what is expected of them ----------------------------------------------------------------


class Dialogue:
    """Lines for a testee with node-ID `node_id`, from power-on. The answers of the oracle lead it through transfers."""

    def __init__(self, device: Device, node_id: int = 0) -> None:
        self.node_id = node_id
        self.oracle = Oracle(device, node_id)
        self.lines: list[str] = []
        self.expected: list[list[str]] = []
        self.power()

    def say(self, line: str, *expected: str) -> None:
        self.lines.append(line)
        self.expected.append(list(expected))

    def power(self) -> None:
        if self.lines:
            self.say("POWER cut")
        self.say("POWER on")
        self.oracle.power_on()

    def nmt(self, code: int) -> None:
        now_id = self.oracle.now_id
        try:
            self.oracle.command(code)
        except Astray:
            code = RESET_NODE
            self.oracle.command(code)
        self.say(f"RX 000 {code:02X} {now_id:02X}")

    def advance(self, us: int) -> None:
        try:
            sent = self.oracle.advance(us)
        except Astray:
            self.nmt(RESET_NODE)
        else:
            self.say(f"T {us}", *([self._tx(sent)] if sent else []))

    def fault(self, axis: int, condition: str, *, holds: bool) -> None:
        """The hardware reports it."""
        self.say(f"FAULT axis{axis} {condition} {'on' if holds else 'off'}")
        faults = self.oracle.axes[axis].faults
        self.oracle.axes[axis].faults = faults | {condition} if holds else faults - {condition}

    def enable(self, is_enabled: bool) -> None:
        """The enable input."""
        self.say(f"IN enable {is_enabled:d}")
        self.oracle.is_enabled = is_enabled

    def memory(self, *, fails: bool) -> None:
        self.say("NVM fail" if fails else "NVM ok")
        self.oracle.memory_fails = fails

    def callback(self, status: int, reply: bytes) -> None:
        """How OS commands end from now on."""
        self.say(f"OS {status} {_hex(reply)}".rstrip())
        self.oracle.os_answer = (status, reply)

    def sdo(self, frame: bytes) -> bytes:
        """A frame to the server; gives what the oracle answers."""
        line = f"RX {0x600 + self.oracle.now_id:03X} {_hex(frame)}".rstrip()
        try:
            answer = self.oracle.answer(frame)
        except Astray:
            self.nmt(RESET_NODE)
            return b""
        self.say(line, *([self._tx(answer)] if answer else []))
        return answer or b""

    def upload(self, at: Address) -> None:
        """An upload with all its segments."""
        answer = self.sdo(_frame(0x40, at))
        toggle = 0
        while answer and answer[0] != 0x80 and self.oracle.transfer:
            answer = self.sdo(bytes([0x60 | toggle]).ljust(8, b"\0"))
            toggle ^= 0x10

    def download(self, at: Address, data: bytes, *, segmented: bool = False, sized: bool = True) -> None:
        """A download, expedited where it can be and `segmented` does not say otherwise; given up when it is refused."""
        if 0 < len(data) <= 4 and not segmented:
            self.sdo(_frame(0x23 | (4 - len(data)) << 2 if sized else 0x22, at, data))
            return
        self.sdo(_frame(0x21, at, len(data).to_bytes(4, "little")) if sized else _frame(0x20, at))
        toggle = 0
        while self.oracle.transfer:
            part, data = data[:7], data[7:]
            self.sdo(bytes([toggle | (7 - len(part)) << 1 | (not data), *part.ljust(7, b"\0")]))
            toggle ^= 0x10

    def write(self, axis: int, role: str, value: int) -> None:
        """Download a number to an entry of an axis."""
        item = self.oracle.parts[axis, role]
        self.download(item.address, value.to_bytes(item.size, "little", signed=value < 0))

    def dump(self) -> None:
        """Everything as it reads now."""
        self.say("DUMP 0000-FFFF", *(self._od(at, value) for at, value in self.oracle.dump()))

    def _od(self, at: Address, value: bytes | int) -> str:
        if isinstance(value, int):
            text = f"ABORT {value:08X}"
        else:
            text = _hex(value, self.oracle.unknown_of(self.oracle.items[at]))
        return f"OD {at[0]:04X}:{at[1]:02X} {text}".rstrip()

    def played_by(self, program: Path) -> Iterator[list[str]]:
        """What a testee answers to the lines; it gets all of them at once."""
        done = subprocess.run(
            [program, "--node-id", str(self.node_id)],
            input="".join(f"{line}\n" for line in self.lines),
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert done.returncode == 0, done.stderr[:6000]
        answer: list[str] = []
        for line in done.stdout.splitlines():
            answer.append(line)
            if line.startswith(("NEXT ", "NACK ")):
                yield answer
                answer = []

    def difference(self, answers: Iterable[Sequence[str]]) -> str:
        """Where a testee says something else than the oracle: the lines before, and both; nothing if nowhere."""
        for number, (expected, answer) in enumerate(zip(self.expected, answers, strict=True)):
            told = [line for line in answer if _concerns(line)]
            if len(told) != len(expected) or not all(map(_agree, expected, told)):
                pairs = zip_longest(expected, told, fillvalue="nothing")
                differing = [(mine, line) for mine, line in pairs if not _agree(mine, line)]
                odd = [text for mine, line in differing for text in (f"  expected {mine}", f"  told {line}")]
                return "\n".join([*(f"> {line}" for line in self.lines[max(0, number - 12) : number + 1]), *odd[:20]])
        return ""

    def _tx(self, frame: bytes) -> str:
        return f"TX {0x580 + self.oracle.now_id:03X} {_hex(frame, self.oracle.unknown)}"


def _concerns(line: str) -> bool:
    """Whether the oracle has an opinion: answers of the SDO server, whatever its node-ID; entries; refusals."""
    return line.startswith(("OD ", "NACK ")) or (line.startswith("TX ") and 0x580 < int(line[3:6], 16) < 0x600)


def _agree(expected: str, told: str) -> bool:
    return expected == told or ("[" in expected and re.fullmatch(expected, told) is not None)


def _hex(octets: bytes, unknown: bytes = b"") -> str:
    """Octets as the testees tell them; a digit of which not all bits are known is a set of digits."""
    if not any(unknown):
        return octets.hex(" ").upper()
    return " ".join(
        "".join(_digit(octet >> shift & 0xF, bits >> shift & 0xF) for shift in (4, 0))
        for octet, bits in zip(octets, unknown, strict=True)
    )


def _digit(digit: int, unknown: int) -> str:
    digits = "".join(f"{other:X}" for other in range(16) if not (other ^ digit) & ~unknown)
    return digits if len(digits) == 1 else f"[{digits}]"
