"""A drive on a bus."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from ..names import Live, Names
from .async_drive import ANSWER_TIMEOUT, AsyncDrive
from .axis import Axis
from .blocking import Blocking
from .link import open_network
from .values import Value
from .waiting import BlockingWaiter, run

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    import canopen

    from ..entries import Entry
    from .errors import EmergencyError
    from .waiting import Waiter


class Drive(Names[Live]):
    """A node with its axes. Objects of the whole device are attributes; `objects` has them too, `axes` the axes.

    Made on a `canopen.Network`, or by `connect` on a bus of its own. Leaving its context, or `close`, ends the
    connection and leaves the motors as they are. `answer_timeout` is the longest time in seconds that an answer by SDO
    may take; all times are in seconds. Its methods are those of `AsyncDrive`, with the same errors; they block until
    all is done.
    """

    _twin_class: ClassVar[type[AsyncDrive]]
    _axis_class: ClassVar[type[Axis]] = Axis
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
        twin = self._twin_class(network, node_id, answer_timeout=answer_timeout, waiter=waiter or BlockingWaiter())

        def behind(entry: Entry[Any]) -> Value[Any]:
            return Value(twin._core.value(entry))

        super().__init__(twin._dictionary, None, behind=behind)
        self._twin = twin
        self.__dict__["axes"] = tuple(self._axis_class(axis, behind) for axis in twin.axes)
        self.__dict__["objects"] = twin._core.facts.device_objects(twin._dictionary, None, behind=behind)

    @classmethod
    def connect(cls, *, node_id: int = 1, answer_timeout: float = ANSWER_TIMEOUT, **bus: Any) -> Self:
        """A drive on a bus of its own, which python-can opens: `interface`, `channel`, `bitrate` (bit/s) and so on.

        Raises MissingPackageError without python-canopen, and what python-can raises for a bus that it cannot open.
        """
        drive = cls(open_network(**bus), node_id, answer_timeout=answer_timeout)
        drive._twin._bus = bus
        return drive

    def close(self) -> None:
        """Stop listening; a bus of its own is closed."""
        self._twin.close()

    def __enter__(self) -> Self:
        run(self._twin.__aenter__())
        return self

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return repr(self._twin)

    @property
    def id(self) -> int:
        """The node-ID."""
        return self._twin.id

    @property
    def network(self) -> canopen.Network:
        """The network of python-canopen that the node is on."""
        return self._twin.network

    @property
    def nmt_state(self) -> str:
        """The NMT state as last told or commanded, in the words of python-canopen: OPERATIONAL and so on."""
        return self._twin.nmt_state

    @property
    def emergencies(self) -> tuple[EmergencyError, ...]:
        """All emergencies since the beginning, in words; code 0 says that one is over."""
        return self._twin.emergencies

    check_identity = Blocking(AsyncDrive.check_identity)
    start = Blocking(AsyncDrive.start)
    reset = Blocking(AsyncDrive.reset)
    sync = Blocking(AsyncDrive.sync)
    pause = Blocking(AsyncDrive.pause)

    configure_pdos = Blocking(AsyncDrive.configure_pdos)
    use_pdos = Blocking(AsyncDrive.use_pdos)

    enable = Blocking(AsyncDrive.enable)
    disable = Blocking(AsyncDrive.disable)
    wait = Blocking(AsyncDrive.wait)
    stream = Blocking(AsyncDrive.stream)

    save_parameters = Blocking(AsyncDrive.save_parameters)
    load_parameters = Blocking(AsyncDrive.load_parameters)
    restore = Blocking(AsyncDrive.restore)
    change_node_id = Blocking(AsyncDrive.change_node_id)
    change_bit_rate = Blocking(AsyncDrive.change_bit_rate)

    def store(self, group: str = "all") -> None:
        """Store parameters so that they outlive power-off: all, or a group of 1010h by name."""
        run(self._twin.store(group))  # a method in full: some devices have an object `store`, whose type would win
