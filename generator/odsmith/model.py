"""The device model: what `resolve` makes of the YAML, and the only thing that backends see.

Every class is frozen; nothing downstream of `resolve` changes a model. Objects are kept *folded*: an axis is
written once and stands here once, however many axes the device has. `Device.expanded` offers the flat
dictionary that the bus sees.

Conventions: indices and sub-indices are integers, axes count from 0, `place` says where in the YAML an element
was written (it never takes part in comparisons), names are snake_case identifiers unique within their section.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from odsmith.canopen_types import NOWHERE, Access, DataType, ObjectType, PdoDirection, Place, Source
from odsmith.manual import Manual
from odsmith.vocabulary import Named, NmtState, Signature, Unit, Vocabulary


@dataclass(frozen=True, slots=True)
class Bit:
    """A bit (`low == high`) or a bit field of an integer."""

    low: int
    high: int
    name: str
    text: str
    supported: bool = True
    place: Place = field(default=NOWHERE, compare=False, repr=False)

    @property
    def mask(self) -> int:
        return ((1 << (self.high - self.low + 1)) - 1) << self.low

    @property
    def label(self) -> str:
        """`5`, or `16..23` for a field."""
        return str(self.low) if self.low == self.high else f"{self.low}..{self.high}"


@dataclass(frozen=True, slots=True)
class NamedValue:
    """One member of an enumeration. `nmt_state` is where an error leads with this choice of error behaviour (1029h)."""

    value: int
    name: str
    text: str
    nmt_state: str = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Allowed:
    """The values that a write may carry, as ascending closed intervals that do not touch: `0, 2..15` is
    `((0, 0), (2, 15))`.

    A `listed` set names its members (`0, 2..15`, or the keys of `values`): any other value is invalid (06090030h).
    One plain range is not listed: a value beside it is too low or too high (06090032h, 06090031h).
    """

    intervals: tuple[tuple[int, int], ...]
    listed: bool

    @property
    def low(self) -> int:
        return self.intervals[0][0]

    @property
    def high(self) -> int:
        return self.intervals[-1][1]

    @property
    def members(self) -> tuple[int, ...] | None:
        """The members in ascending order where every interval is short (at most 64 values in all), else None."""
        if sum(high - low + 1 for low, high in self.intervals) > 64:
            return None
        return tuple(value for low, high in self.intervals for value in range(low, high + 1))

    def __contains__(self, value: int) -> bool:
        return any(low <= value <= high for low, high in self.intervals)

    def __str__(self) -> str:
        return ", ".join(str(low) if low == high else f"{low}..{high}" for low, high in self.intervals)


@dataclass(frozen=True, slots=True)
class Default:
    """A power-on value: a number, plus the node-ID where the YAML says `$NODEID+...`; or text for string types."""

    number: int = 0
    node_id: bool = False
    text: str | None = None

    def value(self, node_id: int) -> int | str:
        """The value that a device with this node-ID holds after power-on."""
        if self.text is not None:
            return self.text
        return self.number + (node_id if self.node_id else 0)


@dataclass(frozen=True, slots=True)
class Entry:
    """One sub-index of an object.

    `default` is None where the source states none: the entry then powers on as 0 (or empty) and the EDS prints no
    DefaultValue. `hidden_default` is the reason why the EDS does not print a default that the model knows.
    `allowed` is None where any value of the type may be written. `repeat` is the ordinal (from 0) of an entry that
    was written once and repeated, per axis if `per_axis`. `constant` entries never change at run time.
    """

    sub: int
    name: str
    title: str
    parameter_name: str
    type: DataType
    access: Access
    mapping: PdoDirection
    default: Default | None
    text: str
    length: int = 0
    allowed: Allowed | None = None
    values: tuple[NamedValue, ...] = ()
    bits: tuple[Bit, ...] = ()
    signatures: tuple[Signature, ...] = ()
    writable_in: tuple[str, ...] = ()
    stored: str = "never"
    groups: tuple[str, ...] = ()
    effect: str = ""
    role: str = ""
    unit: Unit | None = None
    hidden_default: str = ""
    refuse_write_on_scan: bool = False
    repeat: int = 0
    per_axis: bool = False
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)

    @property
    def bit_length(self) -> int:
        """Length on the bus in bits; for strings the largest length."""
        return self.type.bits or 8 * self.length

    @property
    def constant(self) -> bool:
        """A read-only entry that no role moves: its value is its default for ever."""
        return not self.access.writable and not self.role

    @property
    def eds_access(self) -> str:
        """AccessType as CiA 306 spells it, PDO direction included."""
        if self.access is Access.RW and self.mapping is PdoDirection.RX:
            return "rww"
        if self.access is Access.RW and self.mapping is PdoDirection.TX:
            return "rwr"
        return self.access.value

    @property
    def eds_default(self) -> Default | None:
        """The default that the EDS prints, or None."""
        return None if self.hidden_default else self.default


PdoKind = Literal["rpdo", "tpdo"]

Scope = Literal["device", "axis", "rpdo", "tpdo"]
"""Whose value an entry is: the device's, an axis's, a PDO's."""

