"""SDO transfers of one node in words (CiA 301, 7.2.4.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .decoder import Message, Node

_DOWNLOAD_SEGMENT, _DOWNLOAD, _UPLOAD, _UPLOAD_SEGMENT, _ABORT, _BLOCK_UPLOAD, _BLOCK_DOWNLOAD = range(7)
_ANSWER_UPLOAD_SEGMENT, _ANSWER_DOWNLOAD_SEGMENT, _ANSWER_UPLOAD, _ANSWER_DOWNLOAD = range(4)


class Sdo:
    """The transfer that runs between a client and a node."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._index = 0
        self._sub = 0
        self._octets = b""
        self._runs = False  # segments follow
        self._ends = False  # this was the last segment

    def request(self, data: bytes) -> Message:
        """A frame of the client."""
        if len(data) != 8:
            return self._say(f"request of {len(data)} octets, which a node ignores")
        command = data[0] >> 5
        if command == _DOWNLOAD:
            return self._download(data)
        if command == _UPLOAD:
            self._begin(data)
            return self._say(f"read {self._label}", "read")
        if command == _DOWNLOAD_SEGMENT and self._runs:
            self._segment(data)
            return self._say(f"write {self._label}: {self._progress}", "write")
        if command == _UPLOAD_SEGMENT and self._runs:
            return self._say(f"read on {self._label}", "read")
        if command == _ABORT:
            return self._aborted(data, "the client gives up")
        if command in (_BLOCK_UPLOAD, _BLOCK_DOWNLOAD):
            return self._say("block transfer")
        return self._say(f"no request: {data.hex(' ')}")

    def response(self, data: bytes) -> Message:
        """A frame of the node."""
        if len(data) != 8:
            return self._say(f"answer of {len(data)} octets")
        answer = data[0] >> 5
        if answer == _ANSWER_UPLOAD:
            return self._uploaded(data)
        if answer == _ANSWER_DOWNLOAD:
            if self._runs:
                return self._say(f"ready to take {self._label}", "write")
            return self._written()
        if answer == _ANSWER_UPLOAD_SEGMENT and self._runs:
            self._segment(data)
            return self._value("is") if self._ends else self._say(f"{self._label}: {self._progress}", "read")
        if answer == _ANSWER_DOWNLOAD_SEGMENT and self._runs:
            return self._written() if self._ends else self._say(f"{self._label}: go on", "write")
        if answer == _ABORT:
            return self._aborted(data, "refused")
        return self._say(f"no answer: {data.hex(' ')}")

    # ---- transfers ---------------------------------------------------------------------------------------------------

    def _begin(self, data: bytes) -> None:
        self._index, self._sub = int.from_bytes(data[1:3], "little"), data[3]
        self._octets = b""
        self._runs = self._ends = False

    def _download(self, data: bytes) -> Message:
        self._begin(data)
        if data[0] & 2:
            self._octets = self._expedited(data)
            return self._say(f"write {self._label} = {self._words}", "write", value=self._words)
        self._runs = True
        announced = f", {int.from_bytes(data[4:], 'little')} octets" if data[0] & 1 else ""
        return self._say(f"write {self._label} in segments{announced}", "write")

    def _uploaded(self, data: bytes) -> Message:
        self._begin(data)
        if data[0] & 2:
            self._octets = self._expedited(data)
            return self._value("is")
        self._runs = True
        return self._say(f"{self._label} comes in segments", "read")

    def _expedited(self, data: bytes) -> bytes:
        if data[0] & 1:
            return data[4 : 8 - (data[0] >> 2 & 3)]
        entry = self._node.entry(self._index, self._sub)
        return data[4 : 4 + (entry.bit_length + 7) // 8] if entry else data[4:]

    def _segment(self, data: bytes) -> None:
        self._octets += data[1 : 8 - (data[0] >> 1 & 7)]
        self._ends = bool(data[0] & 1)

    def _written(self) -> Message:
        if self._octets or self._ends:
            self._node.learn(self._index, self._sub, self._octets)
        self._runs = False
        return self._say(f"{self._label} is written", "written")

    def _value(self, verb: str) -> Message:
        self._node.learn(self._index, self._sub, self._octets)
        self._runs = False
        return self._say(f"{self._label} {verb} {self._words}", "value", value=self._words)

    def _aborted(self, data: bytes, who: str) -> Message:
        self._index, self._sub = int.from_bytes(data[1:3], "little"), data[3]
        self._runs = False
        code = int.from_bytes(data[4:], "little")
        info = self._node.package.ABORT_CODES.get(code)
        entry = self._node.entry(self._index, self._sub)
        more = [f"why: {info.why}"] if info and info.used else []
        if entry and entry.allowed and entry.writable:
            more.append(f"allowed: {entry.limits_text}")
        title = info.title if info else "unknown abort code"
        text = f"{who}: {self._label}: {title} ({code:08X}h)"
        return self._say(text, "abort", more=tuple(more), code=code, title=title)

    # ---- words -------------------------------------------------------------------------------------------------------

    @property
    def _label(self) -> str:
        entry = self._node.entry(self._index, self._sub)
        return entry.label if entry else f"{self._index:04X}h:{self._sub:02X} (not in the model)"

    @property
    def _words(self) -> str:
        entry = self._node.entry(self._index, self._sub)
        return self._node.words(entry, self._octets) if entry else self._octets.hex(" ")

    @property
    def _progress(self) -> str:
        if self._ends:
            return f"last segment, {self._words}"
        return f"segment, {len(self._octets)} octets so far"

    def _say(self, text: str, kind: str = "", more: tuple[str, ...] = (), **facts: object) -> Message:
        from .decoder import Message

        about: dict[str, object] = {}
        if kind:
            entry = self._node.entry(self._index, self._sub)
            about = {"kind": kind, "index": self._index, "sub": self._sub}
            about |= {"object": entry.full_name, "axis": entry.axis} if entry else {}
        return Message("SDO", self._node.number, text, more, about | facts)
