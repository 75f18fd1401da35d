"""Bases of the generated enumerations. A member is a number, or a word, that also knows what it means."""

from __future__ import annotations

from enum import IntEnum, IntFlag, StrEnum

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Self


class Choice(IntEnum):
    """A value that has a name: `SPREAD_CYCLE = 0, "what it does"`."""

    _value_: int
    text: str

    def __new__(cls, value: int, text: str = "") -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.text = text
        return member


class Bits(IntFlag):
    """A set of bits: `HALT = 1 << 8, "what it does"`; a field of several bits is their mask.

    `supported` is False for a bit that the standard defines and the device ignores. Unnamed bits are kept.
    """

    _value_: int

    def __new__(cls, value: int, text: str = "", supported: bool = True) -> Self:
        member = int.__new__(cls, value)
        member._value_ = value
        member.__dict__.update(_text=text, _supported=supported)
        return member

    @property
    def text(self) -> str:
        """What the bit means; of several bits, what each of them means."""
        own: str | None = self.__dict__.get("_text")
        if own is not None:
            return own
        return " ".join(member.text for member in type(self).__members__.values() if member & self)

    @property
    def supported(self) -> bool:
        """False for a bit that the standard defines and the device ignores."""
        own: bool = self.__dict__.get("_supported", True)
        return own

    @property
    def low(self) -> int:
        """Number of the lowest bit, -1 where none is set."""
        return (self._value_ & -self._value_).bit_length() - 1

    @property
    def high(self) -> int:
        """Number of the highest bit, -1 where none is set."""
        return self._value_.bit_length() - 1

    def field(self, member: Self) -> int:
        """The number that stands in a bit field of this value: `outputs.field(Outputs.CHANNELS)`."""
        return (self._value_ & member._value_) >> member.low

    def with_field(self, member: Self, number: int) -> Self:
        """This value with another number in a bit field. Raises ValueError where it does not fit."""
        mask = member._value_
        if number < 0 or (number << member.low) & ~mask:
            raise ValueError(f"{number} does not fit into {member.name}, bits {member.low}..{member.high}")
        return type(self)(self._value_ & ~mask | number << member.low)


class Word(StrEnum):
    """A name of the vocabulary: `SHUTDOWN = "shutdown", "what it does"`."""

    _value_: str
    text: str

    def __new__(cls, value: str, text: str = "") -> Self:
        member = str.__new__(cls, value)
        member._value_ = value
        member.text = text
        return member


class EffectWord(Word):
    """The name of an effect; `to_driver` if the motor driver is told the value, by the index of its object."""

    to_driver: bool

    def __new__(cls, value: str, text: str = "", to_driver: bool = False) -> Self:
        member = str.__new__(cls, value)
        member._value_ = value
        member.text = text
        member.to_driver = to_driver
        return member
