"""Values of the dictionary: where they are, their defaults, and the check of their range; the twin of `ods_od.c`.

The values are a row of instances: number 0 is the device, then follow the axes, the RPDOs and the TPDOs. An instance
holds the values that the runtime knows by name in an object of `odsmith_cia.values`; those of other entries stand in
their cells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import AbortCode
from odsmith_cia.values import AxisValues, DeviceValues, PdoValues

from .. import codec

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..dictionary import ObjectDictionary
    from ..entries import Entry, Object

    Values = DeviceValues | AxisValues | PdoValues

COMMUNICATION = range(0x1000, 0x2000)
"""The objects of the communication profile (CiA 301, 7.4.1)."""


class Cell:
    """An entry in one instance of its object, with the value that it has now.

    A number is kept as it is used: signed where its type is; a real number as its bits. A string or domain is octets.
    """

    __slots__ = (
        "_field",
        "_holder",
        "_kept",
        "_limits",
        "_position",
        "_value",
        "entry",
        "instance",
        "is_number",
        "signed",
        "size",
    )

    def __init__(self, entry: Entry[Any], instance: Instance) -> None:
        self.entry = entry
        self.instance = instance
        self.size = codec.size(entry.type)
        self.is_number = self.size > 0
        self.signed = codec.INTEGERS.get(entry.type, (0, False))[1]
        self._limits = entry.allowed
        if entry.type == "BOOLEAN" and not entry.allowed:
            self._limits = ((0, 1),)  # it takes eight bits on the bus, so it always has a range
        self._holder: Values | None = instance.values if entry.role else None
        self._field = entry.role
        self._position: int | None = None
        if self._holder is not None and isinstance(getattr(self._holder, self._field), list):
            self._position = entry.repeat
        self._kept = not entry.constant and not (entry.signatures and not entry.role)
        self._value: int | bytes = 0
        if not self.is_number:
            self.size = entry.length if self._kept else len(self._default_octets(0))

    @property
    def value(self) -> int | bytes:
        if self._holder is None:
            return self._value
        found: Any = getattr(self._holder, self._field)
        value: int | bytes = found if self._position is None else found[self._position]
        return value

    @value.setter
    def value(self, value: int | bytes) -> None:
        if self._holder is None:
            self._value = value
        elif self._position is None:
            setattr(self._holder, self._field, value)
        else:
            getattr(self._holder, self._field)[self._position] = value

    @property
    def octets(self) -> bytes:
        """The value as it goes over the bus."""
        value = self.value
        if isinstance(value, int):
            return (value & ((1 << 8 * self.size) - 1)).to_bytes(self.size, "little")
        return value.partition(b"\0")[0] if self.entry.type == codec.TEXT else value

    def number(self, octets: bytes) -> int:
        """The number that octets stand for."""
        return int.from_bytes(octets, "little", signed=self.signed)

    def write(self, octets: bytes) -> None:
        """Put a value in place: octets as many as the entry takes. What is constant stays what it is."""
        if not self._kept:
            return
        self.value = self.number(octets) if self.is_number else octets.ljust(self.size, b"\0")

    def set_default(self, node_id: int) -> None:
        """The value at power-on under a node-ID."""
        octets = self._default_octets(node_id)
        if self.is_number:
            self.value = self.number(octets)
        else:
            self.value = octets.ljust(self.size, b"\0") if self._kept else octets

    def check(self, number: int) -> int:
        """Whether the entry's limits allow a number: 0 or the abort code that says why not."""
        entry = self.entry
        if entry.signatures:
            known = any(number == signature for _, signature in entry.signatures)
            return 0 if known else AbortCode.NOT_STORED
        if not self._limits or any(low <= number <= high for low, high in self._limits):
            return 0
        if entry.listed:
            return AbortCode.INVALID_VALUE
        return AbortCode.VALUE_TOO_LOW if number < self._limits[0][0] else AbortCode.VALUE_TOO_HIGH

    def _default_octets(self, node_id: int) -> bytes:
        default = self.entry.stated_default
        if default is None:
            return bytes(codec.size(self.entry.type))
        if isinstance(default, tuple):
            number = default[1] + node_id
            return (number & ((1 << 8 * self.size) - 1)).to_bytes(self.size, "little")
        if isinstance(default, str):
            return default.encode()
        return codec.encode(self.entry.type, default)


