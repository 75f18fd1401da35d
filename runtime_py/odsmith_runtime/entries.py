"""Objects and their entries: what one address of the bus holds, and which values it takes."""

from __future__ import annotations

from . import codec
from .rows import Row
from .typing_support import Generic, TypeVar

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from .choices import Bits, Choice
    from .dictionary import Default, EntryRow, ObjectDictionary, ObjectRow
    from .units import Unit

    Raw = int | float | str | bytes
    BitsClass = type[Bits]  # an entry has a type, so `type` is something else in its class
    ChoiceClass = type[Choice]

V = TypeVar("V")


class Object(Row):
    """One index of the dictionary, with its entries by sub-index or name.

    `axis` counts from 0 and is None for an object of the whole device; `parameter_name` is the name in the EDS, where
    axes count from 1. `base_index` is the index on axis 0, which is the same as `index` there. Parameter objects of
    PDOs say in `pdo` which record they are and in `number` which PDO of their axis, from 1.
    """

    dictionary: ObjectDictionary
    index: int
    base_index: int
    name: str
    title: str
    parameter_name: str
    object_type: str
    axis: int | None
    pdo: str
    number: int
    entries: tuple[Entry[Any], ...]

    def __getitem__(self, key: int | str) -> Entry[Any]:
        """The entry of this sub-index or name. Raises NoSuchObjectError."""
        for entry in self.entries:
            if key in (entry.sub, entry.name):
                return entry
        from .errors import NoSuchObjectError

        wanted = f"sub-index {key}" if isinstance(key, int) else f"entry called {key!r}"
        raise NoSuchObjectError(f"{self.name} ({self.index:04X}h) has no {wanted}")

    def __contains__(self, key: object) -> bool:
        return any(key in (entry.sub, entry.name) for entry in self.entries)

    def __iter__(self) -> Iterator[Entry[Any]]:
        return iter(self.entries)

    def __len__(self) -> int:
        return len(self.entries)

    def __repr__(self) -> str:
        return f"<{self.label}>"

    @property
    def label(self) -> str:
        """`controlword of axis 1 (6840h)`, for messages."""
        return f"{self.name}{_of_axis(self.axis)} ({self.index:04X}h)"

    @property
    def is_variable(self) -> bool:
        """True for an object without sub-indices: its one entry is `object[0]`."""
        return self.object_type == "VAR"

    @property
    def highest_sub(self) -> int:
        return self.entries[-1].sub

    @property
    def text(self) -> str:
        """What the object is for."""
        return self.dictionary.text(self.name, None)[0]

    @property
    def source(self) -> str:
        """Where its description comes from: section and tables of the manual, a clause of CiA, or the reason."""
        return self.dictionary.text(self.name, None)[1]


