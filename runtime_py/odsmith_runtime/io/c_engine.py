"""The engine in C: the C runtime and its simulation, compiled for a device into a shared library.

`runtime_c/port/engine` is the other side of this border. Nothing calls back over it, so a turn costs one call.
"""

from __future__ import annotations

import ctypes
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import AbortCode
from odsmith_cia.emergencies import CONDITIONS

from ..device.port import Frame, Input
from .engine import EngineError, Outputs, Sent

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from types import ModuleType

    from ..device.port import Can
    from .engine import Engine

_ABI = 2
_AXES = 256
_ANALOG = 8
_NEVER = 0xFFFF_FFFF_FFFF_FFFF
_NOBODY = 0xFFFF_FFFF
_ROOM = 256  # frames that are taken at once
_LONGEST_VALUE = 512
_BLANK = 0xFF  # an octet of memory that was never written

# The enumeration of C: in the order of the vocabulary, those of an axis first.
CONDITION_NUMBERS = {
    name: number for number, name in enumerate(sorted(CONDITIONS, key=lambda name: CONDITIONS[name].scope != "axis"))
}


class _Frame(ctypes.Structure):
    _fields_ = (
        ("time", ctypes.c_uint64),
        ("id", ctypes.c_uint16),
        ("length", ctypes.c_uint8),
        ("remote", ctypes.c_uint8),
        ("data", ctypes.c_uint8 * 8),
    )


class _Front(ctypes.Structure):
    _fields_ = (
        ("now", ctypes.c_uint64),
        ("next", ctypes.c_uint64),
        *((name, ctypes.c_uint32) for name in ("queued", "dropped", "memory_writes", "bit_rate", "node_id")),
        *((name, ctypes.c_uint32) for name in ("nmt_state", "run_led", "error_led", "digital")),
        ("analog", ctypes.c_uint32 * _ANALOG),
        *((name, ctypes.c_uint32 * _AXES) for name in ("power", "brake", "current", "driver")),
    )


@lru_cache
def _load(path: Path) -> Any:
    """The functions of a library. Raises EngineError."""
    try:
        library = ctypes.CDLL(str(path))
        found = library.engine_abi()
    except (OSError, AttributeError) as error:
        raise EngineError(f"{path} cannot be used: {error}", "remove it and build it again: odsmith engine") from None
    if found != _ABI:
        raise EngineError(f"{path} is of another version", "remove it and build it again: odsmith engine")
    pointer, u32, u64 = ctypes.c_void_p, ctypes.c_uint32, ctypes.c_uint64
    for name, result, arguments in (
        ("size", u32, ()),
        ("memory_size", u32, ()),
        ("axes", u32, ()),
        ("init", None, (pointer, pointer, u32, u32)),
        ("reset", None, (pointer,)),
        ("power_on", None, (pointer, u64)),
        ("advance", ctypes.c_int, (pointer, u64)),
        ("receive", None, (pointer, u32, u32, u32, ctypes.c_char_p)),
        ("input", None, (pointer, u32, u32, u32)),
        ("fault", None, (pointer, u32, u32, u32)),
        ("can", None, (pointer, u32)),
        ("hardware", ctypes.c_int, (pointer, u32, ctypes.c_char_p, ctypes.c_int32, u32)),
        ("shaft", ctypes.c_int64, (pointer, u32)),
        ("take", u32, (pointer, pointer, u32)),
        ("read", u32, (pointer, u32, u32, ctypes.c_char_p, u32, pointer)),
        ("s_next", u64, (pointer, u32)),
        ("s_run", u64, (pointer, u32, u64)),
        ("s_deliver", u32, (pointer, u32, u32, u64, u32, u32, u32, ctypes.c_char_p)),
    ):
        function = getattr(library, f"engine{'' if name.startswith('s_') else '_'}{name}")
        function.restype = result
        function.argtypes = arguments
    return library


