"""The SDO server: expedited and segmented transfers (CiA 301, 7.2.4); the twin of `ods_sdo.c`."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode

from . import access, can_id
from .od import Cell
from .port import Frame

if TYPE_CHECKING:
    from .node import Node

# Command specifiers of the client, the upper three bits of the first octet (CiA 301, 7.2.4.3).
_DOWNLOAD_SEGMENT, _DOWNLOAD, _UPLOAD, _UPLOAD_SEGMENT, _ABORT = range(5)

_SERVER_DOWNLOAD = 0x60
_SERVER_DOWNLOAD_SEGMENT = 0x20
_SERVER_UPLOAD = 0x40
_SERVER_UPLOAD_SEGMENT = 0x00
_ABORT_TRANSFER = 0x80

_SIZED = 0x01  # of an initiate: the size is told
_EXPEDITED = 0x02  # of an initiate: the data is in this frame
_TOGGLE = 0x10  # of a segment
_LAST = 0x01  # of a segment: no more follow

_SEGMENT = 7  # octets of data in a segment
_TIME_OUT_US = 1_000_000


class Phase(Enum):
    IDLE = 0
    UPLOAD = 1
    DOWNLOAD = 2


class Sdo:
    def __init__(self, node: Node) -> None:
        self._node = node
        self.phase = Phase.IDLE
        self._cell: Cell | None = None
        self._address = b"\0\0\0"  # index and sub-index of the last transfer, as in a frame
        self._data = b""  # of an upload all of it, of a download what has come so far
        self._done = 0
        self._length = 0  # octets in all; of a download whose size is not told the most that fit
        self._sized = False
        self._toggle = 0

    def receive(self, frame: Frame) -> None:
        """A frame to the server."""
        if len(frame.data) != 8:
            return
        specifier = frame.data[0] >> 5
        address = frame.data[1:4]
        if specifier in (_UPLOAD, _DOWNLOAD):
            self.abandon()
            cell = self._node.od.find(int.from_bytes(address[:2], "little"), address[2])
            if not isinstance(cell, Cell):
                self._abort(address, cell)
            elif specifier == _UPLOAD:
                self._upload(address, cell)
            else:
                self._download(address, cell, frame.data)
        elif specifier == _UPLOAD_SEGMENT:
            self._segment(frame.data, Phase.UPLOAD)
        elif specifier == _DOWNLOAD_SEGMENT:
            self._segment(frame.data, Phase.DOWNLOAD)
        elif specifier == _ABORT:
            self.abandon()
        else:
            self._abort(address, AbortCode.COMMAND)

    def time_out(self) -> None:
        """Give a silent client up, if it is time to."""
        if self._node.timers.is_due("sdo"):
            self._abort(self._address, AbortCode.TIMEOUT)

    def abandon(self) -> None:
        """End a transfer without a word: on a reset and in STOPPED."""
        self.phase = Phase.IDLE
        self._node.timers.stop("sdo")

    # ---- answers ---------------------------------------------------------------------------------------------------

    def _answer(self, data: bytes) -> None:
        self._node.send(Frame(can_id.SDO_ANSWER + self._node.id, data.ljust(8, b"\0")))

    def _answer_initiate(self, command: int, address: bytes, data: bytes = b"") -> None:
        self._answer(bytes([command]) + address + data)

    def _abort(self, address: bytes, code: int) -> None:
        """Refuse a request. Whatever transfer goes on ends with it."""
        self.abandon()
        self._answer_initiate(_ABORT_TRANSFER, address, code.to_bytes(4, "little"))

    def _begin(self, address: bytes, cell: Cell, phase: Phase, length: int) -> None:
        self.phase = phase
        self._cell = cell
        self._address = address
        self._data = b""
        self._done = 0
        self._length = length
        self._toggle = 0
        self._node.timers.start("sdo", _TIME_OUT_US)

    def _segment(self, data: bytes, phase: Phase) -> None:
        if self.phase is not phase:
            self._abort(self._address, AbortCode.COMMAND)
        elif data[0] & _TOGGLE != self._toggle:
            self._abort(self._address, AbortCode.TOGGLE_BIT)
        elif phase is Phase.UPLOAD:
            self._upload_segment()
        else:
            self._download_segment(data)

    # ---- upload ----------------------------------------------------------------------------------------------------

    def _upload(self, address: bytes, cell: Cell) -> None:
        abort = access.readable(self._node, cell)
        if abort:
            self._abort(address, abort)
            return
        octets = cell.octets
        if 0 < len(octets) <= 4:
            self._answer_initiate(_SERVER_UPLOAD | _EXPEDITED | _SIZED | (4 - len(octets)) << 2, address, octets)
            return
        self._begin(address, cell, Phase.UPLOAD, len(octets))
        self._data = octets
        self._answer_initiate(_SERVER_UPLOAD | _SIZED, address, len(octets).to_bytes(4, "little"))

    def _upload_segment(self) -> None:
        part = self._data[self._done : self._done + _SEGMENT]
        command = _SERVER_UPLOAD_SEGMENT | self._toggle | (_SEGMENT - len(part)) << 1
        if self._done + len(part) == self._length:
            command |= _LAST
            self.abandon()
        else:
            self._done += len(part)
            self._toggle ^= _TOGGLE
            self._node.timers.start("sdo", _TIME_OUT_US)
        self._answer(bytes([command]) + part)

    # ---- download --------------------------------------------------------------------------------------------------

    def _download(self, address: bytes, cell: Cell, data: bytes) -> None:
        if not cell.entry.writable:
            self._abort(address, AbortCode.READ_ONLY)
            return
        if data[0] & _EXPEDITED:
            # Without a size the type says how much of the frame is meant.
            length = 4 - (data[0] >> 2 & 3) if data[0] & _SIZED else min(cell.size, 4)
            abort = access.check_length(cell, length) or access.write(self._node, cell, data[4 : 4 + length])
        else:
            length = int.from_bytes(data[4:], "little") if data[0] & _SIZED else cell.size
            abort = access.check_length(cell, length)
            if not abort:
                self._begin(address, cell, Phase.DOWNLOAD, length)
                self._sized = bool(data[0] & _SIZED)
        if abort:
            self._abort(address, abort)
        else:
            self._answer_initiate(_SERVER_DOWNLOAD, address)

    def _download_segment(self, data: bytes) -> None:
        part = data[1 : 1 + _SEGMENT - (data[0] >> 1 & 7)]
        toggle = self._toggle
        if len(self._data) + len(part) > self._length:
            self._abort(self._address, AbortCode.TOO_LONG)
            return
        self._data += part
        self._toggle ^= _TOGGLE
        if not data[0] & _LAST:
            self._node.timers.start("sdo", _TIME_OUT_US)
        else:
            abort = self._finish_download()
            if abort:
                self._abort(self._address, abort)
                return
            self.abandon()
        self._answer(bytes([_SERVER_DOWNLOAD_SEGMENT | toggle]))

    def _finish_download(self) -> int:
        """The last segment is in: the value is complete."""
        assert self._cell is not None
        abort = access.check_length(self._cell, len(self._data))
        if self._sized and len(self._data) != self._length:
            abort = AbortCode.TOO_SHORT
        return abort or access.write(self._node, self._cell, self._data)
