"""A server that speaks the protocol of socketcand, so that programs reach the wire over TCP.

    < hi >                                   the server greets
    < open can0 >        < ok >              any name will do: there is one bus
    < rawmode >          < ok >              from now on the client gets frames
    < send 601 8 40 0 10 0 0 0 0 0 >         CAN-ID and octets in hexadecimal
    < frame 581 12.000345 4300100092010000 > seconds since the simulation began
    < echo >             < echo >
    < inject 1 axis0 left on >   < ok >      ours: what `odsmith inject` says, for a node (0: the only one)

Clients are not to be trusted to be quick, complete or sane: what they send is bounded, what waits for them is bounded,
and one that is beyond the bounds is closed. Remote frames cannot be told in this protocol and do not reach clients; a
`send` with a length but no octets is taken for one.
"""

from __future__ import annotations

import re
import selectors
import socket
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from ..device.port import Frame
from .can_link import LinkError
from .control import CommandError
from .log import EXTENDED, HIGHEST_EXTENDED_ID, HIGHEST_ID

if TYPE_CHECKING:
    from .device import VirtualDevice
    from .simulator import Simulator

DEFAULT_ADDRESS = "127.0.0.1:29536"

MOST_CLIENTS = 64
MOST_WAITING = 1 << 20
"""Octets that may wait for a client."""

LONGEST_COMMAND = 512
MOST_MISTAKES = 32
"""Commands that are not understood, before the client is closed."""

_CHUNK = 1 << 14
_HELD_BACK_S = 0.5  # a client on a busy machine needs its time
_COMMAND = re.compile(rb"<([^<>]*)>")


