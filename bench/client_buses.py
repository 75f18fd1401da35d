"""Buses without hardware on which clients are compared: a server in a function call, and one in another thread."""

from __future__ import annotations

from typing import Any

import can
import canopen

REQUEST, ANSWER = 0x601, 0x581


def answer(request: bytes) -> bytes:
    """What a server with a single 16 bit value says."""
    if request[0] >> 5 == 2:
        return bytes([0x4B, *request[1:4], 0x37, 0x02, 0, 0])
    return bytes([0x60, *request[1:4], 0, 0, 0, 0])


class Echo(canopen.Network):
    """The server in a function call."""

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        self.notify(ANSWER, bytearray(answer(bytes(data))), 0.0)


class Threads(canopen.Network):
    """The server on python-can's virtual interface, in a thread of its own."""

    def __init__(self) -> None:
        super().__init__()
        channel = f"bench {id(self)}"  # one for each: another server would answer too
        self.connect(interface="virtual", channel=channel)
        self._server = can.Bus(interface="virtual", channel=channel)
        self._notifier = can.Notifier(self._server, [self._serve])

    def _serve(self, message: can.Message) -> None:
        if message.arbitration_id == REQUEST:
            data = answer(bytes(message.data))
            self._server.send(can.Message(arbitration_id=ANSWER, data=data, is_extended_id=False))

    def disconnect(self) -> None:
        self._notifier.stop()
        super().disconnect()
        self._server.shutdown()
