"""The object dictionary of a device: compact tables, folded over the axes, that make objects when they are asked for.

An axis is written once. An index is split into an axis and the index on axis 0, and one row serves all axes; the
records of PDO parameters are folded once more, one row for all PDOs of a direction.

Rows, as a generated package writes them:

- `objects`: base index -> (name, title, EDS name, object type, stride, how many consecutive indices, PDO record);
- `entries`: base index and sub-index, `0x6040_00` -> (type, access, PDO mapping, default, then pairs of a column of
  `Entry` and its value); a default is a number, text, None where none is stated, or ("$NODEID", offset);
- `pdos`: (direction, number from 1) -> (COB-ID, COB-ID on the other axes, transmission type, inhibit time, event timer,
  mapped entries on axis 0 as PDO mapping objects hold them).
"""

from __future__ import annotations

from .typing_support import Generic, TypeVar

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from typing import Any

    from .choices import Bits, Choice
    from .entries import Entry, Object
    from .pdos import Pdo
    from .units import Unit

    Default = int | str | tuple[str, int] | None
    ObjectRow = tuple[str, str, str, str, int, int, str]
    EntryRow = tuple[Any, ...]
    PdoRow = tuple[Default, Default, int, int, int, tuple[int, ...]]

D = TypeVar("D")
A = TypeVar("A")


