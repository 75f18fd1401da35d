"""Entries as typed attributes: what the generated classes `DeviceObjects` and `AxisObjects` are made of.

A generated class declares one attribute per object,

    class AxisObjects(Names[H]):
        controlword: Variable[Controlword] = Variable(0x6040)
        homing_speeds: Group[HomingSpeeds[H]] = Group(0x6099, HomingSpeeds)

so that editors and type checkers know every name, and `axes[1].homing_speeds.fast` is an `Entry[int]` of axis 1. What
stands behind a name is made on first use. A client that talks to a device offers the same names with other things
behind them: it is made with a function from an entry to that thing, and `H` tells type checkers which it is.
"""

from __future__ import annotations

from .typing_support import Generic, TypeVar

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any, overload

    from typing_extensions import TypeVar as TypeVarWithDefault

    from .client.async_values import AsyncValue
    from .client.values import Value
    from .dictionary import ObjectDictionary
    from .entries import Entry

    H = TypeVarWithDefault("H", default="Described")
else:
    H = TypeVar("H")

V = TypeVar("V")
N = TypeVar("N", bound="Names[Any]")


class Described:
    """Behind a name stands the description of an entry, an `Entry`."""


class Live:
    """Behind a name stands the value in a device, a `Value`."""


class AsyncLive:
    """Behind a name stands the value in a device for asyncio, an `AsyncValue`."""


class Names(Generic[H]):
    """The entries of the device, of one axis, or of one object of those.

    `behind` makes of an entry what stands behind its name; without it that is the entry itself.
    """

    _dictionary: ObjectDictionary
    _axis: int | None
    _base_index: int
    _number: int
    _behind: Callable[[Entry[Any]], Any] | None

    def __init__(
        self,
        dictionary: ObjectDictionary,
        axis: int | None,
        base_index: int = 0,
        number: int = 1,
        behind: Callable[[Entry[Any]], Any] | None = None,
    ) -> None:
        self._dictionary = dictionary
        self._axis = axis
        self._base_index = base_index
        self._number = number
        self._behind = behind

    def _item(self, base_index: int, sub: int) -> Any:
        """What stands behind the name of an entry."""
        entry = self._dictionary.at(base_index, self._axis, self._number)[sub]
        return self._behind(entry) if self._behind else entry

    def _group(self, names: type[N], base_index: int, number: int = 1) -> N:
        """The names within an object."""
        return names(self._dictionary, self._axis, base_index, number, self._behind)

    def __setattr__(self, name: str, value: object) -> None:
        if not name.startswith("_"):
            raise AttributeError(f"{name!r} names an entry and cannot be replaced", name=name, obj=self)
        self.__dict__[name] = value


class _Attribute:
    """A name in a class of names; what it stands for is made once for each holder."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, holder: Any, owner: type) -> Any:
        if holder is None:
            return self
        made = holder.__dict__[self.name] = self.make(holder)
        return made

    def make(self, holder: Names[Any]) -> Any:
        """What the name stands for in this holder; each kind of name has its own."""
        raise NotImplementedError


class Variable(_Attribute, Generic[V]):
    """An object without sub-indices; `V` is what its value is in Python."""

    def __init__(self, base_index: int) -> None:
        self.base_index = base_index

    def make(self, holder: Names[Any]) -> Any:
        return holder._item(self.base_index, 0)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Variable[V]: ...
        @overload
        def __get__(self, holder: Names[Described], owner: type) -> Entry[V]: ...
        @overload
        def __get__(self, holder: Names[Live], owner: type) -> Value[V]: ...
        @overload
        def __get__(self, holder: Names[AsyncLive], owner: type) -> AsyncValue[V]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Sub(_Attribute, Generic[V]):
    """A sub-index of an array or record."""

    def __init__(self, sub: int) -> None:
        self.sub = sub

    def make(self, holder: Names[Any]) -> Any:
        return holder._item(holder._base_index, self.sub)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Sub[V]: ...
        @overload
        def __get__(self, holder: Names[Described], owner: type) -> Entry[V]: ...
        @overload
        def __get__(self, holder: Names[Live], owner: type) -> Value[V]: ...
        @overload
        def __get__(self, holder: Names[AsyncLive], owner: type) -> AsyncValue[V]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Group(_Attribute, Generic[N]):
    """An array or record; `N` names its sub-indices."""

    def __init__(self, base_index: int, names: type[N]) -> None:
        self.base_index = base_index
        self.names = names

    def make(self, holder: Names[Any]) -> Any:
        return holder._group(self.names, self.base_index)

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Group[N]: ...
        @overload
        def __get__(self, holder: Names[Any], owner: type) -> N: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...


class Family(_Attribute, Generic[N]):
    """A record that each PDO of an axis has: its names by number of the PDO, from 1."""

    def __init__(self, base_index: int, count: int, names: type[N]) -> None:
        self.base_index = base_index
        self.count = count
        self.names = names

    def make(self, holder: Names[Any]) -> Any:
        return {number: holder._group(self.names, self.base_index, number) for number in range(1, self.count + 1)}

    if TYPE_CHECKING:

        @overload
        def __get__(self, holder: None, owner: type) -> Family[N]: ...
        @overload
        def __get__(self, holder: Names[Any], owner: type) -> Mapping[int, N]: ...
        def __get__(self, holder: Any, owner: type) -> Any: ...