class SocketcandServer:
    """Listens at `address`, HOST:PORT; port 0 is a free one, see `port`. Raises LinkError.

    `devices` are those that `inject` reaches.
    """

    def __init__(self, simulator: Simulator, address: str = DEFAULT_ADDRESS) -> None:
        self.devices: list[VirtualDevice] = []
        self._simulator = simulator
        self._listener = _listen(address)
        self.host, self.port = self._listener.getsockname()[:2]
        self._selector = selectors.DefaultSelector()
        self._waker, self._wakes = socket.socketpair()
        self._clients: set[_Client] = set()
        self._lock = threading.Lock()  # of the clients' buffers; taken last
        self._thread: threading.Thread | None = None
        self._closing = False
        for sock in (self._listener, self._wakes, self._waker):
            sock.setblocking(False)
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._selector.register(self._wakes, selectors.EVENT_READ)

    @property
    def address(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    # ---- the link ----------------------------------------------------------------------------------------------------

    def start(self) -> None:
        if self._thread is None:
            self._thread = threading.Thread(target=self._serve, name="odsmith socketcand", daemon=True)
            self._thread.start()

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        self._broadcast(time, frame, None)

    def close(self) -> None:
        self._closing = True
        self._wake()
        if self._thread and self._thread is not threading.current_thread():
            self._thread.join()
        for client in tuple(self._clients):
            self._drop(client)
        self._selector.close()
        for sock in (self._listener, self._waker, self._wakes):
            sock.close()

    def _broadcast(self, microseconds: int, frame: Frame, sender: _Client | None) -> None:
        if frame.remote:
            return
        digits = f"{frame.id & HIGHEST_EXTENDED_ID:08X}" if frame.id & EXTENDED else f"{frame.id:03X}"
        seconds, rest = divmod(microseconds, 1_000_000)
        line = f"< frame {digits} {seconds}.{rest:06} {frame.data.hex().upper()} >".encode()
        for client in tuple(self._clients):
            if client is not sender and client.is_raw:
                self._put(client, line, may_wait=True)

    def _put(self, client: _Client, line: bytes, *, may_wait: bool = False) -> None:
        """Send a line, or as much of it as goes without waiting."""
        with self._lock:
            client.waiting += line
            if len(client.waiting) > MOST_WAITING:
                client.close_for("it does not read what it is sent")
            elif not (may_wait and client.held_back_s()):
                client.flush()
            needs_thread = bool(client.waiting) or client.is_over
        if needs_thread:
            self._wake()

    # ---- the thread --------------------------------------------------------------------------------------------------

    def _serve(self) -> None:
        while not self._closing:
            for key, events in self._selector.select(self._watch_clients()):
                if key.fileobj is self._listener:
                    self._accept()
                elif key.fileobj is self._wakes:
                    with suppress(BlockingIOError):
                        self._wakes.recv(_CHUNK)
                elif isinstance(key.data, _Client):
                    if events & selectors.EVENT_READ:
                        self._read(key.data)
                    if events & selectors.EVENT_WRITE:
                        with self._lock:
                            key.data.flush()

    def _watch_clients(self) -> float | None:
        """Have the selector watch for what each client needs; gives how long it may wait."""
        longest = None
        for client in tuple(self._clients):
            with self._lock:
                held_back_s = client.held_back_s()
                writes = bool(client.waiting) and not held_back_s
                is_over = client.is_over
            if is_over:
                self._drop(client)
                continue
            if held_back_s:
                longest = min(held_back_s, longest or _HELD_BACK_S)
            wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if writes else 0)
            if self._selector.get_key(client.socket).events != wanted:
                self._selector.modify(client.socket, wanted, client)
        return longest

    def _wake(self) -> None:
        with suppress(OSError):  # full is good enough, closed is too late
            self._waker.send(b".")

    def _accept(self) -> None:
        try:
            sock, address = self._listener.accept()
        except OSError:
            return  # it is gone already, or there are no more sockets
        if len(self._clients) >= MOST_CLIENTS:
            sock.close()
            return
        sock.setblocking(False)
        with suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = _Client(sock, f"{address[0]}:{address[1]}")
        self._selector.register(sock, selectors.EVENT_READ, client)
        self._clients.add(client)
        self._put(client, b"< hi >")

    def _drop(self, client: _Client) -> None:
        if client in self._clients:
            self._clients.discard(client)
            self._selector.unregister(client.socket)
            client.socket.close()
            if client.complaint:
                self._simulator.log(f"client {client.name} is closed: {client.complaint}")
            elif client.is_raw:
                self._simulator.log(f"client {client.name} leaves")

    def _read(self, client: _Client) -> None:
        try:
            octets = client.socket.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            octets = b""
        if not octets:
            with self._lock:
                client.is_over = True
            return
        for command in client.commands(octets):
            self._obey(client, command)

    def _obey(self, client: _Client, words: Sequence[str]) -> None:
        client.resume()
        match words:
            case ["open", _]:
                client.is_open = True
                self._put(client, b"< ok >")
            case ["rawmode"] if client.is_open:
                self._put(client, b"< ok >")
                client.hold_back()
                client.is_raw = True
                self._simulator.log(f"client {client.name} joins")
            case ["echo"]:
                self._put(client, b"< echo >")
            case ["send", identifier, length, *octets] if client.is_open:
                frame = _frame(identifier, length, octets)
                if frame is None:
                    self._complain(client, "no such frame")
                else:
                    self._simulator.act(lambda: self._transmit(client, frame))
            case ["inject", node, *command]:
                self._inject(client, node, command)
            case _:
                self._complain(client, "unknown command")

    def _transmit(self, client: _Client, frame: Frame) -> None:
        self._broadcast(self._simulator.wire.now, frame, client)
        self._simulator.wire.transmit(frame, self)

    def _inject(self, client: _Client, node: str, command: Sequence[str]) -> None:
        from .control import obey

        chosen = [device for device in self.devices if node in (str(device.node_id), "0")]
        if len(chosen) != 1:
            nodes = ", ".join(str(device.node_id) for device in self.devices)
            self._put(client, f"< error which node? there are {nodes} >".encode())
            return
        try:
            obey(chosen[0], command)
        except CommandError as error:
            text = re.sub("[<>]", "", str(error))
            self._put(client, f"< error {text} >".encode("ascii", "replace"))
            return
        self._simulator.log(f"node {chosen[0].node_id}: {' '.join(command)}")
        self._put(client, b"< ok >")

    def _complain(self, client: _Client, text: str) -> None:
        client.mistakes += 1
        self._put(client, f"< error {text} >".encode())
        if client.mistakes >= MOST_MISTAKES:
            client.close_for("it sends what is no command")


