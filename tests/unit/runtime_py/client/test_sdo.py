"""Transfers, octet by octet, with a server that the test plays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import canopen
import pytest
from tests.unit.runtime_py.client.faces import Bench

from odsmith_runtime.client.link import Link
from odsmith_runtime.client.sdo import SdoClient, TransferAborted
from odsmith_runtime.client.waiting import BlockingWaiter, run


class Server(canopen.Network):
    """Answers each request with the next answer of a dialogue."""

    def __init__(self, *dialogue: str) -> None:
        super().__init__()
        self.dialogue = [line.split(" > ") for line in dialogue]
        self.unexpected: list[str] = []

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        request = bytes(data).hex()
        if not self.dialogue or self.dialogue[0][0].replace(" ", "") != request:
            self.unexpected.append(request)
            return
        for answer in self.dialogue.pop(0)[1:]:
            self.notify(0x581, bytearray.fromhex(answer), 0.0)


@pytest.fixture
def client() -> Iterator[Callable[..., SdoClient]]:
    """A client and the dialogue that it has to have."""
    servers: list[Server] = []

    def make(*dialogue: str) -> SdoClient:
        servers.append(Server(*dialogue))
        return SdoClient(Link(servers[-1], 1, BlockingWaiter()), timeout=0.0)

    yield make
    for server in servers:
        assert not server.dialogue
        assert not server.unexpected


def test_expedited(client: Callable[..., SdoClient]) -> None:
    sdo = client(
        "40 41 60 00 00 00 00 00 > 4b 41 60 00 50 02 00 00",
        "40 00 10 00 00 00 00 00 > 42 00 10 00 01 02 03 04",
        "2b 40 60 00 0f 00 00 00 > 60 40 60 00 00 00 00 00",
    )
    assert run(sdo.upload(0x6041, 0)) == b"\x50\x02"
    assert run(sdo.upload(0x1000, 0)) == b"\x01\x02\x03\x04"
    run(sdo.download(0x6040, 0, b"\x0f\x00"))


def test_segmented(client: Callable[..., SdoClient]) -> None:
    sdo = client(
        "40 08 10 00 00 00 00 00 > 41 08 10 00 09 00 00 00",
        "60 00 00 00 00 00 00 00 > 00 54 4d 43 4d 2d 36 32",
        "70 00 00 00 00 00 00 00 > 1b 31 32 00 00 00 00 00",
        "21 23 10 01 08 00 00 00 > 60 23 10 01 00 00 00 00",
        "00 61 62 63 64 65 66 67 > 20 00 00 00 00 00 00 00",
        "1d 68 00 00 00 00 00 00 > 30 00 00 00 00 00 00 00",
        "21 23 10 01 00 00 00 00 > 60 23 10 01 00 00 00 00",
        "0f 00 00 00 00 00 00 00 > 20 00 00 00 00 00 00 00",
    )
    assert run(sdo.upload(0x1008, 0)) == b"TMCM-6212"
    run(sdo.download(0x1023, 1, b"abcdefgh"))
    run(sdo.download(0x1023, 1, b""))


def test_an_answer_to_an_older_request_is_dropped(client: Callable[..., SdoClient]) -> None:
    sdo = client(
        "40 41 60 00 00 00 00 00 > 4b 40 60 00 ff ff 00 00 > 80 40 60 00 00 00 02 06 > 4b 41 60 00 01 00 00 00"
    )
    assert run(sdo.upload(0x6041, 0)) == b"\x01\x00"


def test_aborts(client: Callable[..., SdoClient]) -> None:
    sdo = client(
        "40 41 60 00 00 00 00 00 > 80 41 60 00 11 00 09 06",
        "40 08 10 00 00 00 00 00 > 41 08 10 00 09 00 00 00",
        "60 00 00 00 00 00 00 00 > 10 54 4d 43 4d 2d 36 32",
        "80 08 10 00 00 00 03 05",
        "40 08 10 00 00 00 00 00 > 60 08 10 00 00 00 00 00",
        "80 08 10 00 01 00 04 05",
        "40 08 10 00 00 00 00 00",
        "80 08 10 00 00 00 04 05",
    )
    for code, here in ((0x06090011, False), (0x05030000, True), (0x05040001, True), (0x05040000, True)):
        with pytest.raises(TransferAborted) as caught:
            run(sdo.upload(*((0x6041, 0) if code == 0x06090011 else (0x1008, 0))))
        assert (caught.value.code, caught.value.here) == (code, here)


def test_a_short_frame_is_no_answer(client: Callable[..., SdoClient]) -> None:
    sdo = client("40 41 60 00 00 00 00 00 > 4b 41 60 00 > 4b 41 60 00 01 00 00 00")
    assert run(sdo.upload(0x6041, 0)) == b"\x01\x00"


def test_a_real_device_takes_texts(blocking: Bench) -> None:
    assert blocking.drive.device_name.raw == "TMCM-6212"