SCOPES: tuple[Scope, ...] = ("device", "axis", "rpdo", "tpdo")
"""In the order in which their values stand in memory."""


@dataclass(frozen=True, slots=True)
class Object:
    """One object of the dictionary, folded: over the axes (`stride` > 0) and, for PDO parameters, over the PDOs.

    `index` is that of axis 0. `pdo` is set for the parameter records of PDOs (1400h, 1600h, 1800h, 1A00h): such an
    object stands for `count` consecutive indices, one per PDO of an axis; its defaults are those of `Device.pdos`.
    """

    index: int
    name: str
    title: str
    parameter_name: str
    object_type: ObjectType
    entries: tuple[Entry, ...]
    text: str
    source: tuple[Source, ...]
    stride: int = 0
    count: int = 1
    pdo: Literal["", "rpdo_communication", "rpdo_mapping", "tpdo_communication", "tpdo_mapping"] = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)

    @property
    def per_axis(self) -> bool:
        return self.stride > 0

    @property
    def scope(self) -> Scope:
        """Whose values the object holds."""
        if self.pdo:
            return "rpdo" if self.pdo.startswith("rpdo") else "tpdo"
        return "axis" if self.per_axis else "device"

    @property
    def highest_sub(self) -> int:
        return self.entries[-1].sub

    def entry(self, sub: int) -> Entry | None:
        return next((entry for entry in self.entries if entry.sub == sub), None)


@dataclass(frozen=True, slots=True)
class PdoMapEntry:
    """One mapped entry of a PDO's default mapping, on axis 0."""

    object: Object
    entry: Entry

    @property
    def value(self) -> int:
        """The mapping entry as 1600h holds it: index, sub-index, bit length."""
        return self.object.index << 16 | self.entry.sub << 8 | self.entry.bit_length


@dataclass(frozen=True, slots=True)
class Pdo:
    """Power-on parameters of one PDO of axis 0 (`number` counts from 1 within the axis).

    The PDOs of the other axes have the same parameters with the axis's objects mapped and `other_axes_cob_id`.
    """

    kind: PdoKind
    number: int
    cob_id: Default
    other_axes_cob_id: Default
    transmission_type: int
    map: tuple[PdoMapEntry, ...]
    inhibit_time: int = 0
    event_timer: int = 0
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExpandedEntry:
    """An entry as one bus address sees it. `axis` is None for a device-wide object."""

    index: int
    entry: Entry
    axis: int | None
    default: Default | None

    @property
    def eds_default(self) -> Default | None:
        return None if self.entry.hidden_default else self.default


