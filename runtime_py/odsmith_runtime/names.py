"""Entries as typed attributes: what the generated classes `DeviceObjects` and `AxisObjects` are made of.

A generated class declares one attribute per object,

    class AxisObjects(Names):
        controlword: Variable[Controlword] = Variable(0x6040)
        homing_speeds: Group[HomingSpeeds] = Group(0x6099, HomingSpeeds)

so that editors and type checkers know every name, and `axes[1].homing_speeds.fast` is an `Entry[int]` of axis 1. What
stands behind a name is made on first use. Another kind of holder, such as a client that talks to a device, can offer
the same names with its own things behind them: it overrides `Names._item`.
"""

from __future__ import annotations

from .typing_support import Generic, TypeVar

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, NoReturn, overload

    from .dictionary import ObjectDictionary
    from .entries import Entry

V = TypeVar("V")
N = TypeVar("N", bound="Names")


class Names:
    """The entries of the device, of one axis, or of one object of those."""

    _dictionary: ObjectDictionary
    _axis: int | None
    _base_index: int
    _number: int

    def __init__(self, dictionary: ObjectDictionary, axis: int | None, base_index: int = 0, number: int = 1) -> None:
        self.__dict__.update(_dictionary=dictionary, _axis=axis, _base_index=base_index, _number=number)

    def _item(self, base_index: int, sub: int) -> Any:
        """What stands behind the name of an entry: here the entry itself."""
        return self._dictionary.at(base_index, self._axis, self._number)[sub]

    def _group(self, names: type[N], base_index: int, number: int = 1) -> N:
        """The names within an object."""
        return names(self._dictionary, self._axis, base_index, number)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"{name!r} names an entry and cannot be replaced", name=name, obj=self)


class _Attribute:
    """A name in a class of names; what it stands for is made once for each holder."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, holder: Any, owner: type) -> Any:
        if holder is None:
            return self
        made = holder.__dict__[self.name] = self.make(holder)
        return made

    def make(self, holder: Names) -> Any:
        """What the name stands for in this holder; each kind of name has its own."""
        raise NotImplementedError


class Variable(_Attribute, Generic[V]):
    """An object without sub-indices; `V` is what its value is in Python."""

    def __init__(self, base_index: int) -> None:
        self.base_index = base_index

    def make(self, holder: Names) -> Any:
        return holder._item(self.base_index, 0)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Variable[V]: ...
        @overload
        def __get__(self, holder: Names, owner: type) -> Entry[V]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Sub(_Attribute, Generic[V]):
    """A sub-index of an array or record."""

    def __init__(self, sub: int) -> None:
        self.sub = sub

    def make(self, holder: Names) -> Any:
        return holder._item(holder._base_index, self.sub)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Sub[V]: ...
        @overload
        def __get__(self, holder: Names, owner: type) -> Entry[V]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Group(_Attribute, Generic[N]):
    """An array or record; `N` names its sub-indices."""

    def __init__(self, base_index: int, names: type[N]) -> None:
        self.base_index = base_index
        self.names = names

    def make(self, holder: Names) -> Any:
        return holder._group(self.names, self.base_index)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Group[N]: ...
        @overload
        def __get__(self, holder: Names, owner: type) -> N: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Family(_Attribute, Generic[N]):
    """A record that each PDO of an axis has: its names by number of the PDO, from 1."""

    def __init__(self, base_index: int, count: int, names: type[N]) -> None:
        self.base_index = base_index
        self.count = count
        self.names = names

    def make(self, holder: Names) -> Any:
        return {number: holder._group(self.names, self.base_index, number) for number in range(1, self.count + 1)}

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Family[N]: ...
        @overload
        def __get__(self, holder: Names, owner: type) -> Mapping[int, N]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...