class CEngine:
    """A device in C. Raises EngineError for a library that cannot be used."""

    name = "c"

    def __init__(self, package: ModuleType, path: Path, *, node_id: int, serial_number: int = 0) -> None:
        self._library = _load(path)
        self._room = ctypes.create_string_buffer(self._library.engine_size())
        self._memory = ctypes.create_string_buffer(bytes([_BLANK]) * self._library.engine_memory_size())
        self._memory_size = self._library.engine_memory_size()
        self._taken = (_Frame * _ROOM)()
        self._inputs: dict[tuple[Input, int], int] = {}  # as hands left them, whatever the power does
        self._sent: list[Sent] = []
        self._axes: int = self._library.engine_axes()
        self._analog: int = package.IDENTITY.analog_outputs
        self._engine = ctypes.c_void_p(ctypes.addressof(self._room))
        self._front = _Front.from_buffer(self._room)
        self._library.engine_init(self._engine, self._memory, node_id, serial_number)
        self._advance = self._library.engine_advance
        self.is_on = False

    # ---- what is known of it -----------------------------------------------------------------------------------------

    @property
    def node_id(self) -> int:
        return int(self._front.node_id)

    @property
    def bit_rate(self) -> int:
        return int(self._front.bit_rate)

    @property
    def nmt_code(self) -> int:
        return int(self._front.nmt_state)

    @property
    def outputs(self) -> Outputs:
        front, axes = self._front, self._axes
        if not self.is_on:
            return Outputs(0, 0, 0, [0] * _ANALOG, [0] * axes, [0] * axes, [0] * axes, [0] * axes)
        return Outputs(
            front.run_led,
            front.error_led,
            front.digital,
            list(front.analog),
            front.power[:axes],
            front.brake[:axes],
            front.current[:axes],
            front.driver[:axes],
        )

    @property
    def memory(self) -> bytes:
        return self._memory.raw[: self._memory_size]

    @property
    def memory_writes(self) -> int:
        return int(self._front.memory_writes)

    def load_memory(self, image: bytes) -> None:
        if len(image) != self._memory_size:
            raise ValueError(f"an image of {len(image)} octets, not {self._memory_size}")
        ctypes.memmove(self._memory, image, len(image))

    def shaft(self, axis: int) -> int:
        return int(self._library.engine_shaft(self._engine, axis))

    def read(self, index: int, sub: int) -> bytes | AbortCode:
        octets = ctypes.create_string_buffer(_LONGEST_VALUE)
        length = ctypes.c_uint16()
        abort = self._library.engine_read(self._engine, index, sub, octets, _LONGEST_VALUE, ctypes.addressof(length))
        return AbortCode(abort) if abort else octets.raw[: length.value]

    # ---- events ------------------------------------------------------------------------------------------------------

    def power_on(self, now: int) -> None:
        self._library.engine_reset(self._engine)
        self._front.now = now
        for (input, channel), value in self._inputs.items():
            self._library.engine_input(self._engine, input, channel, value)
        self._library.engine_power_on(self._engine, now)
        self.is_on = True

    def power_off(self) -> None:
        self.is_on = False

    def receive(self, now: int, frame: Frame) -> None:
        if self.is_on:
            if now > self._front.now:
                self.advance(now)
            self._library.engine_receive(self._engine, frame.id, frame.dlc, frame.remote, frame.data)

    def advance(self, now: int) -> None:
        if self.is_on:
            while not self._advance(self._engine, now):
                self._drain()

    def next(self) -> int | None:
        at = self._front.next
        return None if at == _NEVER or not self.is_on else int(at)

    @property
    def has_sent(self) -> bool:
        return bool(self._front.queued or self._sent)

    def take(self) -> list[Sent]:
        if self._front.queued:
            self._drain()
        if not self._sent:
            return []
        sent, self._sent = self._sent, []
        return sent

    def input(self, now: int, input: Input, channel: int, value: int) -> None:
        self._inputs[input, channel] = value
        if self.is_on:
            self.advance(now)
            self._library.engine_input(self._engine, input, channel, value)

    def fault(self, now: int, axis: int, condition: str, holds: bool) -> None:
        if self.is_on:
            self.advance(now)
            self._library.engine_fault(self._engine, axis, CONDITION_NUMBERS[condition], holds)

    def set_hardware(self, now: int, axis: int, name: str, value: int) -> None:
        self.advance(now)
        found = -0x8000_0000 <= value <= 0x7FFF_FFFF and self._library.engine_hardware(
            self._engine, axis, name.encode(), value, self.is_on
        )
        if found == 1:
            raise KeyError(name)
        if found is False or found == 2:
            raise ValueError(f"{name} cannot be {value}")

    def report_can(self, now: int, event: Can) -> None:
        if self.is_on:
            self.advance(now)
            self._library.engine_can(self._engine, event)

    def _drain(self) -> None:
        """Take what waits in the queue."""
        while count := self._library.engine_take(self._engine, self._taken, _ROOM):
            for frame in self._taken[:count]:
                data = b"" if frame.remote else bytes(frame.data[: frame.length])
                self._sent.append(
                    Sent(frame.time, Frame(frame.id, data, bool(frame.remote), frame.length if frame.remote else 0))
                )


class CGroup:
    """Devices in C that share a bus and have power: what concerns all of them costs one call, however many they are."""

    def __init__(self, engines: Sequence[CEngine]) -> None:
        self._engines = engines
        self._library = engines[0]._library
        self._count = len(engines)
        self._pointers = (ctypes.c_void_p * len(engines))(*(engine._engine for engine in engines))
        self._places = {id(engine): place for place, engine in enumerate(engines)}

    @classmethod
    def of(cls, engines: Sequence[Engine]) -> CGroup | None:
        """Those with power as a group, if all of them are of one library."""
        live = [engine for engine in engines if isinstance(engine, CEngine) and engine.is_on]
        if not live or len(live) < sum(engine.is_on for engine in engines):
            return None
        return cls(live) if len({id(engine._library) for engine in live}) == 1 else None

    def next(self) -> int | None:
        at = self._library.engines_next(self._pointers, self._count)
        return None if at == _NEVER else int(at)

    def run(self, until: int) -> int:
        """Let time pass up to the first instant at which one of them sends something; gives that, or `until`."""
        return int(self._library.engines_run(self._pointers, self._count, until))

    def deliver(self, now: int, frame: Frame, origin: Engine | None) -> bool:
        """Bring a frame to all but one of them. True if somebody has sent something since."""
        place = self._places.get(id(origin), _NOBODY)
        answering: int = self._library.engines_deliver(
            self._pointers, self._count, place, now, frame.id, frame.dlc, frame.remote, frame.data
        )
        return answering > 0