class Entry(Row, Generic[V]):
    """One sub-index: type, access, limits, meaning. `V` is what its value is in Python.

    `access` is ro, rw, wo or const; `mapping` says which PDOs may carry the entry: no, rx, tx or both. `allowed` are
    the values that may be written, as ascending closed intervals, empty where any value of the type may; a `listed` set
    names its members, so that another value is not too low or too high but simply none of them. `signatures` are the
    only values that make a command act, by name. `writable_in` names the PDS states in which a write is taken, `stored`
    the storage group (or never), `groups` the groups that a storage command acts on, `effect` what a write does, `role`
    the field of the runtimes that holds the value. `repeat` is the ordinal of an entry that the model writes once and
    repeats, for each axis if `per_axis`. `hidden_default` says why the EDS keeps the default to itself.
    """

    parent: Object
    sub: int
    name: str
    title: str
    parameter_name: str
    type: str
    access: str
    mapping: str
    stated_default: int | str | tuple[str, int] | None
    length: int = 0
    allowed: tuple[tuple[int, int], ...] = ()
    listed: bool = False
    values_class: str = ""
    bits_class: str = ""
    unit_name: str = ""
    signatures: tuple[tuple[str, int], ...] = ()
    writable_in: tuple[str, ...] = ()
    stored: str = "never"
    groups: tuple[str, ...] = ()
    effect: str = ""
    role: str = ""
    hidden_default: str = ""
    refuse_write_on_scan: bool = False
    repeat: int = 0
    per_axis: bool = False

    def __repr__(self) -> str:
        return f"<{self.label} {self.type} {self.access}>"

    # ---- where it is -------------------------------------------------------------------------------------------------

    @property
    def index(self) -> int:
        return self.parent.index

    @property
    def axis(self) -> int | None:
        """The axis, from 0; None for the whole device."""
        return self.parent.axis

    @property
    def full_name(self) -> str:
        """`controlword`, or `homing_speeds.fast`."""
        return self.name if self.parent.is_variable else f"{self.parent.name}.{self.name}"

    @property
    def label(self) -> str:
        """`homing_speeds.fast of axis 1 (6899h:01)`, for messages."""
        sub = "" if self.parent.is_variable else f":{self.sub:02X}"
        return f"{self.full_name}{_of_axis(self.axis)} ({self.index:04X}h{sub})"

    # ---- what it is --------------------------------------------------------------------------------------------------

    @property
    def readable(self) -> bool:
        return self.access != "wo"

    @property
    def writable(self) -> bool:
        return self.access in ("rw", "wo")

    @property
    def receivable(self) -> bool:
        """True where an RPDO may carry it."""
        return self.mapping in ("rx", "both")

    @property
    def transmittable(self) -> bool:
        """True where a TPDO may carry it."""
        return self.mapping in ("tx", "both")

    @property
    def constant(self) -> bool:
        """True where the value is the default for ever."""
        return not self.writable and not self.role

    @property
    def bit_length(self) -> int:
        """Length in a PDO mapping, in bits; for strings the largest length."""
        return codec.bits(self.type) or 8 * self.length

    @property
    def low(self) -> int | None:
        """Smallest value that may be written; None where the type is no integer."""
        limits = codec.limits(self.type)
        return self.allowed[0][0] if self.allowed else limits and limits[0]

    @property
    def high(self) -> int | None:
        """Largest value that may be written; None where the type is no integer."""
        limits = codec.limits(self.type)
        return self.allowed[-1][1] if self.allowed else limits and limits[1]

    @property
    def text(self) -> str:
        """What the entry is for."""
        return self.parent.dictionary.text(self.parent.name, self.sub)[0]

    @property
    def source(self) -> str:
        """Where its description comes from."""
        return self.parent.dictionary.text(self.parent.name, self.sub)[1]

    @property
    def unit(self) -> Unit | None:
        """The unit of one count, if the value has one."""
        return self.parent.dictionary.units[self.unit_name] if self.unit_name else None

    @property
    def values(self) -> ChoiceClass | None:
        """The enumeration of the values that have names."""
        return self.parent.dictionary.enumeration(self.values_class) if self.values_class else None

    @property
    def bits(self) -> BitsClass | None:
        """The bits and bit fields of the value."""
        return self.parent.dictionary.flags(self.bits_class) if self.bits_class else None

    # ---- its value ---------------------------------------------------------------------------------------------------

    def default(self, node_id: int = 1) -> V | None:
        """The default of a device with this node-ID, None where none is stated."""
        stated = self.stated_default
        if stated is None:
            return None
        if isinstance(stated, tuple):
            return self._typed(stated[1] + node_id)
        return self._typed(stated.encode() if self.type in codec.OCTETS and isinstance(stated, str) else stated)

    def initial(self, node_id: int = 1) -> V:
        """The value after the very first power-on: the default, or 0 or nothing where none is stated."""
        default = self.default(node_id)
        return self._typed(codec.decode(self.type, bytes(codec.size(self.type)))) if default is None else default

    def decode(self, data: bytes) -> V:
        """The value that octets from the bus stand for: a member of the enumeration if it has that value, else plain.

        Raises WrongLengthError.
        """
        try:
            return self._typed(codec.decode(self.type, data))
        except ValueError as error:
            from .errors import WrongLengthError

            raise WrongLengthError(self, data, str(error)) from None

    def encode(self, value: V | int) -> bytes:
        """The octets of a value on the bus, whatever the access.

        Raises WrongTypeError, OutOfRangeError for what the type cannot hold, WrongLengthError for strings.
        """
        try:
            data = codec.encode(self.type, value)  # type: ignore[arg-type]  # it raises TypeError for other kinds
        except TypeError as error:
            from .errors import WrongTypeError

            raise WrongTypeError(self, value, str(error)) from None
        except ValueError as error:
            from .errors import OutOfRangeError

            raise OutOfRangeError(self, value, str(error)) from None
        if self.length and not codec.size(self.type) and len(data) > self.length:
            from .errors import WrongLengthError

            raise WrongLengthError(self, value, f"{len(data)} octets, {self.length} at most") from None
        return data

    def check(self, value: V | int) -> None:
        """Raise the RefusedError that says why the device would not take this value, in any state.

        What depends on the moment (`writable_in`, an active PDO) is the device's to say.
        """
        if not self.writable:
            from .errors import ReadOnlyError

            raise ReadOnlyError(self, value, "cannot be written")
        self.encode(value)
        if self.signatures and value not in [number for _, number in self.signatures]:
            from .errors import WrongSignatureError

            names = ", ".join(f"{name} ({number:08X}h)" for name, number in self.signatures)
            raise WrongSignatureError(self, value, f"{value!r} is not the signature {names}")
        if self.allowed and not self.signatures and not self.allows(codec.integer(value)):
            from .errors import OutOfRangeError

            raise OutOfRangeError(self, value, f"{codec.integer(value)} is not in {self.limits_text}")

    def allows(self, value: int) -> bool:
        """True for a value in the range or set of the entry."""
        return not self.allowed or any(low <= value <= high for low, high in self.allowed)

    @property
    def limits_text(self) -> str:
        """`0..8388607 pps`, or `0 (spread_cycle), 1 (constant_off_time)`, for messages."""
        names = {member.value: member.name.lower() for member in self.values or ()}
        if names and all(value in names for low, high in self.allowed for value in range(low, high + 1)):
            return ", ".join(f"{value} ({name})" for value, name in sorted(names.items()) if self.allows(value))
        intervals = (str(low) if low == high else f"{low}..{high}" for low, high in self.allowed)
        return ", ".join(intervals) + (f" {self.unit.symbol}" if self.unit else "")

    def _typed(self, value: Raw) -> V:
        """The value as its bits or its named value; what has no name stays as it is."""
        typed: Any = value
        if self.bits_class:
            typed = self.parent.dictionary.flags(self.bits_class)(typed)
        elif self.values_class:
            typed = self.parent.dictionary.enumeration(self.values_class)._value2member_map_.get(typed, typed)
        result: V = typed
        return result


