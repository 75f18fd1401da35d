"""Who is on a bus: every node that answers or is heard, the model that it matches, and where it differs from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import AbortCode

from ..device import can_id
from ..device.port import Frame
from .words import describe

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import ModuleType

    from ..entries import Entry
    from .transport import Transport

ANSWER_S = 0.3
"""How long a node may take for its answer."""

LISTEN_S = 1.2
"""How long to listen for heartbeats of nodes that do not answer."""

_BURST = 8  # requests at once, so that no queue runs over
_DEVICE_TYPE = (0x1000, 0)
_NAMED = ((0x1008, 0), (0x1009, 0), (0x100A, 0))  # device name, hardware and software version
_IDENTITY = tuple((0x1018, sub) for sub in (1, 2, 3, 4))
_NO_ANSWER = None

Answer = bytes | AbortCode | int | None
"""An entry's octets, the abort code that came instead, or None if nothing came."""


@dataclass
class Found:
    """A node. `state` is the NMT state by title if it was heard; `differences` are sentences."""

    node_id: int
    state: str = ""
    device_type: int | None = None
    vendor_id: int | None = None
    product_code: int | None = None
    revision_number: int | None = None
    serial_number: int | None = None
    name: str = ""
    hardware: str = ""
    software: str = ""
    model: str = ""
    differences: list[str] = field(default_factory=list)
    compared: int = 0


def scan(
    transport: Transport,
    packages: Sequence[ModuleType],
    *,
    nodes: Sequence[int] = range(1, can_id.NODE_IDS + 1),
    answer_s: float = ANSWER_S,
    listen_s: float = LISTEN_S,
    deep: bool = False,
) -> list[Found]:
    """Find the nodes of a bus. With `deep` every entry that a matching model has is read and compared.

    Sends nothing but requests to read. Raises OSError where the bus fails.
    """
    scanner = _Scanner(transport, packages, answer_s)
    answering = scanner.call(nodes)
    scanner.listen(0 if answering else listen_s)
    found = []
    for node in sorted({*answering, *scanner.heard} & {*nodes}):
        found.append(scanner.identify(node, deep=deep))
    return found