class _Client:
    """A connection; `waiting` is what it has not taken yet."""

    def __init__(self, sock: socket.socket, name: str) -> None:
        self.socket = sock
        self.name = name
        self.waiting = bytearray()
        self.is_open = False
        self.is_raw = False
        self.is_over = False
        self.mistakes = 0
        self.complaint = ""
        self._received = bytearray()
        self._held_until: float | None = None

    def commands(self, octets: bytes) -> list[list[str]]:
        """The commands that are complete now, each as its words. What stands between them is nothing."""
        self._received += octets
        found = []
        end = 0
        for match in _COMMAND.finditer(self._received):
            end = match.end()
            found.append(match[1].decode("ascii", "replace").split())
        del self._received[:end]
        if b"<" not in self._received:
            self.mistakes += bool(self._received.strip())
            self._received.clear()
        if len(self._received) > LONGEST_COMMAND:
            self.close_for("its command has no end")
        return [] if self.is_over else found

    def close_for(self, reason: str) -> None:
        self.complaint = reason
        self.is_over = True

    def hold_back(self) -> None:
        """Frames are held back until the client has read the answer to its command.

        python-can wants to find that answer alone in what it reads.
        """
        self._held_until = time.monotonic() + _HELD_BACK_S

    def held_back_s(self) -> float:
        """How much longer frames are held back."""
        return 0.0 if self._held_until is None else max(0.0, self._held_until - time.monotonic())

    def resume(self) -> None:
        """It says something, so it has read everything."""
        self._held_until = None

    def flush(self) -> None:
        """Send what goes without waiting."""
        try:
            while self.waiting:
                del self.waiting[: self.socket.send(self.waiting)]
        except BlockingIOError:
            return
        except OSError:
            self.is_over = True


def parse_address(address: str) -> tuple[str, int]:
    """Host and port of `127.0.0.1:29536`, `:29536`, `[::1]:29536` or `29536`. Raises LinkError."""
    host, _, port = address.rpartition(":")
    host = host.strip("[]") or "127.0.0.1"
    if not re.fullmatch(r"\d{1,5}", port) or int(port) > 0xFFFF:
        raise LinkError(f"`{address}` is no HOST:PORT", f"such as {DEFAULT_ADDRESS}")
    return host, int(port)


def _listen(address: str) -> socket.socket:
    host, port = parse_address(address)
    try:
        family, kind, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind)
    except OSError as error:
        raise LinkError(f"there is no address {address}: {error.strerror or error}") from None
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(place)
        listener.listen()
    except OSError as error:
        listener.close()
        raise LinkError(
            f"cannot listen at {address}: {error.strerror or error}", "another program has this port; name another one"
        ) from None
    return listener


def _frame(identifier: str, length: str, octets: Sequence[str]) -> Frame | None:
    """The frame of a command, if it is one."""
    if not re.fullmatch("[0-9A-Fa-f]{1,3}|[0-9A-Fa-f]{8}", identifier) or not re.fullmatch("[0-8]", length):
        return None
    number, count = int(identifier, 16), int(length)
    is_extended = len(identifier) == 8
    if number > (HIGHEST_EXTENDED_ID if is_extended else HIGHEST_ID):
        return None
    number |= EXTENDED if is_extended else 0
    if count and not octets:
        return Frame(number, remote=True, length=count)
    if len(octets) != count or not all(re.fullmatch("[0-9A-Fa-f]{1,2}", octet) for octet in octets):
        return None
    return Frame(number, bytes(int(octet, 16) for octet in octets))
