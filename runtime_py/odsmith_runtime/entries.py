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
    from .dictionary import ObjectDictionary
    from .units import Unit

    Raw = int | float | str | bytes

V = TypeVar("V")


class Object(Row):
    """One index of the dictionary, with its entries by sub-index or name.

    `axis` counts from 0 and is None for an object of the whole device; `parameter_name` is the name in the EDS, where
    axes count from 1. `base_index` is the index on axis 0, which is the same as `index` there. Parameter objects of
    PDOs say in `pdo` which record they are and in `number` which PDO of their axis, from 1.
    """

    dictionary: ObjectDictionary[Any, Any]
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
    the values that may be written, as ascending closed intervals, empty where any value of the type may. `signatures`
    are the only values that make a command act, by name. `writable_in` names the PDS states in which a write is taken,
    `stored` the storage group (or never), `groups` the groups that a storage command acts on, `effect` what a write
    does, `role` the field of the runtimes that holds the value. `repeat` is the ordinal of an entry that the model
    writes once and repeats, for each axis if `per_axis`. `hidden_default` says why the EDS keeps the default to itself.
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
    def values(self) -> type[Choice] | None:
        """The enumeration of the values that have names."""
        return self.parent.dictionary.enumeration(self.values_class) if self.values_class else None

    @property
    def bits(self) -> type[Bits] | None:
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
        """`0..8388607 pps`, or `1 (shutdown), 5 (slow_down)`, for messages."""
        names = {int(member): member.name.lower() for member in self.values} if self.values else {}

        def one(value: int) -> str:
            return f"{value} ({names[value]})" if value in names else str(value)

        if all(low - 1 in names or low in names for low, _ in self.allowed) and names:
            members = (one(value) for low, high in self.allowed for value in range(low, high + 1))
            return ", ".join(members)
        intervals = (one(low) if low == high else f"{low}..{high}" for low, high in self.allowed)
        return ", ".join(intervals) + (f" {self.unit.symbol}" if self.unit else "")

    def _typed(self, value: Raw) -> V:
        """The value as its bits or its named value; what has no name stays as it is."""
        typed: Any = value
        if self.bits_class:
            flags = self.parent.dictionary.flags(self.bits_class)
            typed = flags(value)
        elif self.values_class:
            enumeration = self.parent.dictionary.enumeration(self.values_class)
            typed = enumeration._value2member_map_.get(value, value)
        result: V = typed
        return result


def _of_axis(axis: int | None) -> str:
    return "" if axis is None else f" of axis {axis}"
