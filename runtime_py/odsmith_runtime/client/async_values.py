"""A value in a device, for asyncio: what stands behind a name of an asynchronous drive."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from ..choices import Bits
    from ..entries import Entry
    from .access import Access
    from .scale import Number

V = TypeVar("V")


class AsyncValue(Generic[V]):
    """One entry of a device: `entry` is its description, everything else asks the device.

    `await value.raw` reads, `await value.write(...)` writes; the same for `phys`, `desc` and bits. All of it raises
    SdoAborted and NoAnswerError, writing RefusedError before anything is sent.
    """

    def __init__(self, access: Access, entry: Entry[V]) -> None:
        self._access = access
        self.entry = entry

    def __repr__(self) -> str:
        return f"<{self.entry.label} of node {self._access.link.id}>"

    def __setattr__(self, name: str, value: object) -> None:
        if name in ("raw", "phys", "desc", "bits"):
            raise AttributeError(f"{name} cannot be assigned: nobody would wait for it; use `await ....write(...)`")
        super().__setattr__(name, value)

    # ---- as the bus has it -------------------------------------------------------------------------------------------

    async def read(self) -> V:
        """The value: an int, text or octets, a member of its enumeration, its bits."""
        value: V = await self._access.read(self.entry)
        return value

    async def write(self, value: V | int) -> None:
        """Write the value. Raises RefusedError if the device would not take it."""
        await self._access.write(self.entry, value)

    @property
    def raw(self) -> Coroutine[Any, Any, V]:
        """The value as the bus has it; a coroutine, to be awaited."""
        return self.read()

    # ---- in its base unit --------------------------------------------------------------------------------------------

    async def read_phys(self) -> Fraction:
        """The value in the base unit of its unit, exactly: seconds of a time in ms, pps of an internal velocity."""
        unit = await self._access.unit(self.entry)
        count: Any = await self.read()
        return unit.to_base(count) if unit else Fraction(count)

    async def write_phys(self, amount: Number) -> None:
        """Write the value that comes nearest to an amount of the base unit."""
        unit = await self._access.unit(self.entry)
        await self.write(unit.from_base(amount) if unit else round(Fraction(amount)))

    @property
    def phys(self) -> Coroutine[Any, Any, Fraction]:
        """The value in its base unit, exactly; a coroutine, to be awaited."""
        return self.read_phys()

    # ---- in words ----------------------------------------------------------------------------------------------------

    async def read_desc(self) -> str:
        """The name of the value, of each bit that is set, or the number with its unit."""
        return describe(self.entry, await self.read())

    async def write_desc(self, name: str) -> None:
        """Write the value that has this name. Raises ValueError for a name that there is not."""
        values = self.entry.values
        members = {member.name.lower(): member for member in values or ()}
        if name.lower() not in members:
            known = ", ".join(members) or "none has"
            raise ValueError(f"{self.entry.label}: no value is called {name!r}; names: {known}")
        await self.write(int(members[name.lower()]))

    @property
    def desc(self) -> Coroutine[Any, Any, str]:
        """The value in words; a coroutine, to be awaited."""
        return self.read_desc()

    # ---- bit by bit --------------------------------------------------------------------------------------------------

    async def read_bits(self, field: Field) -> int:
        """The number in a bit field, which is a member of the bits, its name, or the number of a single bit."""
        mask, low = self._field(field)
        value: Any = await self.read()
        return (int(value) & mask) >> low

    async def write_bits(self, field: Field, number: int) -> None:
        """Read the value, write it with another number in a bit field. Raises ValueError where it does not fit."""
        mask, low = self._field(field)
        if number < 0 or number << low & ~mask:
            raise ValueError(f"{self.entry.label}: {number} does not fit into {field!r}")
        value: Any = await self.read()
        await self.write(int(value) & ~mask | number << low)

    def _field(self, field: Field) -> tuple[int, int]:
        """Mask and lowest bit."""
        if isinstance(field, str):
            known = self.entry.bits.__members__ if self.entry.bits else {}
            if field.upper() not in known:
                raise ValueError(f"{self.entry.label}: no bits are called {field!r}; names: {_lower(known)}")
            field = known[field.upper()]
        mask = field.value if hasattr(field, "value") else 1 << field
        return mask, (mask & -mask).bit_length() - 1


if TYPE_CHECKING:
    Field = Bits | str | int


def describe(entry: Entry[Any], value: Any) -> str:
    """A value in words."""
    if entry.bits is not None:
        names = (name for name, member in entry.bits.__members__.items() if int(value) & member.value)
        return ", ".join(name.lower() for name in names) or "none"
    if hasattr(value, "name"):
        return str(value.name).lower()
    return f"{value} {entry.unit.symbol}" if entry.unit else str(value)


def _lower(names: Any) -> str:
    return ", ".join(name.lower() for name in names) or "none has"