class Instance:
    """The values of the device, of an axis or of a PDO. `cells` stand by index of axis 0, then by sub-index."""

    __slots__ = ("axis", "cells", "kind", "number", "ordinal", "values")

    def __init__(self, number: int, kind: str, ordinal: int, values: Any) -> None:
        self.number = number
        self.kind = kind  # device, axis, rpdo or tpdo
        self.ordinal = ordinal  # among those of its kind
        self.axis: int | None = ordinal if kind == "axis" else None
        self.values = values
        self.cells: list[Cell] = []


class Od:
    """All values of a device.

    `device`, `axes`, `rpdos` and `tpdos` are its instances' values; `instances` has the instances in their order.
    """

    def __init__(self, dictionary: ObjectDictionary) -> None:
        self.dictionary = dictionary
        counts = {"device": 1, "axis": 0, "rpdo": 0, "tpdo": 0}
        objects = sorted(dictionary.values(), key=lambda obj: (obj.base_index, obj.index))
        for obj in objects:
            kind = _kind_of(obj)
            counts[kind] = max(counts[kind], self._ordinal_of(obj) + 1)
        self.instances = tuple(_instances(counts))
        self.first = {kind: next(_starts(counts, kind)) for kind in counts}
        self.device: DeviceValues = self.instances[0].values
        self.axes: tuple[AxisValues, ...] = self._values_of("axis")
        self.rpdos: tuple[PdoValues, ...] = self._values_of("rpdo")
        self.tpdos: tuple[PdoValues, ...] = self._values_of("tpdo")
        self._cells: dict[tuple[int, int], Cell] = {}
        self._indices = set(dictionary.keys())
        for obj in objects:
            instance = self.instances[self.first[_kind_of(obj)] + self._ordinal_of(obj)]
            for entry in obj:
                cell = Cell(entry, instance)
                instance.cells.append(cell)
                self._cells[obj.index, entry.sub] = cell

    def find(self, index: int, sub: int) -> Cell | AbortCode:
        """The cell at an address of the bus, or the abort code that says why there is none."""
        cell = self._cells.get((index, sub))
        if cell is not None:
            return cell
        return AbortCode.NO_SUB_INDEX if index in self._indices else AbortCode.NO_OBJECT

    def set_defaults(self, node_id: int, communication_only: bool) -> None:
        """All values, or those of 1000h to 1FFFh alone, as the specification has them at power-on."""
        if not communication_only:
            for instance in self.instances:
                instance.values.__init__()  # fields that no entry of this device shows
        for instance in self.instances:
            for cell in instance.cells:
                if not communication_only or cell.entry.index in COMMUNICATION:
                    cell.set_default(node_id)

    def _values_of(self, kind: str) -> tuple[Any, ...]:
        return tuple(instance.values for instance in self.instances if instance.kind == kind)

    def _ordinal_of(self, obj: Object) -> int:
        """Which instance of its kind holds the values of an object."""
        if not obj.pdo:
            return obj.axis or 0
        each = self.dictionary.object_rows[obj.base_index][5]
        return (obj.axis or 0) * each + obj.number - 1


def _kind_of(obj: Object) -> str:
    if obj.pdo:
        return obj.pdo[:4]
    return "device" if obj.axis is None else "axis"


_VALUES = {"device": DeviceValues, "axis": AxisValues, "rpdo": PdoValues, "tpdo": PdoValues}


def _instances(counts: dict[str, int]) -> Iterator[Instance]:
    number = 0
    for kind, count in counts.items():
        for ordinal in range(count):
            yield Instance(number, kind, ordinal, _VALUES[kind]())
            number += 1


def _starts(counts: dict[str, int], wanted: str) -> Iterator[int]:
    start = 0
    for kind, count in counts.items():
        if kind == wanted:
            yield start
        start += count
