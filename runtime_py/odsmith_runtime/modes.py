"""What a drive can do: modes of operation, homing methods, ramp parameters (CiA 402)."""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from .choices import Bits


class ModeInfo(Row):
    """A mode of operation.

    `code` is written to 6060h, `bit` is its bit in 6502h (None for no mode). `controlword` and `statusword` are the
    bits of these words in this mode, those that all modes share included; None where the device has no such word.
    `objects` are the names of the objects that it works with, `slow_down_ramp` the one that holds its deceleration.
    """

    name: str
    code: int
    short: str
    title: str
    bit: int | None
    controlword: type[Bits] | None
    statusword: type[Bits] | None
    objects: tuple[str, ...]
    slow_down_ramp: str = ""
    text: str = ""
    source: str = ""


class HomingMethodInfo(Row):
    """A homing method of CiA 402.

    `switch` is negative_limit, positive_limit, home or none; `direction` the way the axis sets out while the switch is
    inactive, `edge` the way in which it takes the edge: -1, 0 or 1. `reverse_at` is the limit switch that turns the
    search round.
    """

    name: str
    method: int
    title: str
    switch: str
    direction: int
    edge: int
    reverse_at: str
    index_pulse: bool
    needs_power: bool
    text: str = ""
    source: str = ""


class RampParameter(Row):
    """A parameter of the ramp generator, by its symbol, and the name of the object that holds it."""

    name: str
    symbol: str
    object: str
    text: str = ""
    source: str = ""
