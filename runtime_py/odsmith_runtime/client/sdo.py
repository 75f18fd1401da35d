"""The client side of SDO: expedited and segmented transfers, both ways (CiA 301, clause 7.2.4).

One transfer at a time for each node: whoever comes second waits. Answers to older requests are told by their address
and dropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode

from .link import SDO_ANSWER, SDO_REQUEST

if TYPE_CHECKING:
    from .link import Link

_UPLOAD, _UPLOAD_SEGMENT = 0x40, 0x60
_DOWNLOAD, _DOWNLOAD_SEGMENT = 0x20, 0x00
_ABORT = 0x80
_SPECIFIER = 0xE0
_EXPEDITED, _SIZED = 0x02, 0x01
_TOGGLE, _LAST = 0x10, 0x01


class TransferAborted(Exception):  # noqa: N818  # an event of the protocol
    """One side ended the transfer, with an abort code; `here` if that was this side."""

    def __init__(self, code: int, here: bool = False) -> None:
        super().__init__(f"{code:08X}h")
        self.code = code
        self.here = here


class SdoClient:
    """Transfers with one node. `timeout` is the longest time that an answer may take, in seconds."""

    def __init__(self, link: Link, timeout: float) -> None:
        self.timeout = timeout
        self._link = link
        self._lock = link.waiter.lock()
        self._answers: list[bytes] = []
        self.join()

    def join(self) -> None:
        """The link has a new node-ID."""
        self._link.subscribe(SDO_ANSWER + self._link.id, lambda _id, data, _time: self._answers.append(bytes(data)))

    async def upload(self, index: int, sub: int) -> bytes:
        """Read an entry. Raises TransferAborted, with 05040000h from here if there is no answer."""
        async with self._lock:
            address = _address(index, sub)
            answer = await self._ask(bytes([_UPLOAD]) + address + bytes(4), address)
            self._expect(answer, _UPLOAD, address)
            if answer[0] & _EXPEDITED:
                unused = answer[0] >> 2 & 3 if answer[0] & _SIZED else 0
                return answer[4 : 8 - unused]
            data, toggle = bytearray(), 0
            while True:
                answer = await self._ask(bytes([_UPLOAD_SEGMENT | toggle]) + bytes(7), address, segment=True)
                self._expect(answer, 0x00, address, toggle)
                data += answer[1 : 8 - (answer[0] >> 1 & 7)]
                if answer[0] & _LAST:
                    return bytes(data)
                toggle ^= _TOGGLE

    async def download(self, index: int, sub: int, data: bytes) -> None:
        """Write an entry. Raises as `upload`."""
        async with self._lock:
            address = _address(index, sub)
            if 0 < len(data) <= 4:
                command = _DOWNLOAD | (4 - len(data)) << 2 | _EXPEDITED | _SIZED
                answer = await self._ask(bytes([command]) + address + data.ljust(4, b"\0"), address)
                self._expect(answer, 0x60, address)
                return
            length = len(data).to_bytes(4, "little")
            answer = await self._ask(bytes([_DOWNLOAD | _SIZED]) + address + length, address)
            self._expect(answer, 0x60, address)
            toggle = 0
            for start in range(0, max(1, len(data)), 7):
                part = data[start : start + 7]
                last = _LAST if start + 7 >= len(data) else 0
                command = _DOWNLOAD_SEGMENT | toggle | (7 - len(part)) << 1 | last
                answer = await self._ask(bytes([command]) + part.ljust(7, b"\0"), address, segment=True)
                self._expect(answer, 0x20, address, toggle)
                toggle ^= _TOGGLE

    async def _ask(self, request: bytes, address: bytes, segment: bool = False) -> bytes:
        self._answers.clear()
        self._link.send(SDO_REQUEST + self._link.id, request)
        until = self._link.now() + self.timeout
        while await self._link.wait_until(lambda: bool(self._answers), until):
            answer = self._answers.pop(0)
            if len(answer) != 8:
                continue
            if answer[0] == _ABORT and (answer[1:4] == address or segment):
                raise TransferAborted(int.from_bytes(answer[4:], "little"))
            if segment or answer[1:4] == address:
                return answer
        raise self._abort(AbortCode.TIMEOUT, address)

    def _expect(self, answer: bytes, specifier: int, address: bytes, toggle: int = 0) -> None:
        if answer[0] & _SPECIFIER != specifier:
            raise self._abort(AbortCode.COMMAND, address)
        if specifier in (0x00, 0x20) and answer[0] & _TOGGLE != toggle:
            raise self._abort(AbortCode.TOGGLE_BIT, address)

    def _abort(self, code: AbortCode, address: bytes) -> TransferAborted:
        self._link.send(SDO_REQUEST + self._link.id, bytes([_ABORT]) + address + int(code).to_bytes(4, "little"))
        return TransferAborted(int(code), here=True)


def _address(index: int, sub: int) -> bytes:
    return bytes([index & 0xFF, index >> 8, sub])