@dataclass(frozen=True, slots=True)
class ExpandedObject:
    """An object as the bus sees it: one index, its axis, and its name in the EDS (axis suffix from 1).

    `number` is the PDO number (1..512, `index - 1400h + 1`) of PDO parameter objects, else 0.
    """

    index: int
    object: Object
    axis: int | None
    number: int
    parameter_name: str
    title: str
    entries: tuple[ExpandedEntry, ...]

    @property
    def instance(self) -> tuple[int, int]:
        """The one thing whose values the object holds. Sorts as these stand in memory: the device, axis 0.., RPDO 1..,
        TPDO 1.."""
        return SCOPES.index(self.object.scope), self.number or self.axis or 0


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a recipe.

    `kind` and `arguments`: `write` ((object, sub, value), ...); `command` a PDS command's name as text; `expect`
    pairs such as ("state", "operation_enabled") or ("status_bit", "target_reached"); `wait` milliseconds; `input`
    pairs (input, 0/1). `added` names the erratum that made the step necessary where the manual lacks it.
    """

    kind: Literal["write", "command", "expect", "wait", "input"]
    arguments: tuple[tuple[str, int | str], ...]
    text: str = ""
    added: str = ""
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Recipe:
    name: str
    title: str
    text: str
    steps: tuple[Step, ...]
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode of operation. `bit` is its bit in 6502h, None for mode 0. `objects` are names of folded objects."""

    name: str
    code: int
    short: str
    title: str
    bit: int | None
    text: str
    control_bits: tuple[Bit, ...] = ()
    status_bits: tuple[Bit, ...] = ()
    objects: tuple[str, ...] = ()
    slow_down_ramp: str = ""
    recipes: tuple[Recipe, ...] = ()
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class HomingMethod:
    """A homing method of CiA 402. `direction` is the first one while the switch is inactive: -1, 0 or 1.

    `edge` is the direction in which the axis travels when it takes the edge; `switch` is negative_limit,
    positive_limit, home or none; `reverse_at` the limit switch that turns the search round.
    """

    name: str
    method: int
    title: str
    text: str
    switch: str
    direction: int
    edge: int
    index_pulse: bool
    reverse_at: str
    needs_power: bool
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RampParameter:
    """A parameter of the SixPoint ramp and the object that holds it."""

    name: str
    symbol: str
    object: str
    text: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Emergency:
    """One row of the emergency table.

    `bytes` are the five manufacturer bytes of the frame (CAN data bytes 3..7); the element "axis" stands for the axis
    number. `register` names bits of 1001h. `momentary` rows show in 1001h only while their frame is sent. `driver_flag`
    has the bit of the driver error flags that is set while the condition holds; 0: none.
    """

    name: str
    code: int
    title: str
    bytes: tuple[int | Literal["axis"], ...]
    register: tuple[str, ...]
    condition: str
    reaction: str
    momentary: bool
    driver_flag: int
    cause: str
    remedy: str
    source: tuple[Source, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)

    @property
    def per_axis(self) -> bool:
        return "axis" in self.bytes


@dataclass(frozen=True, slots=True)
class Erratum:
    """A contradiction in a manual and its ruling: what is printed, what the model says, why, on what evidence.

    `severity` is A (a value of the dictionary) or B (a behaviour). `paths` are the model paths that it decides.
    `vendor` is what the vendor's EDS says where ours differs: pairs of a kind of fact and its words.
    """

    id: str
    severity: Literal["A", "B", "C"]
    title: str
    printed: str
    modelled: str
    why: str
    evidence: str
    paths: tuple[str, ...]
    source: tuple[Source, ...] = ()
    vendor: tuple[tuple[str, str], ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Revision:
    """An entry of a revision history: firmware or model."""

    version: str
    date: str
    text: str


@dataclass(frozen=True, slots=True)
class AxisArea:
    """A range of indices: axis n has it at `first + n * stride`. Stride 0 is a range that stands once per device."""

    name: str
    first: int
    last: int
    stride: int
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class EdsInfo:
    """What only the EDS needs to know (CiA 306). Times `hh:mmAM`, dates `mm-dd-yyyy`, from the spec, not a clock."""

    file: str
    version: int
    revision: int
    description: str
    created_by: str
    creation_date: str
    creation_time: str
    modified_by: str
    modification_date: str
    modification_time: str
    comments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Identity:
    """The device as its name plate says it.

    `manual` is the one that sections and tables of sources refer to; `own_manual` is the device's own where that one
    describes its family. `vendor_eds` is the vendor's EDS file, if there is one to compare ours with.
    """

    identifier: str
    name: str
    title: str
    text: str
    version: str
    vendor: str
    vendor_id: int
    product_code: int
    revision_number: int
    order_code: str
    profile: int
    manual: str
    bit_rates: tuple[int, ...]
    digital_inputs: int
    digital_outputs: int
    analog_inputs: int
    analog_outputs: int
    eds: EdsInfo
    own_manual: str = ""
    vendor_eds: str = ""
    firmware: tuple[Revision, ...] = ()
    changes: tuple[Revision, ...] = ()
    place: Place = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, kw_only=True)
