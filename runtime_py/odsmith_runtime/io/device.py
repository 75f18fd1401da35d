"""A virtual device, for programs: on a bus of python-can, on a socket, or driven by hand.

with VirtualDevice(tmcm6212, node_id=1, interface="virtual", channel="test") as device:
    network.connect(interface="virtual", channel="test")
    ...
    device.fault(0, "overtemperature", True)

device = VirtualDevice(tmcm6212)                no clock and no thread: time passes when told
device.exchange(Frame(0x601, ...))              the frames that it answers
device.run(seconds=0.1)
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from ..device.port import Can, Frame, Input
from . import control
from .engine import make_engine
from .simulator import Simulator
from .state_file import StateError, StateFile
from .view import DeviceView, Viewer

if TYPE_CHECKING:
    from types import ModuleType

    import can

    from ..emergencies import Emergency
    from ..identity import Identity
    from .simulator import Link
    from .socketcand import SocketcandServer
    from .wire import Station, Wire

_EMERGENCIES = range(0x081, 0x100)
_KEPT = 32  # emergencies


class VirtualDevice:
    """A device of a generated package.

    `node_id` is the default of the stored one; `engine` is auto, c or python; `state` is the file that keeps its
    memory. `interface`, `channel` and `bitrate` in bit/s join a bus of python-can, `bus` is one that is open already;
    `listen` is HOST:PORT of a socketcand server, port 0 a free one; `record` is a file for a log of candump. Devices
    that are given a `simulator` share its bus and its time, and it starts and stops them.

    Raises EngineError, StateError, LinkError, OSError; ValueError for a wrong speed.
    """

    def __init__(
        self,
        package: ModuleType,
        node_id: int = 1,
        *,
        engine: str = "auto",
        serial_number: int = 0,
        state: Path | str | StateFile | None = None,
        speed: float = 1.0,
        interface: str | None = None,
        channel: str | None = None,
        bitrate: int | None = None,
        bus: can.BusABC | None = None,
        listen: str | None = None,
        record: Path | str | None = None,
        simulator: Simulator | None = None,
    ) -> None:
        self.package = package
        self.identity: Identity = package.IDENTITY
        self.axis_count = self.identity.axes
        self.conditions = frozenset(
            name for name, info in package.CONDITIONS.items() if info.scope == "axis" and name != "fault_reset"
        )
        self.configured_id = node_id
        self.emergencies: deque[tuple[int, Frame, Emergency | None]] = deque(maxlen=_KEPT)
        self.emergency_count = 0
        self.simulator = simulator or Simulator(speed=speed)
        self._owns_simulator = simulator is None
        self.engine = make_engine(package, node_id, choice=engine, serial_number=serial_number or node_id)
        self._state = StateFile(Path(state), package.__name__) if isinstance(state, (Path, str)) else state
        self._saved = 0  # writes to the memory, as the file has it
        self.save_error: OSError | None = None
        self._digital = 0
        self._station: Station
        self._viewer = Viewer(package, self.engine)
        self.server: SocketcandServer | None = None
        self._load()
        with ExitStack() as undo:
            for link in self._open_links(interface, channel, bitrate, bus, listen, record):
                undo.callback(link.close)
                self.simulator.connect(link)
            undo.pop_all()
        with self.simulator.lock:
            self._station = self.simulator.wire.attach(self.engine)
            self.simulator.observers.append(self._observe)
            self.simulator.after_turn.append(self._save)
        self.power_on()

    def _open_links(
        self,
        interface: str | None,
        channel: str | None,
        bitrate: int | None,
        bus: can.BusABC | None,
        listen: str | None,
        record: Path | str | None,
    ) -> list[Link]:
        links: list[Link] = []
        if record is not None:
            from .recorder import Recorder

            links.append(Recorder(Path(record)))
        if listen is not None:
            from .socketcand import SocketcandServer

            self.server = SocketcandServer(self.simulator, listen)
            self.server.devices.append(self)
            links.append(self.server)
        if interface is not None or bus is not None:
            from .can_link import CanLink, open_bus

            links.append(CanLink(self.simulator, bus or open_bus(interface or "", channel, bitrate), owns=bus is None))
        return links

    # ---- what it does ------------------------------------------------------------------------------------------------

    @property
    def node_id(self) -> int:
        """The node-ID in force."""
        return self.engine.node_id

    @property
    def port(self) -> int:
        """The port of the socketcand server, 0 if there is none."""
        return self.server.port if self.server else 0

    def view(self) -> DeviceView:
        """What is to be seen of it now."""
        with self.simulator.lock:
            return self._viewer.look()

    # ---- time --------------------------------------------------------------------------------------------------------

    def start(self) -> VirtualDevice:
        """Start its simulator, and with it the thread that keeps the time; gives the device itself."""
        self.simulator.start()
        return self

    def stop(self) -> None:
        """End its simulator, if it is its own, and keep its memory."""
        if self._owns_simulator:
            self.simulator.stop()

    def __enter__(self) -> VirtualDevice:
        return self.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def run(self, seconds: float) -> list[Frame]:
        """Let so much time pass at once; gives the frames that the device sends. For one that was not started."""
        with self.simulator.lock:
            return self._listen(lambda: self.simulator.run(round(seconds * 1_000_000)))

    def exchange(self, *frames: Frame) -> list[Frame]:
        """Bring it frames; gives those that it answers in the same instant."""
        with self.simulator.lock:
            return self._listen(lambda: self._act(lambda: self._transmit(frames)))

    # ---- what hands do to it -----------------------------------------------------------------------------------------

    def power_on(self) -> None:
        """Switch it on, if it is off: it boots and says so on the bus."""
        if not self.engine.is_on:
            self._act(lambda: self._wire.power_on(self._station))

    def power_off(self) -> None:
        """At once and without a word; what is stored stays."""
        self._act(lambda: self._wire.power_off(self._station))

    def fault(self, axis: int, condition: str, holds: bool = True) -> None:
        """The hardware of an axis reports a condition, or that it has ended. Raises KeyError for one it has not."""
        if condition not in self.conditions:
            raise KeyError(condition)
        self._act(lambda: self._wire.fault(self._station, axis, condition, holds))

    def set_hardware(self, axis: int, name: str, value: int) -> None:
        """Set an input of the simulated motor of an axis, one of `device.simulation.INPUTS`.

        Raises KeyError for one that there is not, ValueError for a value out of its range.
        """
        self._act(lambda: self._wire.set_hardware(self._station, axis, name, value))

    def input(self, input: Input, channel: int, value: int) -> None:
        """Set an input of the module."""
        self._act(lambda: self._wire.input(self._station, input, channel, value))

    def digital_input(self, channel: int, value: bool) -> None:
        """Set one digital input of the module."""
        self._digital = self._digital & ~(1 << channel) | value << channel
        self.input(Input.DIGITAL, 0, self._digital)

    def report_can(self, event: Can) -> None:
        """The CAN controller of the device changes its state, or something happens to it."""
        self._act(lambda: self._wire.report_can(self._station, event))

    def lose(self, frames: int) -> None:
        """Let the next frames to or from the device get lost."""
        with self.simulator.lock:
            self._wire.lose(self._station, frames)

    def delay(self, milliseconds: float) -> None:
        """Let its frames be late."""
        with self.simulator.lock:
            self._station.delay_us = round(milliseconds * 1000)

    def inject(self, command: str) -> None:
        """Do what a command of `control` says, such as `axis0 overtemperature on`. Raises CommandError."""
        control.obey(self, command.split())

    # ---- within ------------------------------------------------------------------------------------------------------

    def _transmit(self, frames: Iterable[Frame]) -> None:
        for frame in frames:
            self._wire.transmit(frame, None)

    @property
    def _wire(self) -> Wire:
        return self.simulator.wire

    def _act(self, action: Callable[[], None]) -> None:
        self.simulator.act(action)

    def _listen(self, action: Callable[[], object]) -> list[Frame]:
        """The frames that the device sends during an action."""
        heard: list[Frame] = []

        def hear(time: int, frame: Frame, origin: Station) -> None:
            if origin is self._station:
                heard.append(frame)

        self.simulator.observers.append(hear)
        try:
            action()
        finally:
            self.simulator.observers.remove(hear)
        return heard

    def _observe(self, time: int, frame: Frame, origin: Station) -> None:
        if origin is self._station and frame.id in _EMERGENCIES and len(frame.data) == 8:
            code = int.from_bytes(frame.data[:2], "little")
            self.emergency_count += 1
            self.emergencies.append((time, frame, self.package.EMERGENCIES.find(code, frame.data[3:])))

    def _load(self) -> None:
        image = self._state.image(self.configured_id) if self._state else None
        if self._state is None or image is None:
            return
        try:
            self.engine.load_memory(image)
        except ValueError as error:
            raise StateError(
                f"{self._state.path} does not fit this device: {error}", "it was made by another version; name another"
            ) from None

    def save(self) -> None:
        """Keep the memory in the state file, if there is one; `save_error` says whether that failed."""
        with self.simulator.lock:
            self._saved = -1
            self._save()

    def _save(self) -> None:
        """Keep the memory as soon as something was written to it."""
        if self._state is None or self.engine.memory_writes == self._saved:
            return
        try:
            self._state.save(self.configured_id, self.engine.memory)
            self.save_error = None
        except OSError as error:
            self.save_error = error
            self.simulator.log(f"the parameters are not saved: {error}")
        self._saved = self.engine.memory_writes
