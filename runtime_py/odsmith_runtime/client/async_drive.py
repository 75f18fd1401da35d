"""A drive on a bus, for asyncio; its blocking twin in `drive` has the same methods."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from odsmith_cia.codes import ModeCode, NmtCommand

from ..names import AsyncLive, Names
from . import bus_settings, cyclic, diagnosis, parameters, pdo_setup
from .async_axis import MOTION_TIMEOUT, AsyncAxis
from .core import Core
from .errors import ClientError
from .facts import Facts
from .link import Link, open_network
from .pdo_plan import BusLoad, place
from .waiting import AsyncioWaiter

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path
    from types import TracebackType
    from typing import Self

    import canopen

    from .errors import EmergencyError
    from .parameters import Report
    from .pdo_plan import Mapped
    from .waiting import Waiter

ANSWER_TIMEOUT = 1.0
"""Seconds that a node may take to answer by SDO."""

RESET_TIMEOUT = 5.0

_IDENTITY = 0x1018
_VENDOR, _PRODUCT = 1, 2


class AsyncDrive(Names[AsyncLive]):
    """A node with its axes. Objects of the whole device are attributes; `objects` has them too, `axes` the axes.

    Made on a `canopen.Network`, or by `connect` on a bus of its own. Leaving its context, or `close`, ends the
    connection and leaves the motors as they are. `answer_timeout` is the longest time in seconds that an answer by SDO
    may take; all times are in seconds. Methods raise what access raises (SdoAborted, NoAnswerError, RefusedError),
    and what they name.
    """

    _package: ClassVar[str]
    _axis_class: ClassVar[type[AsyncAxis]] = AsyncAxis
    axes: tuple[Any, ...]
    objects: Any

    def __init__(
        self,
        network: canopen.Network,
        node_id: int = 1,
        *,
        answer_timeout: float = ANSWER_TIMEOUT,
        waiter: Waiter | None = None,
    ) -> None:
        facts = Facts.of(self._package)
        core = Core(Link(network, node_id, waiter or AsyncioWaiter()), facts, answer_timeout)
        super().__init__(facts.dictionary, None, behind=core.value)
        self._core = core
        self._bus: Mapping[str, Any] | None = None
        self.__dict__["axes"] = tuple(self._axis_class(core, axis) for axis in range(facts.dictionary.axis_count))
        self.__dict__["objects"] = facts.device_objects(facts.dictionary, None, behind=core.value)

    @classmethod
    def connect(cls, *, node_id: int = 1, answer_timeout: float = ANSWER_TIMEOUT, **bus: Any) -> Self:
        """A drive on a bus of its own, which python-can opens: `interface`, `channel`, `bitrate` (bit/s) and so on.

        Raises MissingPackageError without python-canopen, and what python-can raises for a bus that it cannot open.
        """
        drive = cls(open_network(**bus), node_id, answer_timeout=answer_timeout)
        drive._bus = bus
        return drive

    def close(self) -> None:
        """Stop listening; a bus of its own is closed."""
        self._core.link.leave()
        if self._bus is not None:
            self._core.link.network.disconnect()

    async def __aenter__(self) -> Self:
        try:
            await self.check_identity()
        except BaseException:
            self.close()
            raise
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<{self._core.facts.identity.name}, node {self.id}>"

    # ---- the node ----------------------------------------------------------------------------------------------------

    @property
    def id(self) -> int:
        """The node-ID."""
        return self._core.link.id

    @property
    def network(self) -> canopen.Network:
        """The network of python-canopen that the node is on."""
        return self._core.link.network

    @property
    def nmt_state(self) -> str:
        """The NMT state as last told or commanded, in the words of python-canopen: OPERATIONAL and so on."""
        return self._core.link.nmt.state

    @property
    def emergencies(self) -> tuple[EmergencyError, ...]:
        """All emergencies since the beginning, in words; code 0 says that one is over."""
        return tuple(diagnosis.emergency(self._core.facts, frame) for frame in self._core.link.emergencies)

    async def check_identity(self) -> None:
        """Raise ClientError if the node is another device, NoAnswerError if there is none."""
        facts = self._core.facts
        wanted = (facts.identity.vendor_id, facts.identity.product_code)
        record = facts.dictionary[_IDENTITY]
        found = (
            int(await self._core.access.read(record[_VENDOR])),
            int(await self._core.access.read(record[_PRODUCT])),
        )
        if found != wanted:
            raise ClientError(
                f"node {self.id} is no {facts.identity.name}: its vendor and product code are "
                f"{found[0]:08X}h {found[1]:08X}h instead of {wanted[0]:08X}h {wanted[1]:08X}h"
            )

    async def start(self) -> None:
        """Enter OPERATIONAL: PDOs are exchanged."""
        self._core.link.command(NmtCommand.START)

    async def reset(self, timeout: float = RESET_TIMEOUT) -> None:
        """Reset the node and wait for its boot-up message. Stored parameters come into force, PDOs are forgotten."""
        self._core.exchange.configure(())
        await self._core.link.reset(timeout)

    async def sync(self) -> None:
        """Send SYNC."""
        self._core.exchange.sync()

    async def pause(self, seconds: float) -> None:
        """Let time pass, that of the network: seconds of the clock, or virtual ones."""
        await self._core.link.pause(seconds)

    # ---- process data ------------------------------------------------------------------------------------------------

    async def configure_pdos(
        self, plan: Iterable[Mapped], *, sync_period: float = 0.0, bit_rate: int = 1_000_000
    ) -> BusLoad:
        """Give the device these PDOs and no others, enter OPERATIONAL, and use them from now on.

        The plan is checked before anything is sent (PlanError). Gives the load of the bus, for printing, at a bit rate
        in bit/s and, for PDOs that go by SYNC, with a SYNC every so many seconds.
        """
        core = self._core
        places = place(plan, core.facts.dictionary, self.id)
        core.link.command(NmtCommand.ENTER_PRE_OPERATIONAL)
        core.exchange.configure(())
        for record in core.facts.dictionary.pdos:
            await pdo_setup.switch_off(core.access, record)
        for each in places:
            await pdo_setup.set_up(core.access, each)
        core.exchange.configure(places)
        for entry in core.exchange.sent():
            core.exchange.preset(entry, await core.access.read(entry))
        core.link.command(NmtCommand.START)
        return BusLoad(places, sync_period, bit_rate)

    async def use_pdos(self, use: bool = True) -> None:
        """Whether axes use the PDOs that are configured, or SDO for everything."""
        self._core.exchange.enabled = use

    # ---- axes together -----------------------------------------------------------------------------------------------

    async def enable(self, timeout: float = RESET_TIMEOUT) -> None:
        """Enable all axes, one after the other."""
        for axis in self.axes:
            await axis.enable(timeout)

    async def disable(self, timeout: float = RESET_TIMEOUT) -> None:
        """Disable all axes that are not faulty."""
        for axis in self.axes:
            if await axis.state() not in diagnosis.FAULTY:
                await axis.disable(timeout)

    async def wait(self, *axes: int, timeout: float = MOTION_TIMEOUT) -> None:
        """Wait until the movements of these axes, or of all, have ended well."""
        until = self._core.link.now() + timeout
        for axis in axes or range(len(self.axes)):
            await self.axes[axis].wait(until - self._core.link.now())

    async def stream(
        self,
        rows: Iterable[Mapping[int, int]],
        *,
        period: float,
        mode: int = ModeCode.CYCLIC_SYNCHRONOUS_POSITION,
        axes: Iterable[int] | None = None,
        keep_going: bool = False,
    ) -> dict[int, EmergencyError]:
        """Send set-points in a cycle: a row of (axis: position or velocity) and SYNC every `period` seconds.

        In csp the first row should be where the axes are: each way is made in one cycle, however long it is. `axes` are
        those that take part, all by default. An axis that becomes faulty ends the stream with its EmergencyError; with
        `keep_going` the others go on, and the result says which axes failed.
        """
        taking_part = [self.axes[axis] for axis in (range(len(self.axes)) if axes is None else axes)]
        await cyclic.prepare(self._core, taking_part, period, int(mode))
        return await cyclic.stream(self._core, rows, period, int(mode), keep_going)

    # ---- parameters --------------------------------------------------------------------------------------------------

    async def save_parameters(self, path: str | Path) -> None:
        """Write all parameters that can be stored to a YAML file."""
        await parameters.save(self._core.access, path)

    async def load_parameters(self, path: str | Path, *, write: bool = True) -> Report:
        """Make the parameters what a file says, node-ID and bit rate apart; gives the differences.

        All values are checked before the first is written (RefusedError). Without `write` it only compares.
        """
        return await parameters.load(self._core.access, path, write)

    async def store(self, group: str = "all") -> None:
        """Store parameters so that they outlive power-off: all, or a group of 1010h by name."""
        await bus_settings.store(self._core, group)

    async def restore(self, group: str = "all") -> None:
        """Make the defaults valid again, from the next `reset` on."""
        await bus_settings.restore(self._core, group)

    async def change_node_id(self, node_id: int, timeout: float = RESET_TIMEOUT) -> None:
        """Write and store a new node-ID, reset the node, and go on under it."""
        await bus_settings.change_node_id(self._core, node_id, timeout)

    async def change_bit_rate(
        self, kbit_per_s: int, *, reconnect: Callable[[], object] | None = None, timeout: float = RESET_TIMEOUT
    ) -> None:
        """Write and store a new bit rate, reset the node, and go on with it.

        `reconnect` brings the network to the new bit rate; only a bus of `connect` needs none.
        """
        if reconnect is None and self._bus is None:
            raise ClientError("on a network that was given, say how to `reconnect` it with the new bit rate")
        await bus_settings.change_bit_rate(
            self._core, kbit_per_s, reconnect or (lambda: self._reopen(kbit_per_s)), timeout
        )

    def _reopen(self, kbit_per_s: int) -> None:
        self._bus = {**(self._bus or {}), "bitrate": kbit_per_s * 1000}
        self.network.disconnect()
        self.network.connect(**self._bus)