class Device(Vocabulary):
    """A whole device. `digest` is a hash of every fact in it: equal digests mean equal artefacts."""

    identity: Identity
    axes: int
    areas: tuple[AxisArea, ...]
    objects: tuple[Object, ...]
    pdos: tuple[Pdo, ...]
    max_pdo_entries: int
    modes: tuple[Mode, ...]
    homing_methods: tuple[HomingMethod, ...]
    ramp: tuple[RampParameter, ...]
    storage_groups: Mapping[str, Named]
    emergencies: tuple[Emergency, ...]
    errata: tuple[Erratum, ...]
    manuals: Mapping[str, Manual] = field(default_factory=dict)

    def object(self, name: str) -> Object | None:
        """The folded object of this name."""
        return self._by_name.get(name)

    @cached_property
    def _by_name(self) -> dict[str, Object]:
        return {obj.name: obj for obj in self.objects}

    @cached_property
    def error_behaviour(self) -> dict[int, NmtState]:
        """The NMT state that each value of error behaviour (1029h) leads to, ascending; others change nothing."""
        states = {state.name: state for state in self.nmt_states}
        named = (value for obj in self.objects for entry in obj.entries for value in entry.values)
        found = {value.value: states[value.nmt_state] for value in named if value.nmt_state}
        return dict(sorted(found.items()))

    @property
    def manual(self) -> Manual | None:
        """What the device's own manual contains, where the spec says it."""
        return self.manuals.get(self.identifier)

    def pdos_of(self, kind: PdoKind) -> tuple[Pdo, ...]:
        """The PDOs of axis 0 of one direction, ascending."""
        return tuple(pdo for pdo in self.pdos if pdo.kind == kind)

    def errata_of(self, path: str) -> tuple[Erratum, ...]:
        """Errata that decide `path` or anything below it, e.g. `objects.controlword`."""
        return tuple(
            erratum for erratum in self.errata if any(p == path or p.startswith(path + ".") for p in erratum.paths)
        )

    @cached_property
    def expanded(self) -> tuple[ExpandedObject, ...]:
        """Every object of the dictionary as the bus sees it, ascending by index."""
        return tuple(sorted(self._expand(), key=lambda item: item.index))

    @cached_property
    def record(self) -> tuple[ExpandedEntry, ...]:
        """The entries that are stored, in the order in which their values stand in non-volatile memory: instance by
        instance, there by index and sub-index."""
        objects = sorted(self.expanded, key=lambda item: item.instance)
        return tuple(item for obj in objects for item in obj.entries if item.entry.stored != "never")

    @cached_property
    def layout(self) -> int:
        """CRC-32 over the record: equal for two devices whose stored values mean the same.

        Stored values that carry another one are not read: they are from a firmware with other parameters.
        """
        lines = (
            f"{item.index:04X}:{item.entry.sub:02X} {item.entry.type} {item.entry.length} {item.entry.stored}\n"
            for item in self.record
        )
        return zlib.crc32("".join(lines).encode())

    def _expand(self) -> Iterator[ExpandedObject]:
        for obj in self.objects:
            for axis in range(self.axes) if obj.per_axis else (None,):
                for ordinal in range(obj.count):
                    yield self._expand_one(obj, axis, ordinal)

    def _expand_one(self, obj: Object, axis: int | None, ordinal: int) -> ExpandedObject:
        index = obj.index + (axis or 0) * obj.stride + ordinal
        number = (index & 0x1FF) + 1 if obj.pdo else 0
        suffix = f" {axis + 1}" if axis is not None and not obj.pdo else ""
        entries = tuple(
            ExpandedEntry(index, entry, axis, self._default(obj, entry, axis or 0, ordinal)) for entry in obj.entries
        )
        name = obj.parameter_name.replace("{number}", str(number)) + suffix
        title = obj.title.replace("{number}", str(number))
        return ExpandedObject(index, obj, axis, number, name, title, entries)

    def _default(self, obj: Object, entry: Entry, axis: int, ordinal: int) -> Default | None:
        """PDO parameters take their default from the table of PDOs, by the role of the entry."""
        if not obj.pdo or not entry.role:
            return entry.default
        kind: PdoKind = "rpdo" if obj.pdo.startswith("rpdo") else "tpdo"
        pdo = self.pdos_of(kind)[ordinal]
        if entry.role == "pdo_cob_id":
            return pdo.other_axes_cob_id if axis else pdo.cob_id
        if entry.role == "pdo_mapping":
            if entry.repeat >= len(pdo.map):
                return Default(0)
            mapped = pdo.map[entry.repeat]
            return Default(mapped.value + (axis * mapped.object.stride << 16))
        number = {
            "pdo_transmission_type": pdo.transmission_type,
            "pdo_inhibit_time": pdo.inhibit_time,
            "pdo_event_timer": pdo.event_timer,
            "pdo_mapped_count": len(pdo.map),
        }.get(entry.role)
        return entry.default if number is None else Default(number)
