"""A value in a device: what stands behind a name of a drive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from .waiting import run

if TYPE_CHECKING:
    from fractions import Fraction

    from ..entries import Entry
    from .async_values import AsyncValue, Field
    from .scale import Number

V = TypeVar("V")


class Value(Generic[V]):
    """One entry of a device: `entry` is its description, everything else asks the device.

    `raw` is the value as the bus has it, `phys` in the base unit of its unit, `desc` in words, `bits[...]` single bits
    or bit fields. Reading and writing raise SdoAborted and NoAnswerError, writing RefusedError before anything is sent.
    """

    def __init__(self, value: AsyncValue[V]) -> None:
        self._value = value
        self.entry: Entry[V] = value.entry

    def __repr__(self) -> str:
        return repr(self._value)

    def read(self) -> V:
        """The value: an int, text or octets, a member of its enumeration, its bits."""
        return run(self._value.read())

    def write(self, value: V | int) -> None:
        """Write the value. Raises RefusedError if the device would not take it."""
        run(self._value.write(value))

    @property
    def raw(self) -> V:
        """The value as the bus has it."""
        return self.read()

    @raw.setter
    def raw(self, value: V | int) -> None:
        self.write(value)

    @property
    def phys(self) -> Fraction:
        """The value in its base unit, exactly."""
        return run(self._value.read_phys())

    @phys.setter
    def phys(self, amount: Number) -> None:
        run(self._value.write_phys(amount))

    @property
    def desc(self) -> str:
        """The value in words."""
        return run(self._value.read_desc())

    @desc.setter
    def desc(self, name: str) -> None:
        run(self._value.write_desc(name))

    @property
    def bits(self) -> BitView:
        """Its bits: `value.bits["halt"]`, `value.bits[Controlword.HALT]`, `value.bits[8]`."""
        return BitView(self._value)

    def read_phys(self) -> Fraction:
        """The value in its base unit, exactly: `phys`."""
        return self.phys

    def write_phys(self, amount: Number) -> None:
        """Write the value that comes nearest to an amount of its base unit: `phys`."""
        self.phys = amount

    def read_desc(self) -> str:
        """The value in words: `desc`."""
        return self.desc

    def write_desc(self, name: str) -> None:
        """Write the value that has this name: `desc`. Raises ValueError for a name that there is not."""
        self.desc = name

    def read_bits(self, field: Field) -> int:
        """The number in a bit field: `bits[field]`."""
        return self.bits[field]

    def write_bits(self, field: Field, number: int) -> None:
        """Read the value, write it with another number in a bit field. Raises ValueError where it does not fit."""
        self.bits[field] = number


class BitView:
    """The bits of a value in a device. Each access reads; each assignment reads and writes."""

    def __init__(self, value: AsyncValue[V]) -> None:
        self._value = value

    def __getitem__(self, field: Field) -> int:
        return run(self._value.read_bits(field))

    def __setitem__(self, field: Field, number: int) -> None:
        run(self._value.write_bits(field, number))
