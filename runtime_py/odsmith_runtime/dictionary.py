"""The object dictionary of a device: compact tables, folded over the axes, that make objects when they are asked for.

An axis is written once. An index is split into an axis and the index on axis 0, and one row serves all axes; the
records of PDO parameters are folded once more, one row for all PDOs of a direction.

Rows, as a generated package writes them:

- `objects`: base index -> (name, title, EDS name, object type, stride, how many consecutive indices, PDO record);
- `entries`: base index and sub-index, `0x6040_00` -> (type, access, PDO mapping, default, then pairs of a column of
  `Entry` and its value); a default is a number, text, None where none is stated, or ("$NODEID", offset). Names that
  are missing are those of the object;
- `pdos`: (direction, number from 1) -> (COB-ID, COB-ID on the other axes, transmission type, inhibit time, event timer,
  mapped entries on axis 0 as PDO mapping objects hold them).
"""

from . import lazy_property

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


class ObjectDictionary:
    """All objects of a device.

    By index `dictionary[0x6840]`, by name `dictionary["controlword"]` (of axis 0), by EDS name
    `dictionary["Controlword 2"]`; by name and axis with `object`. Iterating gives the indices of all axes, ascending.

    `device` and `axes[n]` offer the entries as attributes, `axes[1].homing_speeds.fast`; the generated package declares
    their types. Axes count from 0 everywhere but in EDS names.
    """

    def __init__(
        self,
        package: str,
        *,
        axis_count: int,
        areas: tuple[tuple[int, int, int], ...],
        objects: "Mapping[int, ObjectRow]",
        entries: "Mapping[int, EntryRow]",
        pdos: "Mapping[tuple[str, int], PdoRow]",
        max_pdo_entries: int,
    ) -> None:
        self.package = package
        self.axis_count = axis_count
        self.max_pdo_entries = max_pdo_entries
        self.areas = areas
        self.object_rows = objects
        self.entry_rows = entries
        self.pdo_rows = pdos
        self._made: dict[int, Object] = {}

    # ---- by index and by name ----------------------------------------------------------------------------------------

    def __getitem__(self, key: int | str) -> "Object":
        """The object of an index, a name (on axis 0) or an EDS name. Raises NoSuchObjectError."""
        found = self.get(key)
        if found is None:
            raise self._missing(f"{key:04X}h" if isinstance(key, int) else repr(key))
        return found

    def get(self, key: int | str) -> "Object | None":
        """The same, but None for what is not there."""
        if isinstance(key, str):
            index = self._index_of_name.get(key)
            key = self._index_of_parameter_name.get(key, -1) if index is None else index
        return self._made.get(key) or self._make(key)

    def object(self, name: str, axis: int | None = None, number: int = 1) -> "Object":
        """The object called `name` of an axis; without `axis` that of axis 0 or of the whole device.

        `number` chooses the PDO of the axis, from 1, for objects that describe PDOs. Raises NoSuchObjectError.
        """
        base = self._index_of_name.get(name)
        if base is None:
            raise self._missing(repr(name))
        return self.at(base, axis, number)

    def at(self, base_index: int, axis: int | None = None, number: int = 1) -> "Object":
        """The object that stands at `base_index` on axis 0, on another axis. Raises NoSuchObjectError."""
        row = self.object_rows.get(base_index)
        if row is None:
            raise self._missing(f"{base_index:04X}h")
        name, _, _, _, stride, count, _ = row
        if axis is not None and not (stride and 0 <= axis < self.axis_count):
            raise self._missing(f"{name!r} of axis {axis}")
        if not 1 <= number <= count:
            raise self._missing(f"{name!r} of PDO {number}")
        return self[base_index + (axis or 0) * stride + number - 1]

    def entry(self, name: str, axis: int | None = None, number: int = 1) -> "Entry[Any]":
        """The entry of a dotted name: `controlword`, `homing_speeds.fast`. Raises NoSuchObjectError."""
        object_name, _, entry_name = name.partition(".")
        obj = self.object(object_name, axis, number)
        return obj[entry_name] if entry_name else obj[0]

    def __contains__(self, key: "Any") -> bool:
        return isinstance(key, (int, str)) and self.get(key) is not None

    def __iter__(self) -> "Iterator[int]":
        return iter(self._indices)

    def __len__(self) -> int:
        return len(self._indices)

    def keys(self) -> tuple[int, ...]:
        """All indices, ascending."""
        return self._indices

    def values(self) -> "Iterator[Object]":
        """All objects, ascending by index."""
        return (self[index] for index in self._indices)

    def items(self) -> "Iterator[tuple[int, Object]]":
        """Every object with its index."""
        return ((index, self[index]) for index in self._indices)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.package}: {len(self)} objects, {self.axis_count} axes>"

    def fold(self, index: int) -> tuple[int, int | None]:
        """Index on axis 0 and axis of an index; the axis is None outside the areas that repeat."""
        for first, last, stride in self.areas:
            axis, offset = divmod(index - first, stride)
            if 0 <= axis < self.axis_count and offset <= last - first:
                return first + offset, axis
        return index, None

    # ---- typed names -------------------------------------------------------------------------------------------------

    @lazy_property
    def device(self) -> "Any":
        """The entries of the whole device by name."""
        return self._part("objects").DeviceObjects(self, None)

    @lazy_property
    def axes(self) -> "Any":
        """For each axis, its entries by name."""
        return tuple(self._part("objects").AxisObjects(self, axis) for axis in range(self.axis_count))

    # ---- what belongs to it ------------------------------------------------------------------------------------------

    @lazy_property
    def pdos(self) -> "tuple[Pdo, ...]":
        """The PDOs of all axes with their defaults: by axis, RPDOs, then TPDOs, each ascending."""
        from .pdos import default_pdos

        return default_pdos(self)

    @property
    def units(self) -> "Mapping[str, Unit]":
        """The units by name."""
        units: Mapping[str, Unit] = self._part("units").UNITS
        return units

    def enumeration(self, name: str) -> "type[Choice]":
        """A value table of the package."""
        found: type[Choice] = getattr(self._part("enums"), name)
        return found

    def flags(self, name: str) -> "type[Bits]":
        """A bit table of the package."""
        found: type[Bits] = getattr(self._part("flags"), name)
        return found

    def text(self, name: str, sub: int | None = None) -> tuple[str, str]:
        """Description and source of an object, or of one of its entries."""
        texts: Mapping[tuple[str, int | None], tuple[str, str]] = self._part("texts").TEXTS
        return texts.get((name, sub)) or texts[name, None]

    def _part(self, module: str) -> "Any":
        """A module of the package, loaded on first use."""
        import sys

        name = f"{self.package}.{module}"
        if name not in sys.modules:
            __import__(name)
        return sys.modules[name]

    # ---- making objects ----------------------------------------------------------------------------------------------

    def _make(self, index: int) -> "Object | None":
        base, axis = self.fold(index)
        row_index = base
        if row_index not in self.object_rows:  # perhaps one of the PDO records that follow the first
            row_index = next((i for i, row in self.object_rows.items() if i < base < i + row[5]), -1)
            if row_index < 0:
                return None
        from .entries import make_object

        return self._made.setdefault(index, make_object(self, row_index, axis, base - row_index + 1))

    @lazy_property
    def rows_of_entries(self) -> "dict[int, list[tuple[int, EntryRow]]]":
        """The entry rows of each object, with their sub-indices, by base index."""
        found: dict[int, list[tuple[int, EntryRow]]] = {base: [] for base in self.object_rows}
        for address, row in self.entry_rows.items():
            found[address >> 8].append((address & 0xFF, row))
        return found

    @lazy_property
    def _places(self) -> tuple[tuple[int, int, int | None, int], ...]:
        """(index, base index, axis, number) of every object, ascending by index."""
        return tuple(
            sorted(
                (base + axis * row[4] + ordinal, base, axis if row[4] else None, ordinal + 1)
                for base, row in self.object_rows.items()
                for axis in range(self.axis_count if row[4] else 1)
                for ordinal in range(row[5])
            )
        )

    @lazy_property
    def _indices(self) -> tuple[int, ...]:
        return tuple(place[0] for place in self._places)

    @lazy_property
    def _index_of_name(self) -> dict[str, int]:
        return {row[0]: index for index, row in self.object_rows.items()}

    @lazy_property
    def _index_of_parameter_name(self) -> dict[str, int]:
        from .entries import parameter_name

        rows = self.object_rows
        return {parameter_name(rows[base], index, axis): index for index, base, axis, _ in self._places}

    def _missing(self, what: str) -> KeyError:
        from .errors import NoSuchObjectError

        return NoSuchObjectError(f"{self.package} has no object {what}")
