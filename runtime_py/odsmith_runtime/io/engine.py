"""What a virtual device runs on: one node with its simulated motors and its memory, in Python or in C.

An engine knows neither a clock nor a bus. It is told the time, in microseconds of 64 bits that do not wrap, frames and
what hands do to the hardware; the frames that it sends are taken from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, Protocol

from ..device.port import Can, Frame, Input

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

    from odsmith_cia.codes import AbortCode

CHOICES = ("auto", "c", "python")
"""What may be asked for: `auto` is C where a library of the device was built, else Python."""

LONGEST_STEP_US = 0x3FFF_FFFF
"""A node wants to be called at least so often."""


class EngineError(Exception):
    """An engine cannot be had; `hint` says what to do."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


class Sent(NamedTuple):
    """A frame that left the device at an instant."""

    time: int
    frame: Frame


@dataclass
class Outputs:
    """What the device puts out beside frames, as it is now. Lists have an item for each axis or channel."""

    run_led: int = 0
    error_led: int = 0
    digital: int = 0
    analog: list[int] = field(default_factory=list)
    power: list[int] = field(default_factory=list)
    brake: list[int] = field(default_factory=list)
    current: list[int] = field(default_factory=list)
    driver: list[int] = field(default_factory=list)


class Engine(Protocol):
    """One device. It has no power at first; without power nothing happens to it but what hands do."""

    @property
    def name(self) -> str:
        """`python` or `c`."""

    @property
    def node_id(self) -> int:
        """The node-ID in force; 0 before the first power-on."""

    @property
    def bit_rate(self) -> int:
        """The bit rate in force, in kbit/s."""

    @property
    def nmt_code(self) -> int:
        """The NMT state as the heartbeat carries it."""

    @property
    def is_on(self) -> bool:
        """Whether the device has power."""

    @property
    def outputs(self) -> Outputs:
        """What the device shows and switches: LEDs, power stages, brakes, outputs."""

    @property
    def memory(self) -> bytes:
        """The image of the non-volatile memory."""

    @property
    def memory_writes(self) -> int:
        """How many octets were ever written to the memory."""

    def load_memory(self, image: bytes) -> None:
        """Put an image in place, before power-on. Raises ValueError for one of another size."""

    def power_on(self, now: int) -> None:
        """Give it power, at an instant in us."""

    def power_off(self) -> None:
        """Take its power away at once; the memory stays."""

    def receive(self, now: int, frame: Frame) -> None:
        """Hand it a frame that came from the bus."""

    def advance(self, now: int) -> None:
        """Let time pass up to an instant in us."""

    def next(self) -> int | None:
        """The next instant at which the device has something to do."""

    @property
    def has_sent(self) -> bool:
        """Whether there are frames to be taken."""

    def take(self) -> list[Sent]:
        """The frames that were sent since the last call, in their order."""

    def input(self, now: int, input: Input, channel: int, value: int) -> None:
        """Set an input of the device, of a channel from 0, to a value."""

    def fault(self, now: int, axis: int, condition: str, holds: bool) -> None:
        """Make a condition of the vocabulary hold on an axis, or end it."""

    def set_hardware(self, now: int, axis: int, name: str, value: int) -> None:
        """Set an input of the simulated hardware of an axis. Raises KeyError for one that there is not, ValueError."""

    def report_can(self, now: int, event: Can) -> None:
        """Tell it how its CAN controller is."""

    def shaft(self, axis: int) -> int:
        """The position of the simulated shaft, in microsteps."""

    def read(self, index: int, sub: int) -> bytes | AbortCode:
        """Read an entry without a bus and without side effect."""


class Group(Protocol):
    """Engines that share a bus and have power, where one call can serve all of them."""

    def next(self) -> int | None:
        """The next instant at which one of them has something to do."""

    def run(self, until: int) -> int:
        """Let time pass up to the first instant at which one of them sends something; gives that, or `until`."""

    def deliver(self, now: int, frame: Frame, origin: Engine | None) -> bool:
        """Bring a frame to all but one of them. True if somebody has sent something since."""


def make_group(engines: Sequence[Engine]) -> Group | None:
    """The engines with power as a group, if they can form one."""
    if not any(engine.name == "c" for engine in engines):
        return None
    from .c_engine import CGroup

    return CGroup.of(engines)


def make_engine(package: ModuleType, node_id: int, *, choice: str = "auto", serial_number: int = 0) -> Engine:
    """An engine for the device of a generated package. `node_id` is the default of the stored one.

    Raises EngineError if C is wanted and there is no library.
    """
    if choice not in CHOICES:
        raise EngineError(f"there is no engine `{choice}`", f"known: {', '.join(CHOICES)}")
    if choice != "python":
        from .c_engine import CEngine
        from .library import find

        library = find(package)
        if library is not None:
            return CEngine(package, library, node_id=node_id, serial_number=serial_number)
        if choice == "c":
            raise EngineError(
                f"no C library of {package.__name__} has been built", f"build it: odsmith engine {package.__name__}"
            )
    from .python_engine import PythonEngine

    return PythonEngine(package, node_id=node_id, serial_number=serial_number)
