"""What can be wrong with a name, an index or a value, said in terms of the object that it concerns."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .entries import Entry


class NoSuchObjectError(KeyError):
    """The dictionary has no such index, sub-index or name."""

    def __str__(self) -> str:  # KeyError shows its argument in quotes, as if it were the key
        return str(self.args[0]) if self.args else ""


class RefusedError(ValueError):
    """A value that an entry does not take.

    `entry` is the entry, `value` the value, `axis` the axis (None for the whole device), `limit` what would be right.
    """

    def __init__(self, entry: Entry[Any], value: object, limit: str) -> None:
        super().__init__(f"{entry.label}: {limit}")
        self.entry = entry
        self.axis = entry.axis
        self.value = value
        self.limit = limit


class ReadOnlyError(RefusedError):
    """The entry cannot be written."""


class WrongTypeError(RefusedError, TypeError):
    """The value is not of the kind that the entry's type is for, such as text for a number."""


class WrongLengthError(RefusedError):
    """Too many octets, or octets that are not as many as the type has."""


class OutOfRangeError(RefusedError):
    """The value is outside the range of the entry, or not in its set."""


class WrongSignatureError(RefusedError):
    """The entry acts on a signature only, and the value is none that it knows."""
