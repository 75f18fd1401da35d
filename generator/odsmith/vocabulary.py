"""The vocabulary: words of the standards and of the runtimes, which every device shares (spec/cia)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from odsmith.canopen_types import NOWHERE, DataType, Place, Source


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit with its exact scale: one count is `numerator/denominator` of `base`.

    `selected_by` names the object that chooses between several units (`options`: its value -> the unit's name);
    the scale given here is then the one of the default choice.
    """

    name: str
    symbol: str
    quantity: str
    base: str
    numerator: int
    denominator: int
    text: str
    selected_by: str = ""
    options: tuple[tuple[int, str], ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Named:
    """A word of a vocabulary: a storage group, a PDS event, an EMCY reaction."""

    name: str
    text: str
    title: str = ""
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Effect:
    """What writing an entry does. `to_driver`: the value is handed to the motor driver, by the index of its object."""

    name: str
    text: str
    title: str = ""
    to_driver: bool = False
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Condition:
    """A hardware condition or bus event that raises an emergency. `scope` says who has it."""

    name: str
    scope: Literal["axis", "device"]
    text: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Signature:
    """A magic number that a command object wants before it acts; `ascii` as the bytes stand on the bus."""

    name: str
    value: int
    text: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)

    @property
    def ascii(self) -> str:
        return self.value.to_bytes(4, "little").decode("ascii", "replace")


@dataclass(frozen=True, slots=True)
class Role:
    """A value that the runtimes know by name: a field of the runtime's struct for this scope.

    An entry with a role lives in that field. An entry without one is storage of the device alone, or a constant.
    `count` > 1 makes the field an array, whose elements the entries of a repeated sub-index fill in order.
    `effect` is the one that every writable entry with the role has; empty where any will do.
    """

    name: str
    scope: Literal["device", "axis", "pdo"]
    type: DataType
    text: str
    count: int = 1
    length: int = 0
    effect: str = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PdsState:
    """A state of the power drive system; `mask` and `value` decode it from the statusword."""

    name: str
    title: str
    mask: int
    value: int
    power: bool
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PdsCommand:
    """A controlword command: matches when `controlword & mask == value`; `edge` bits must just have risen."""

    name: str
    title: str
    mask: int
    value: int
    edge: int
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition of the PDS state machine. `start` is empty for the entry from power-on.

    `by` names commands (`Device.pds_commands`) or events (`Device.pds_events`), any of which takes it.
    """

    number: int
    start: tuple[str, ...]
    end: str
    by: tuple[str, ...]
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class NmtState:
    """An NMT state; `code` as the heartbeat carries it; `services` that run in it."""

    name: str
    code: int
    title: str
    services: tuple[str, ...]
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class NmtCommand:
    """An NMT node control command and the state it leads to."""

    name: str
    code: int
    to: str
    title: str
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class LedPattern:
    """What an LED does while `when` holds: `steady`, or on and off times in ms in turn, repeated, on first.

    Where several patterns apply the one of highest `priority` shows.
    """

    name: str
    title: str
    steady: Literal["", "on", "off"]
    phases: tuple[int, ...]
    when: tuple[str, ...]
    priority: int
    text: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Led:
    name: str
    title: str
    colour: str
    patterns: tuple[LedPattern, ...]
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RegisterBit:
    """A bit of the error register 1001h."""

    name: str
    bit: int
    text: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class AbortCode:
    """An SDO abort code of CiA 301, table 22; `used` and `why` say when this device gives it, or why never."""

    name: str
    code: int
    title: str
    used: bool
    why: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ModeCode:
    """A mode of operation as CiA 402 numbers it: `code` in 6060h, `bit` in 6502h (None for mode 0)."""

    name: str
    code: int
    bit: int | None
    short: str
    title: str
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, kw_only=True)
class Vocabulary:
    """The words of the standards and of the runtimes, which every device shares (generated/cia)."""

    identifier: str
    title: str
    roles: Mapping[str, Role]
    effects: Mapping[str, Effect]
    conditions: Mapping[str, Condition]
    reactions: Mapping[str, Named]
    register_bits: Mapping[str, RegisterBit]
    signatures: Mapping[str, Signature]
    abort_codes: tuple[AbortCode, ...]
    nmt_states: tuple[NmtState, ...]
    nmt_commands: tuple[NmtCommand, ...]
    leds: tuple[Led, ...]
    pds_states: tuple[PdsState, ...]
    pds_commands: tuple[PdsCommand, ...]
    pds_events: tuple[Named, ...]
    transitions: tuple[Transition, ...]
    mode_codes: tuple[ModeCode, ...]
    units: Mapping[str, Unit]
    digest: str = ""