def _of_axis(axis: int | None) -> str:
    return "" if axis is None else f" of axis {axis}"


# ---- from rows to objects --------------------------------------------------------------------------------------------


def make_object(dictionary: ObjectDictionary, base_index: int, axis: int | None, number: int) -> Object:
    """The object at `base_index` on axis 0, on `axis`, for PDO `number` of that axis."""
    row = dictionary.object_rows[base_index]
    name, title, _, object_type, stride, _, pdo = row
    index = base_index + (axis or 0) * stride + number - 1
    numbered = _pdo_number(index)
    columns: dict[str, Any] = {
        "dictionary": dictionary,
        "index": index,
        "base_index": base_index,
        "name": name,
        "title": title.replace("{number}", numbered),
        "parameter_name": parameter_name(row, index, axis),
        "object_type": object_type,
        "axis": axis,
        "pdo": pdo,
        "number": number if pdo else 0,
    }
    obj = Object.trusted(columns)
    obj.__dict__["entries"] = tuple(
        _make_entry(obj, sub, entry) for sub, entry in dictionary.rows_of_entries[base_index]
    )
    return obj


def parameter_name(row: ObjectRow, index: int, axis: int | None) -> str:
    """The name in the EDS: axes count from 1 there, PDOs through all axes."""
    name, pdo = row[2].replace("{number}", _pdo_number(index)), row[6]
    return name if axis is None or pdo else f"{name} {axis + 1}"


def _pdo_number(index: int) -> str:
    """PDO parameters stand in blocks of 200h indices, the first one for PDO 1 (CiA 301, clause 7.5.2.33)."""
    return str((index & 0x1FF) + 1)


def _make_entry(obj: Object, sub: int, row: EntryRow) -> Entry[Any]:
    columns: dict[str, Any] = {"name": obj.name, "title": obj.title, "parameter_name": obj.parameter_name}
    type_, access, mapping, default, *pairs = row
    columns.update(parent=obj, sub=sub, type=type_, access=access, mapping=mapping, stated_default=default)
    columns.update(pairs)
    if obj.pdo and "role" in columns:
        columns["stated_default"] = _pdo_default(obj, columns["role"], columns.get("repeat", 0))
    return Entry.trusted(columns)


def _pdo_default(obj: Object, role: str, position: int) -> Default:
    """PDO parameters have their defaults in the table of PDOs; on other axes the same entries are mapped there."""
    rows = obj.dictionary.pdo_rows
    cob_id, other_cob_id, transmission_type, inhibit_time, event_timer, mapped = rows[obj.pdo[:4], obj.number]
    if role == "pdo_cob_id":
        return other_cob_id if obj.axis else cob_id
    if role == "pdo_mapping":
        if position >= len(mapped):
            return 0
        stride = obj.dictionary.object_rows[mapped[position] >> 16][4]
        return mapped[position] + ((obj.axis or 0) * stride << 16)
    return {
        "pdo_transmission_type": transmission_type,
        "pdo_inhibit_time": inhibit_time,
        "pdo_event_timer": event_timer,
        "pdo_mapped_count": len(mapped),
    }[role]