class _Scanner:
    def __init__(self, transport: Transport, packages: Sequence[ModuleType], answer_s: float) -> None:
        self._transport = transport
        self._packages = packages
        self._answer_s = answer_s
        self.heard: dict[int, int] = {}  # by node, its NMT state

    # ---- finding -----------------------------------------------------------------------------------------------------

    def call(self, nodes: Sequence[int]) -> set[int]:
        """The nodes that answer a request, whatever they answer."""
        answering = set()
        for first in range(0, len(nodes), _BURST):
            asked = set(nodes[first : first + _BURST])
            for node in sorted(asked):
                self._transport.send(_request(node, *_DEVICE_TYPE))
            for frame in self._frames(self._answer_s):
                if frame.id - can_id.SDO_ANSWER in asked:
                    answering.add(frame.id - can_id.SDO_ANSWER)
                if asked <= answering:
                    break
        return answering

    def listen(self, seconds: float) -> None:
        for _ in self._frames(seconds):
            pass

    def identify(self, node: int, *, deep: bool) -> Found:
        found = Found(node)
        found.device_type = self._number(node, *_DEVICE_TYPE)
        names = ("vendor_id", "product_code", "revision_number", "serial_number")
        for name, place in zip(names, _IDENTITY, strict=True):
            setattr(found, name, self._number(node, *place) if found.device_type is not None else None)
        for name, place in zip(("name", "hardware", "software"), _NAMED, strict=True):
            octets = self._read(node, *place) if found.device_type is not None else None
            setattr(found, name, octets.decode("ascii", "replace").strip("\0 ") if isinstance(octets, bytes) else "")
        package = self._matching(found)
        states = self._packages[0].NMT_STATES if self._packages else {}
        found.state = states[self.heard[node]].title if self.heard.get(node) in states else ""
        if package is None:
            if found.device_type is None:
                found.differences.append("it sends heartbeats, and answers no SDO request")
            return found
        found.model = package.IDENTITY.name
        self._compare_identity(found, package)
        if deep:
            self._compare_dictionary(found, package)
        return found

    def _matching(self, found: Found) -> ModuleType | None:
        """The model of the same vendor and product; of several the one with the same revision."""
        same = [
            package
            for package in self._packages
            if (package.IDENTITY.vendor_id, package.IDENTITY.product_code) == (found.vendor_id, found.product_code)
        ]
        return min(same, key=lambda item: item.IDENTITY.revision_number != found.revision_number, default=None)

    # ---- comparing ---------------------------------------------------------------------------------------------------

    def _compare_identity(self, found: Found, package: ModuleType) -> None:
        wanted = package.IDENTITY.revision_number
        if found.revision_number != wanted:
            has = "none" if found.revision_number is None else f"{found.revision_number:08X}h"
            found.differences.append(f"the revision number is {has}, the model's {wanted:08X}h")
        for place, value in ((_DEVICE_TYPE, found.device_type), (_NAMED[0], found.name)):
            entry = _entry(package, *place)
            default = entry.default(found.node_id) if entry else None
            if entry and default is not None and default != value:
                found.differences.append(f"{entry.label} is {value!r}, in the model {default!r}")

    def _compare_dictionary(self, found: Found, package: ModuleType) -> None:
        for item in package.DICTIONARY.values():
            for entry in item:
                if entry.readable:
                    self._compare(found, package, entry)

    def _compare(self, found: Found, package: ModuleType, entry: Entry[Any]) -> None:
        answer = self._read(found.node_id, entry.index, entry.sub)
        found.compared += 1
        if answer is None:
            found.differences.append(f"{entry.label} does not answer")
        elif isinstance(answer, int):
            if answer in (AbortCode.NO_OBJECT, AbortCode.NO_SUB_INDEX):
                found.differences.append(f"{entry.label} is missing")
            elif answer not in (AbortCode.DEVICE_STATE, AbortCode.NO_DATA):
                info = package.ABORT_CODES.get(int(answer))
                found.differences.append(f"{entry.label}: {info.title if info else f'{int(answer):08X}h'}")
        elif entry.bit_length and entry.type != "VISIBLE_STRING" and 8 * len(answer) != max(8, entry.bit_length):
            found.differences.append(f"{entry.label} has {len(answer)} octets, in the model {entry.bit_length // 8}")
        elif entry.constant and (default := entry.default(found.node_id)) not in (None, entry.decode(answer)):
            words = describe(package, entry, answer, lambda name, axis: None)
            found.differences.append(f"{entry.label} is {words}, in the model {default!r}")

    # ---- asking ------------------------------------------------------------------------------------------------------

    def _number(self, node: int, index: int, sub: int) -> int | None:
        octets = self._read(node, index, sub)
        return int.from_bytes(octets, "little") if isinstance(octets, bytes) else None

    def _read(self, node: int, index: int, sub: int) -> Answer:
        """Upload an entry (CiA 301, 7.2.4.3.5)."""
        answer = self._ask(node, _request(node, index, sub))
        if answer is _NO_ANSWER:
            return None
        if answer[0] >> 5 == 4:
            return int.from_bytes(answer[4:], "little")
        if answer[0] & 2:
            return answer[4 : 8 - (answer[0] >> 2 & 3)] if answer[0] & 1 else answer[4:]
        octets, toggle = b"", 0
        while True:
            answer = self._ask(node, Frame(can_id.SDO_REQUEST + node, bytes([0x60 | toggle << 4, *bytes(7)])))
            if answer is _NO_ANSWER:
                return None
            if answer[0] >> 5:
                return int.from_bytes(answer[4:], "little")
            octets += answer[1 : 8 - (answer[0] >> 1 & 7)]
            if answer[0] & 1:
                return octets
            toggle ^= 1

    def _ask(self, node: int, request: Frame) -> bytes | None:
        self._transport.send(request)
        for frame in self._frames(self._answer_s):
            if frame.id == can_id.SDO_ANSWER + node and len(frame.data) == 8:
                return frame.data
        return None

    def _frames(self, seconds: float) -> Iterator[Frame]:
        """What comes for so long. Heartbeats on the way are noted."""
        end = self._transport.now() + seconds
        while (left := end - self._transport.now()) > 0:
            frame = self._transport.receive(left)
            if frame is None:
                continue
            node = frame.id - can_id.ERROR_CONTROL
            if 0 < node <= can_id.NODE_IDS and len(frame.data) == 1 and not frame.remote:
                self.heard[node] = frame.data[0] & 0x7F
            yield frame


def _request(node: int, index: int, sub: int) -> Frame:
    return Frame(can_id.SDO_REQUEST + node, bytes([0x40, index & 0xFF, index >> 8, sub, 0, 0, 0, 0]))


def _entry(package: ModuleType, index: int, sub: int) -> Entry[Any] | None:
    found = package.DICTIONARY.get(index)
    return found[sub] if found is not None and sub in found else None
