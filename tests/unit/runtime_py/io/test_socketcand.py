"""The server: programs that behave, and those that do not. Real sockets of this machine, each with a free port."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator
from types import ModuleType

import can
import pytest
from tests.unit.runtime_py.io.conftest import read

from odsmith_runtime.device import Frame
from odsmith_runtime.io import VirtualDevice
from odsmith_runtime.io.can_link import LinkError
from odsmith_runtime.io.socketcand import (
    LONGEST_COMMAND,
    MOST_CLIENTS,
    MOST_MISTAKES,
    SocketcandServer,
    parse_address,
)

pytestmark = pytest.mark.slow

PATIENCE_S = 20  # only a failing test waits so long
REQUEST = b"< send 601 8 40 0 10 0 0 0 0 0 >"
ANSWER = " 430010009201FCFF >"


class Peer:
    """A client that says what it likes."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
        self.text = ""

    def say(self, octets: bytes) -> None:
        self.socket.sendall(octets)

    def hear(self, wanted: str) -> str:
        """Everything up to something that is wanted, which is forgotten."""
        while wanted not in self.text:
            octets = self.socket.recv(1 << 16)
            assert octets, f"closed after {self.text!r}"
            self.text += octets.decode()
        heard, _, self.text = self.text.partition(wanted)
        return heard

    def is_closed(self) -> bool:
        """Read on until the other side closes, if it does."""
        try:
            while self.socket.recv(1 << 16):
                pass
        except TimeoutError:
            return False
        except ConnectionError:
            return True
        return True

    def open(self) -> Peer:
        self.hear("< hi >")
        self.say(b"< open can0 >")
        self.hear("< ok >")
        self.say(b"< rawmode >")
        self.hear("< ok >")
        return self


Connect = Callable[[], Peer]


@pytest.fixture
def server(package: ModuleType) -> Iterator[VirtualDevice]:
    with VirtualDevice(package, engine="python", listen="127.0.0.1:0") as device:
        yield device


@pytest.fixture
def connect(server: VirtualDevice) -> Iterator[Connect]:
    peers: list[Peer] = []

    def make() -> Peer:
        peers.append(Peer(server.port))
        return peers[-1]

    yield make
    for peer in peers:
        peer.socket.close()


def test_the_handshake(connect: Connect) -> None:
    peer = connect()
    assert peer.hear("< hi >") == ""
    peer.say(b"< open can0 >< rawmode >")
    assert peer.hear("< ok >< ok >") == ""
    peer.say(b"< echo >")
    assert peer.hear("< echo >") == ""


def test_a_device_answers(connect: Connect) -> None:
    peer = connect().open()
    peer.say(REQUEST)
    peer.hear("< frame 581 ")
    seconds = peer.hear(ANSWER)
    assert float(seconds) >= 0


def test_clients_hear_each_other_and_not_themselves(connect: Connect) -> None:
    one, two = connect().open(), connect().open()
    one.say(b"< send 123 3 a bb 0 >< send 00000123 1 7 >< send 124 0 >< echo >")
    assert one.hear("< echo >") == ""
    two.say(b"< echo >")
    heard = two.hear("< frame 124 ")
    assert [line.split()[2] for line in heard.split(">") if "frame" in line] == ["123", "00000123"]
    assert " 0ABB00 >" in heard
    assert two.hear(" >").endswith(" ")  # no octets: two blanks, as socketcand has it


@pytest.mark.parametrize("cut", range(1, len(REQUEST), 5))
def test_half_lines(connect: Connect, cut: int) -> None:
    peer = connect().open()
    peer.say(REQUEST[:cut])
    peer.say(REQUEST[cut:])
    peer.hear(ANSWER)


def test_python_can(server: VirtualDevice) -> None:
    def join() -> can.BusABC:
        return can.Bus(interface="socketcand", host="127.0.0.1", port=server.port, channel="can0")

    with join() as one, join() as two:
        one.send(can.Message(arbitration_id=0x601, data=read(0x1000).data, is_extended_id=False))
        answer = one.recv(PATIENCE_S)
        assert answer is not None
        assert (answer.arbitration_id, bytes(answer.data).hex()) == (0x581, "430010009201fcff")
        heard = [two.recv(PATIENCE_S), two.recv(PATIENCE_S)]
        assert [message and message.arbitration_id for message in heard] == [0x601, 0x581]


def test_python_can_joins_a_busy_bus(server: VirtualDevice) -> None:
    """It wants to read the answer to its command alone, so frames must not follow at once."""
    server.exchange(Frame(0x601, bytes.fromhex("2b17100001000000")))  # a heartbeat each millisecond
    for _ in range(3):
        with can.Bus(interface="socketcand", host="127.0.0.1", port=server.port, channel="can0") as bus:
            message = bus.recv(PATIENCE_S)
            assert message is not None
            assert message.arbitration_id == 0x701


def test_remote_frames_reach_the_device_only(connect: Connect, server: VirtualDevice) -> None:
    heard: list[Frame] = []
    server.simulator.observers.append(lambda time, frame, origin: heard.append(frame))
    one, two = connect().open(), connect().open()
    one.say(b"< send 701 1 >")
    one.hear("< frame 701 ")
    assert heard == [Frame(0x701, b"\x7f")]
    two.say(b"< echo >")
    assert two.hear("< echo >").count("frame 701") <= 1  # the answer, not the request


