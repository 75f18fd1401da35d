"""One node on one network: its frames, its NMT state, its emergencies, and waiting for any of them.

What python-canopen does for it: the bus and its thread (`Network`), NMT and heartbeat (`NmtMaster`), EMCY.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import NmtCommand

from .errors import MissingPackageError, NoAnswerError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    import canopen
    from canopen.emcy import EmcyError
    from canopen.nmt import NmtMaster

    from .waiting import Waiter

NMT, SYNC, EMCY, SDO_ANSWER, SDO_REQUEST, HEARTBEAT = 0x000, 0x080, 0x080, 0x580, 0x600, 0x700
"""CAN-IDs of the predefined connection set, but for the node-ID (CiA 301, clause 7.3.3)."""


def python_canopen() -> ModuleType:
    """The package `canopen`. Raises MissingPackageError with the way to get it."""
    try:
        import canopen
    except ImportError as error:
        raise MissingPackageError("the client stands on python-canopen: pip install 'odsmith[client]'") from error
    module: ModuleType = canopen
    return module


class Link:
    """`frames` counts what was received of the node."""

    def __init__(self, network: canopen.Network, node_id: int, waiter: Waiter) -> None:
        python_canopen()
        from canopen.emcy import EmcyConsumer

        self.network = network
        self.waiter = waiter
        self.frames = 0
        self._last_frame_at = 0.0
        self._emcy = EmcyConsumer()  # type: ignore[no-untyped-call]
        self._subscribed: list[tuple[int, Callable[..., None]]] = []
        self.join(node_id)

    def join(self, node_id: int) -> None:
        """Listen to this node from now on."""
        from canopen.nmt import NmtMaster

        if not 1 <= node_id <= 127:
            raise ValueError(f"a node-ID is 1 to 127, not {node_id}")
        self.leave()
        self.id = node_id
        self._frames_before = self.frames  # of another node-ID
        self.boot_ups = 0
        self._before_boot_up = 0  # emergencies
        self.nmt: NmtMaster = NmtMaster(node_id)
        self.nmt.network = self.network
        self.nmt.add_heartbeat_callback(self._on_state)
        self.subscribe(HEARTBEAT + node_id, self.nmt.on_heartbeat)
        self.subscribe(EMCY + node_id, self._emcy.on_emcy)

    def leave(self) -> None:
        """Stop listening."""
        for can_id, callback in self._subscribed:
            self.network.unsubscribe(can_id, callback)
        self._subscribed.clear()

    @property
    def last_seen(self) -> str:
        """When the node was last heard, for errors."""
        if self.frames == self._frames_before:
            return "nothing was ever heard of it"
        return f"it was last heard {self.now() - self._last_frame_at:.1f} s ago"

    @property
    def emergencies(self) -> list[EmcyError]:
        """All EMCY frames so far, in their order."""
        return self._emcy.log

    @property
    def recent_emergencies(self) -> list[EmcyError]:
        """Those since the last boot-up message, which ended all faults."""
        return self._emcy.log[self._before_boot_up :]

    # ---- frames ------------------------------------------------------------------------------------------------------

    def subscribe(self, can_id: int, callback: Callable[[int, bytearray, float], None]) -> Callable[[], None]:
        """Call back for frames of a CAN-ID, then wake who waits. Gives a function that ends it."""

        def received(can_id: int, data: bytearray, timestamp: float) -> None:
            callback(can_id, data, timestamp)
            self.frames += 1
            self._last_frame_at = self.now()
            self.waiter.notify()

        def end() -> None:
            if (can_id, received) in self._subscribed:
                self._subscribed.remove((can_id, received))
                self.network.unsubscribe(can_id, received)

        self.network.subscribe(can_id, received)
        self._subscribed.append((can_id, received))
        return end

    def send(self, can_id: int, data: bytes = b"") -> None:
        self.network.send_message(can_id, data)

    # ---- waiting -----------------------------------------------------------------------------------------------------

    def now(self) -> float:
        return self.waiter.now()

    async def wait_until(self, holds: Callable[[], bool], until: float) -> bool:
        """Wait for something that frames bring about; False if it does not hold by then."""
        while not holds():
            if self.now() >= until:
                return False
            await self.next_frame(until)
        return True

    async def next_frame(self, until: float) -> None:
        """Wait for the next frame of the node, or until then."""
        seen = self.frames
        await self.waiter.wait(lambda: self.frames != seen, until)

    async def pause(self, seconds: float) -> None:
        """Let time pass, whatever is received."""
        await self.pause_until(self.now() + seconds)

    async def pause_until(self, moment: float) -> None:
        await self.waiter.wait(lambda: False, moment)

    # ---- network management ------------------------------------------------------------------------------------------

    def command(self, command: NmtCommand) -> None:
        """Send an NMT command to the node."""
        self.nmt.send_command(int(command))

    async def reset(self, timeout: float, command: NmtCommand = NmtCommand.RESET_NODE) -> None:
        """Reset the node and wait for its boot-up message. Raises NoAnswerError."""
        before = self.boot_ups
        self.command(command)
        await self.wait_for_boot_up(before, timeout)

    async def wait_for_boot_up(self, before: int, timeout: float) -> None:
        if not await self.wait_until(lambda: self.boot_ups != before, self.now() + timeout):
            raise NoAnswerError(
                f"node {self.id} sent no boot-up message within {timeout:g} s; {self.last_seen}. "
                f"Is it powered, and on this bus and bit rate?"
            )

    def _on_state(self, state: int) -> None:
        if state == 0:
            self.boot_ups += 1
            self._before_boot_up = len(self._emcy.log)


def open_network(**bus: Any) -> canopen.Network:
    """A network on a bus of python-can, which takes these arguments: interface, channel, bitrate and so on."""
    python_canopen()
    import canopen

    network = canopen.Network()
    network.connect(**bus)
    return network
