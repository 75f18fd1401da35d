"""Rows of tables: small immutable records with named columns."""

from __future__ import annotations

from .typing_support import dataclass_transform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn, Self


@dataclass_transform(kw_only_default=True, frozen_default=True)
class Row:
    """A record whose columns are the annotations of its class, given by keyword; a class attribute is a default.

    Type checkers treat it as a frozen dataclass. It is not one, because making a dataclass costs a hundred times as
    much as making this class. Two rows are equal when they are the same row of the same table.
    """

    def __init__(self, **columns: Any) -> None:
        known = type(self).__annotations__
        for name in columns:
            if name not in known:
                raise TypeError(f"{type(self).__name__} has no column {name!r}")
        for name in known:
            if name not in columns and not hasattr(type(self), name):
                raise TypeError(f"{type(self).__name__} lacks the column {name!r}")
        self.__dict__.update(columns)

    @classmethod
    def trusted(cls, columns: dict[str, Any]) -> Self:
        """A row of columns that are known to be right: those that a generated table gives."""
        row = cls.__new__(cls)
        row.__dict__.update(columns)
        return row

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"{name}: a {type(self).__name__} cannot be changed", name=name, obj=self)

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"{name}: a {type(self).__name__} cannot be changed", name=name, obj=self)

    def __repr__(self) -> str:
        columns = ", ".join(f"{name}={getattr(self, name)!r}" for name in type(self).__annotations__)
        return f"{type(self).__name__}({columns})"


class Named(Row):
    """A word and what it means: a reaction, a storage group, an event."""

    name: str
    title: str = ""
    text: str = ""


class Role(Row):
    """A value that runtimes know by name: a field of `scope` device, axis or pdo, an array where `count` > 1.

    `length` is that of a string type, in octets.
    """

    name: str
    scope: str
    type: str
    count: int = 1
    length: int = 0
    text: str = ""