class ObjectDictionary(Generic[D, A]):
    """All objects of a device.

    By index `dictionary[0x6840]`, by name `dictionary["controlword"]` (of axis 0), by EDS name
    `dictionary["Controlword 2"]`; by name and axis with `object`. Iterating gives the indices of all axes, ascending.

    `device` and `axes[n]` offer the entries as typed attributes, `axes[1].homing_speeds.fast`; `D` and `A` are the
    classes that the generated package declares for them. Axes count from 0 everywhere but in EDS names.
    """

    def __init__(
        self,
        package: str,
        *,
        axis_count: int,
        areas: tuple[tuple[int, int, int], ...],
        objects: Mapping[int, ObjectRow],
        entries: Mapping[int, EntryRow],
        pdos: Mapping[tuple[str, int], PdoRow],
        max_pdo_entries: int,
    ) -> None:
        self.package = package
        self.axis_count = axis_count
        self.max_pdo_entries = max_pdo_entries
        self._areas = areas
        self._objects = objects
        self._entries = entries
        self._pdos = pdos
        self._made: dict[int, Object] = {}
        self._cache: dict[str, Any] = {}

    # ---- by index and by name ----------------------------------------------------------------------------------------

    def __getitem__(self, key: int | str) -> Object:
        """The object of an index, a name (on axis 0) or an EDS name. Raises NoSuchObjectError."""
        found = self.get(key)
        if found is None:
            raise self._missing(f"{key:04X}h" if isinstance(key, int) else repr(key))
        return found

    def get(self, key: int | str) -> Object | None:
        """The same, but None for what is not there."""
        if isinstance(key, int):
            made = self._made.get(key)
            return made if made is not None else self._make(key)
        index = self._index_of_name.get(key)
        if index is None:
            index = self._index_of_parameter_name.get(key)
        return None if index is None else self[index]

    def object(self, name: str, axis: int | None = None, number: int = 1) -> Object:
        """The object called `name` of an axis; without `axis` that of axis 0 or of the whole device.

        `number` chooses the PDO of the axis, from 1, for objects that describe PDOs. Raises NoSuchObjectError.
        """
        base = self._index_of_name.get(name)
        if base is None:
            raise self._missing(repr(name))
        stride, count = self._objects[base][4:6]
        if axis is not None and not (0 <= axis < self.axis_count and stride):
            raise self._missing(f"{name!r} of axis {axis}")
        if not 1 <= number <= count:
            raise self._missing(f"{name!r} number {number}")
        return self[base + (axis or 0) * stride + number - 1]

    def entry(self, name: str, axis: int | None = None, number: int = 1) -> Entry[Any]:
        """The entry of a dotted name: `controlword`, `homing_speeds.fast`. Raises NoSuchObjectError."""
        object_name, _, entry_name = name.partition(".")
        obj = self.object(object_name, axis, number)
        return obj[entry_name] if entry_name else obj[0]

    def __contains__(self, key: object) -> bool:
        return isinstance(key, (int, str)) and self.get(key) is not None

    def __iter__(self) -> Iterator[int]:
        return iter(self._indices)

    def __len__(self) -> int:
        return len(self._indices)

    def keys(self) -> tuple[int, ...]:
        """All indices, ascending."""
        return self._indices

    def values(self) -> Iterator[Object]:
        """All objects, ascending by index."""
        return (self[index] for index in self._indices)

    def items(self) -> Iterator[tuple[int, Object]]:
        return ((index, self[index]) for index in self._indices)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.package}: {len(self)} objects, {self.axis_count} axes>"

    def fold(self, index: int) -> tuple[int, int | None]:
        """Index on axis 0 and axis of an index; the axis is None outside the areas that repeat."""
        for first, last, stride in self._areas:
            axis, offset = divmod(index - first, stride)
            if 0 <= axis < self.axis_count and offset <= last - first:
                return first + offset, axis
        return index, None

    # ---- typed names -------------------------------------------------------------------------------------------------

    @property
    def device(self) -> D:
        """The entries of the whole device by name."""
        made: D = self._once("device", self._make_device)
        return made

    @property
    def axes(self) -> tuple[A, ...]:
        """For each axis, its entries by name."""
        made: tuple[A, ...] = self._once("axes", self._make_axes)
        return made

    def _make_device(self) -> Any:
        return self._part("objects").DeviceObjects(self, None)

    def _make_axes(self) -> Any:
        return tuple(self._part("objects").AxisObjects(self, axis) for axis in range(self.axis_count))

    # ---- what belongs to it ------------------------------------------------------------------------------------------

    @property
    def pdos(self) -> tuple[Pdo, ...]:
        """The PDOs of all axes with their defaults: RPDOs, then TPDOs, each by axis and number."""
        from .pdos import default_pdos

        made: tuple[Pdo, ...] = self._once("pdos", lambda: default_pdos(self))
        return made

    @property
    def units(self) -> Mapping[str, Unit]:
        """The units by name."""
        units: Mapping[str, Unit] = self._part("units").UNITS
        return units

    def enumeration(self, name: str) -> type[Choice]:
        """A value table of the package."""
        found: type[Choice] = getattr(self._part("enums"), name)
        return found

    def flags(self, name: str) -> type[Bits]:
        """A bit table of the package."""
        found: type[Bits] = getattr(self._part("flags"), name)
        return found

    def text(self, name: str, sub: int | None) -> tuple[str, str]:
        """Description and source of an object, or of one of its entries."""
        texts = self._part("texts").TEXTS
        found: tuple[str, str] = texts.get((name, sub)) or texts[name, None]
        return found

    def _part(self, module: str) -> Any:
        """A module of the package, loaded on first use."""
        import sys

        name = f"{self.package}.{module}"
        if name not in sys.modules:
            __import__(name)
        return sys.modules[name]

    # ---- making objects ----------------------------------------------------------------------------------------------

    def _make(self, index: int) -> Object | None:
        base, axis = self.fold(index)
        row_index = self._row_index(base)
        if row_index is None:
            return None
        from .making import make_object

        made = make_object(self, row_index, base - row_index, axis)
        return self._made.setdefault(index, made)

    def _row_index(self, base: int) -> int | None:
        """Where the row of an object stands: at its index, or at that of the first PDO."""
        if base in self._objects:
            return base
        for first, row in self._objects.items():
            if first < base < first + row[5]:
                return first
        return None

    @property
    def _indices(self) -> tuple[int, ...]:
        return self._once("indices", self._all_indices)  # type: ignore[no-any-return]  # one cache for all kinds

    def _all_indices(self) -> tuple[int, ...]:
        return tuple(
            sorted(
                base + axis * row[4] + ordinal
                for base, row in self._objects.items()
                for axis in range(self.axis_count if row[4] else 1)
                for ordinal in range(row[5])
            )
        )

    @property
    def _index_of_name(self) -> dict[str, int]:
        return self._once(  # type: ignore[no-any-return]
            "names", lambda: {row[0]: index for index, row in self._objects.items()}
        )

    @property
    def _index_of_parameter_name(self) -> dict[str, int]:
        return self._once(  # type: ignore[no-any-return]
            "parameter names", lambda: {self[index].parameter_name: index for index in self._indices}
        )

    def _once(self, key: str, make: Any) -> Any:
        if key not in self._cache:
            self._cache[key] = make()
        return self._cache[key]

    def _missing(self, what: str) -> KeyError:
        from .errors import NoSuchObjectError

        return NoSuchObjectError(f"{self.package} has no object {what}")