# ---- those that do not behave ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "complaint"),
    [
        (b"< send 601 8 40 >", "no such frame"),
        (b"< send 801 0 >", "no such frame"),
        (b"< send 601 9 0 0 0 0 0 0 0 0 0 >", "no such frame"),
        (b"< send 601 1 100 >", "no such frame"),
        (b"< send FFFFFFFF 0 >", "no such frame"),
        (b"< send xyz 0 >", "no such frame"),
        (b"< send >", "unknown command"),
        (b"< sing >", "unknown command"),
        (b"<>", "unknown command"),
        (b"< \xff\xfe >", "unknown command"),
    ],
)
def test_nonsense_is_answered(connect: Connect, command: bytes, complaint: str) -> None:
    peer = connect().open()
    peer.say(command)
    peer.hear(f"< error {complaint} >")
    peer.say(REQUEST)
    peer.hear(ANSWER)


def test_frames_are_for_those_who_opened_a_bus(connect: Connect) -> None:
    peer = connect()
    peer.say(REQUEST + b"< rawmode >")
    peer.hear("< error unknown command >< error unknown command >")


@pytest.mark.parametrize(
    "garbage",
    [
        pytest.param(b"GET / HTTP/1.1\r\n\r\n" * 10_000, id="between commands"),
        pytest.param(b"<" * (1 << 20), id="open brackets"),
        pytest.param(b"< send " + b"0 " * LONGEST_COMMAND, id="no end"),
        pytest.param(b"< nonsense >" * MOST_MISTAKES, id="many mistakes"),
        pytest.param(bytes(range(256)) * 1000, id="octets"),
    ],
)
def test_garbage_ends_a_connection_and_nothing_else(connect: Connect, garbage: bytes) -> None:
    good, bad = connect().open(), connect().open()
    try:
        bad.say(garbage)
        bad.say(b"< x >" * MOST_MISTAKES)
    except OSError:
        pass  # closed while we were talking
    assert bad.is_closed()
    good.say(REQUEST)
    good.hear(ANSWER)


def test_a_flood_is_worked_off(connect: Connect) -> None:
    one, two = connect().open(), connect().open()
    for _ in range(50):
        one.say(b"< send 080 0  >" * 100)
        two.say(REQUEST)
        two.hear(ANSWER)
    one.say(b"< echo >")
    one.hear("< echo >")


def test_who_does_not_read_is_closed(connect: Connect, server: VirtualDevice, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("odsmith_runtime.io.socketcand.MOST_WAITING", 2000)
    said: list[str] = []
    lazy, busy = connect().open(), connect().open()
    server.simulator.log = lambda text: said.append(text.partition(" is closed: ")[2])
    for _ in range(2000):  # far more than the system keeps for somebody who does not read
        busy.say(b"< send 123 8 1 2 3 4 5 6 7 8 >" * 100 + b"< echo >")
        busy.hear("< echo >")
        if any(said):
            break
    assert said[-1] == "it does not read what it is sent"
    assert lazy.is_closed()


def test_there_are_only_so_many_clients(connect: Connect, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("odsmith_runtime.io.socketcand.MOST_CLIENTS", 3)
    assert MOST_CLIENTS > 3
    good = [connect().open() for _ in range(3)]
    assert connect().is_closed()
    good[0].socket.close()
    good[1].say(REQUEST)
    good[1].hear(ANSWER)


def test_who_leaves_leaves(connect: Connect) -> None:
    for _ in range(5):
        connect().open().socket.close()
    peer = connect().open()
    peer.say(REQUEST)
    peer.hear(ANSWER)


# ---- hands -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("node", ["0", "1"])
def test_inject(connect: Connect, server: VirtualDevice, node: str) -> None:
    peer = connect()
    peer.hear("< hi >")
    peer.say(f"< inject {node} axis3 shaft -77 >".encode())
    peer.hear("< ok >")
    assert server.engine.shaft(3) == -77


def test_inject_says_why_not(connect: Connect) -> None:
    peer = connect()
    peer.hear("< hi >")
    peer.say(b"< inject 1 axis9 left on >")
    peer.hear("< error there is no axis 9, axes are 0 to 5 >")
    peer.say(b"< inject 2 axis0 left on >")
    peer.hear("< error which node? there are 1 >")


def test_inject_goes_by_the_node_id_in_force(connect: Connect, server: VirtualDevice) -> None:
    server.inject("address 9")
    server.inject("power cycle")
    assert (server.configured_id, server.node_id) == (1, 9)
    peer = connect()
    peer.hear("< hi >")
    peer.say(b"< inject 1 axis3 shaft 5 >")
    peer.hear("< error which node? there are 9 >")
    peer.say(b"< inject 9 axis3 shaft 5 >")
    peer.hear("< ok >")
    assert server.engine.shaft(3) == 5
    server.inject("power off")
    peer.say(b"< inject 9 power on >")
    peer.hear("< ok >")


# ---- addresses -------------------------------------------------------------------------------------------------------


def test_a_busy_port(server: VirtualDevice) -> None:
    with pytest.raises(LinkError, match="in use") as raised:
        SocketcandServer(server.simulator, f"127.0.0.1:{server.port}")
    assert "another" in raised.value.hint


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("127.0.0.1:29536", ("127.0.0.1", 29536)),
        ("29536", ("127.0.0.1", 29536)),
        (":0", ("127.0.0.1", 0)),
        ("[::1]:5", ("::1", 5)),
        ("box.example:5", ("box.example", 5)),
    ],
)
def test_addresses(text: str, address: tuple[str, int]) -> None:
    assert parse_address(text) == address


@pytest.mark.parametrize("text", ["", "127.0.0.1", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:70000", "1:2:-3"])
def test_no_addresses(text: str) -> None:
    with pytest.raises(LinkError, match="no HOST:PORT"):
        parse_address(text)


def test_it_listens_to_this_machine_alone(server: VirtualDevice) -> None:
    assert server.server is not None
    assert server.server.address == f"127.0.0.1:{server.port}"
