"""Frames of a bus in words, by the models of the devices on it.

A decoder goes through a bus or a log from its beginning. It remembers of each node what went by: what was written and
read, so that PDOs are read by the mapping in force, words by the mode, numbers by the unit. What it has not seen is
taken to be as delivered. Which model a node has is told by its identity (1018h), else by the objects that it is asked
for; until then it is the first that fits.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from ..device import can_id
from .log import EXTENDED
from .sdo_words import Sdo
from .words import describe, mapped_entry, set_bits

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

    from ..device.port import Frame
    from ..entries import Entry

SYNC = 0x080
TIME = 0x100
_RESET_COMMUNICATION = 130
_COMMUNICATION = range(0x1000, 0x2000)
_IDENTITY = 0x1018
_PRODUCT_CODE = 2


@dataclass(frozen=True)
class Message:
    """A frame in words. `more` are lines that explain; `facts` are the parts of the text, for machines."""

    service: str
    node: int | None
    text: str
    more: tuple[str, ...] = ()
    facts: dict[str, object] = field(default_factory=dict)


class Carried(NamedTuple):
    """A PDO in force."""

    node: Node
    kind: str
    label: str
    entries: tuple[tuple[Entry[Any] | None, int], ...]  # with their bits


class Node:
    """What is known of a node."""

    def __init__(self, number: int, packages: Sequence[ModuleType]) -> None:
        self.number = number
        self.packages = list(packages)
        self.seen: dict[tuple[int, int], bytes] = {}
        self.resets_communication = False
        self.sdo = Sdo(self)
        self._pdos: dict[int, list[Carried]] | None = None

    @property
    def package(self) -> ModuleType:
        return self.packages[0]

    def entry(self, index: int, sub: int) -> Entry[Any] | None:
        """The entry at an address. A model that lacks it is no longer thought of, if another one has it."""
        fitting = [package for package in self.packages if package.DICTIONARY.get(index) is not None]
        if fitting and len(fitting) < len(self.packages):
            self._narrow(fitting)
        found = self.package.DICTIONARY.get(index)
        return found[sub] if found is not None and sub in found else None

    def learn(self, index: int, sub: int, octets: bytes) -> None:
        """An entry has, or had just now, this value."""
        self.seen[index, sub] = octets
        if index in _COMMUNICATION:
            self._pdos = None
        if (index, sub) == (_IDENTITY, _PRODUCT_CODE):
            product = int.from_bytes(octets, "little")
            fitting = [package for package in self.packages if package.IDENTITY.product_code == product]
            if fitting:
                self._narrow(fitting)

    def forget(self) -> None:
        """It was reset."""
        if self.resets_communication:
            self.seen = {place: octets for place, octets in self.seen.items() if place[0] not in _COMMUNICATION}
        else:
            self.seen.clear()
        self.resets_communication = False
        self._pdos = None
        self.sdo = Sdo(self)

    def known(self, name: str, axis: int | None) -> int | None:
        """The number in the object of a name, if it was seen."""
        dictionary = self.package.DICTIONARY
        found = dictionary.get(name)
        if found is None:
            return None
        index = dictionary.at(found.base_index, axis if dictionary.object_rows[found.base_index][4] else None).index
        octets = self.seen.get((index, 0))
        return None if octets is None else int(found[0].decode(octets))

    def words(self, entry: Entry[Any], octets: bytes) -> str:
        return describe(self.package, entry, octets, self.known)

    def pdos(self, identifier: int) -> list[Carried]:
        """The PDOs that a CAN-ID carries."""
        if self._pdos is None:
            self._pdos = {}
            for pdo in self.package.DICTIONARY.pdos:
                number = self._number(pdo.communication[1])
                if not number & can_id.INVALID:
                    carried = Carried(self, pdo.kind, _label(pdo.kind, pdo.communication.index), self._mapping(pdo))
                    self._pdos.setdefault(number & can_id.MASK, []).append(carried)
        return self._pdos.get(identifier, [])

    def _mapping(self, pdo: Any) -> tuple[tuple[Entry[Any] | None, int], ...]:
        count = self._number(pdo.mapping[0])
        mapped = [self._number(pdo.mapping[sub]) for sub in range(1, count + 1) if sub in pdo.mapping]
        return tuple((mapped_entry(self.package, number), number & 0xFF) for number in mapped)

    def _number(self, entry: Entry[Any]) -> int:
        octets = self.seen.get((entry.index, entry.sub))
        return int(entry.initial(self.number) if octets is None else entry.decode(octets))

    def _narrow(self, packages: list[ModuleType]) -> None:
        if packages != self.packages:
            self.packages = packages
            self._pdos = None


class Decoder:
    """`packages` are the generated packages of the devices that may be on the bus, one at least."""

    def __init__(self, packages: Sequence[ModuleType]) -> None:
        self._packages = packages
        self.nodes: dict[int, Node] = {}

    def decode(self, frame: Frame) -> Message:
        identifier, low = frame.id, frame.id & 0x7F
        if identifier & EXTENDED:
            return Message("29 bit", None, "no frame of CANopen")
        if identifier == can_id.NMT:
            return self._nmt(frame)
        if identifier == SYNC:
            return Message("SYNC", None, f"counter {frame.data[0]}" if frame.data else "")
        if identifier == TIME:
            return Message("TIME", None, frame.data.hex(" "))
        if low and identifier & ~0x7F == can_id.ERROR_CONTROL:
            return self._error_control(self.node(low), frame)
        if low and identifier & ~0x7F == can_id.SDO_ANSWER and not frame.remote:
            return self.node(low).sdo.response(frame.data)
        if low and identifier & ~0x7F == can_id.SDO_REQUEST and not frame.remote:
            return self.node(low).sdo.request(frame.data)
        if low and identifier & ~0x7F == SYNC and not frame.remote:
            return self._emergency(self.node(low), frame)
        return self._pdo(frame)

    def node(self, number: int) -> Node:
        if number not in self.nodes:
            self.nodes[number] = Node(number, self._packages)
        return self.nodes[number]

    # ---- services ----------------------------------------------------------------------------------------------------

    def _nmt(self, frame: Frame) -> Message:
        if len(frame.data) != 2:
            return Message("NMT", None, f"{len(frame.data)} octets, which is no command")
        code, number = frame.data
        info = self._packages[0].NMT_COMMANDS.get(code)
        for node in [*self.nodes.values()] if number == 0 else [self.node(number)] if number <= can_id.NODE_IDS else []:
            node.resets_communication = code == _RESET_COMMUNICATION
        text = info.title if info else f"unknown command {code:02X}h"
        return Message("NMT", number or None, text + ("" if number else ", all nodes"), facts={"command": text})

    def _error_control(self, node: Node, frame: Frame) -> Message:
        if frame.remote:
            return Message("guarding", node.number, "request")
        if len(frame.data) != 1:
            return Message("heartbeat", node.number, f"{len(frame.data)} octets instead of one")
        code = frame.data[0] & 0x7F
        if not frame.data[0]:
            node.forget()
            return Message("boot-up", node.number, "it is there, and pre-operational", facts={"state": "boot-up"})
        info = node.package.NMT_STATES.get(code)
        title = info.title if info else f"unknown state {code:02X}h"
        return Message("heartbeat", node.number, title, facts={"state": title})

    def _emergency(self, node: Node, frame: Frame) -> Message:
        if len(frame.data) != 8:
            return Message("EMCY", node.number, f"{len(frame.data)} octets instead of 8")
        code = int.from_bytes(frame.data[:2], "little")
        row = node.package.EMERGENCIES.find(code, frame.data[3:])
        register = node.entry(0x1001, 0)
        bits = ", ".join(set_bits(register.bits(frame.data[2]))) if register and register.bits else ""
        facts: dict[str, object] = {"code": code, "register": frame.data[2]}
        if row is None:
            text = f"{code:04X}h, which the model does not have: {frame.data[3:].hex(' ')}"
            return Message("EMCY", node.number, text, facts=facts)
        where = "" if row.axis is None else f" of axis {row.axis}"
        text = f"{code:04X}h {row.title}{where}" + (f" (error register: {bits})" if bits else "")
        more = tuple(f"{label}: {words}" for label, words in (("cause", row.cause), ("remedy", row.remedy)) if words)
        facts |= {"name": row.name, "axis": row.axis, "title": row.title, "cause": row.cause, "remedy": row.remedy}
        return Message("EMCY", node.number, text, more, facts)

    def _pdo(self, frame: Frame) -> Message:
        carried = [item for node in self.nodes.values() for item in node.pdos(frame.id)]
        if not carried and frame.id & 0x7F:
            carried = self.node(frame.id & 0x7F).pdos(frame.id)
        if not carried:
            return Message("unknown", None, f"nobody is known to send or to want {frame.id:03X}h")
        first = carried[0]
        if frame.remote:
            return Message(first.label, first.node.number, "remote request")
        texts = [_carry(item, frame.data) for item in carried]
        number = first.node.number if len(carried) == 1 else None
        prefix = [f"node {item.node.number} {item.label}: " if number is None else "" for item in carried]
        text = " | ".join(before + text for before, (text, _) in zip(prefix, texts, strict=True))
        facts = {name: value for _, values in texts for name, value in values.items()}
        return Message(first.label if number else "PDO", number, text, facts=facts)


def _label(kind: str, index: int) -> str:
    return f"{kind.upper()} {(index & 0x1FF) + 1}"


def _carry(pdo: Carried, data: bytes) -> tuple[str, dict[str, object]]:
    """What a PDO brings, in words and as facts; its node learns it."""
    wanted = sum(bits for _, bits in pdo.entries)
    if wanted > 8 * len(data):
        return f"{len(data)} octets, which are too few for {wanted} bits", {}
    parts: list[str] = []
    facts: dict[str, object] = {}
    rest = int.from_bytes(data, "little")
    for entry, bits in pdo.entries:
        octets = (rest & ((1 << bits) - 1)).to_bytes((bits + 7) // 8, "little")
        rest >>= bits
        if entry is None:
            parts.append(f"{bits} bits of nothing known")
            continue
        words = pdo.node.words(entry, octets)
        pdo.node.learn(entry.index, entry.sub, octets)
        parts.append(f"{entry.label} = {words}")
        facts[entry.label] = words
    return ", ".join(parts) or "nothing is mapped", facts
