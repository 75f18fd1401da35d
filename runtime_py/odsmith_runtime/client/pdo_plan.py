"""Which PDOs a device shall have: a plan, whether the device can have it, and how busy the bus gets.

    plan = [
        Rpdo(x.controlword, x.target_position, on_sync=True),
        Tpdo(x.statusword, x.position_actual_value),
    ]

Nothing here talks to a device.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from ..entries import Entry
from .errors import PlanError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import TypeAlias

    from ..dictionary import ObjectDictionary
    from ..pdos import Pdo as PdoRecord
    from .async_values import AsyncValue
    from .values import Value

    Named: TypeAlias = Entry[Any] | Value[Any] | AsyncValue[Any]

EVENT_DRIVEN = 255
MOST_BITS = 64
_FREE_CAN_IDS = range(0x680, 0x6E0)
"""CAN-IDs that the predefined connection set leaves to anybody (CiA 301, clause 7.3.3)."""

_RESTRICTED = (
    range(0x080),
    range(0x080, 0x081),
    range(0x101, 0x181),
    range(0x581, 0x600),
    range(0x601, 0x680),
    range(0x6E0, 0x800),
)
"""CAN-IDs that no PDO may have (CiA 301, clause 7.3.5), with that of SYNC."""


class Mapped:
    """A PDO that maps these entries, of which the first one says the axis whose PDO it becomes.

    `on_sync`: applied or sent at every n-th SYNC, True is 1; otherwise at once, or when something changes. `cob_id`
    is its CAN-ID; without one, axis 0 has those of the predefined connection set and others free ones from 680h on.
    """

    kind = ""

    def __init__(
        self,
        *entries: Named,
        on_sync: int = 0,
        cob_id: int | None = None,
        inhibit_time: float = 0.0,
        event_timer: float = 0.0,
    ) -> None:
        self.entries: tuple[Entry[Any], ...] = tuple(
            item if isinstance(item, Entry) else item.entry for item in entries
        )
        self.on_sync = int(on_sync)
        self.cob_id = cob_id
        self.inhibit_time = inhibit_time
        self.event_timer = event_timer

    @property
    def bits(self) -> int:
        """Length of what it maps, in bits."""
        return sum(entry.bit_length for entry in self.entries)


class Rpdo(Mapped):
    """What the drive receives."""

    kind = "rpdo"


class Tpdo(Mapped):
    """What the drive sends. `inhibit_time` is the least time between two frames, `event_timer` the longest, in s."""

    kind = "tpdo"


class Place(NamedTuple):
    """A PDO of a plan, the record of the device that it fills, and its CAN-ID."""

    mapped: Mapped
    record: PdoRecord
    can_id: int

    @property
    def octets(self) -> int:
        return (self.mapped.bits + 7) // 8

    @property
    def label(self) -> str:
        axis = "" if self.record.axis is None else f" of axis {self.record.axis}"
        return f"{self.record.kind.upper()} {self.record.number}{axis}"


def place(plan: Iterable[Mapped], dictionary: ObjectDictionary, node_id: int) -> tuple[Place, ...]:
    """A place for each PDO of a plan. Raises PlanError with everything that is wrong with it."""
    wrong: list[str] = []
    places: list[Place] = []
    slots = {(kind, axis): list(_slots(dictionary, kind, axis)) for kind, axis in _families(dictionary)}
    taken: dict[int, str] = {}
    wanted = list(plan)
    free = iter(can_id for can_id in _FREE_CAN_IDS if can_id not in [mapped.cob_id for mapped in wanted])
    for mapped in wanted:
        what = f"{mapped.kind.upper()} with {', '.join(entry.full_name for entry in mapped.entries) or 'nothing'}"
        wrong += (f"{what}: {problem}" for problem in _problems(mapped, dictionary))
        axis = mapped.entries[0].axis if mapped.entries else None
        if axis is None and dictionary.axis_count:
            axis = 0
        records = slots.get((mapped.kind, axis), [])
        if not records:
            wrong.append(
                f"{what}: {'the device' if axis is None else f'axis {axis}'} has no {mapped.kind.upper()} left"
            )
            continue
        record = records.pop(0)
        default = record.communication["cob_id"].default(node_id) or 0
        can_id = mapped.cob_id
        if can_id is None:
            can_id = default & 0x7FF or next(free, 0)
        if not 0 < can_id <= 0x7FF or any(can_id in area for area in _RESTRICTED):
            wrong.append(f"{what}: the CAN-ID {can_id:03X}h is not for PDOs (CiA 301, 7.3.5)")
        placed = Place(mapped, record, can_id)
        if can_id in taken:
            wrong.append(f"{what}: the CAN-ID {can_id:03X}h is that of {taken[can_id]} already")
        taken[can_id] = placed.label
        places.append(placed)
    if wrong:
        raise PlanError("; ".join(wrong))
    return tuple(places)


def _problems(mapped: Mapped, dictionary: ObjectDictionary) -> Iterator[str]:
    if not mapped.entries:
        yield "it maps nothing"
    if len(mapped.entries) > dictionary.max_pdo_entries:
        yield f"{len(mapped.entries)} entries, a PDO of this device takes {dictionary.max_pdo_entries}"
    if mapped.bits > MOST_BITS:
        yield f"{mapped.bits} bits, a PDO has {MOST_BITS}"
    if not 0 <= mapped.on_sync <= 240:
        yield f"on_sync is 0 to 240, not {mapped.on_sync}"
    for entry in mapped.entries:
        if not (entry.receivable if mapped.kind == "rpdo" else entry.transmittable):
            direction = "received" if mapped.kind == "rpdo" else "sent"
            yield f"{entry.label} cannot be {direction} in a PDO"


def _families(dictionary: ObjectDictionary) -> set[tuple[str, int | None]]:
    return {(record.kind, record.axis) for record in dictionary.pdos}


def _slots(dictionary: ObjectDictionary, kind: str, axis: int | None) -> Iterator[PdoRecord]:
    return (record for record in dictionary.pdos if record.kind == kind and record.axis == axis)


# ---- bus load --------------------------------------------------------------------------------------------------------


def frame_bits(octets: int) -> int:
    """The longest that a data frame with 11 bit CAN-ID and so many octets can get, stuff bits and the gap included."""
    return 47 + 8 * octets + (34 + 8 * octets - 1) // 4


class Load(NamedTuple):
    """One sender of frames: `rate` in frames per second, None where it sends when something changes."""

    label: str
    can_id: int
    octets: int
    rate: float | None


class BusLoad:
    """How busy the PDOs of a plan make the bus. As text, a table; `ratio` is 1.0 for a full bus.

    What is sent on change alone is not counted, as nobody knows how often that is.
    """

    def __init__(self, places: Iterable[Place], sync_period: float, bit_rate: int) -> None:
        self.bit_rate = bit_rate
        self.loads = [Load("SYNC", 0x080, 0, 1 / sync_period)] if sync_period else []
        self.loads += (Load(each.label, each.can_id, each.octets, _rate(each.mapped, sync_period)) for each in places)

    @property
    def ratio(self) -> float:
        """The share of time that the bus is busy: 1.0 is all of it."""
        return sum(frame_bits(load.octets) * load.rate for load in self.loads if load.rate) / self.bit_rate

    def __str__(self) -> str:
        lines = [f"{'':22}CAN-ID octets  frames/s   load"]
        for load in self.loads:
            if load.rate is None:
                lines.append(f"{load.label:22}  {load.can_id:03X}h {load.octets:6} on change")
            else:
                share = frame_bits(load.octets) * load.rate / self.bit_rate
                lines.append(f"{load.label:22}  {load.can_id:03X}h {load.octets:6} {load.rate:9.1f} {share:6.2%}")
        lines.append(f"{f'all at {self.bit_rate // 1000} kbit/s':46}{self.ratio:6.2%}")
        return "\n".join(lines)


def _rate(mapped: Mapped, sync_period: float) -> float | None:
    if mapped.on_sync:
        return 1 / (sync_period * mapped.on_sync) if sync_period else None
    return 1 / mapped.event_timer if mapped.event_timer else None
