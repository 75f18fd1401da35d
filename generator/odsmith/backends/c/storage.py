"""Where the value of an entry lives in C: in a field of a struct, or in the tables as a constant.

There is one struct of values for the device, one for an axis and one for a PDO. Each begins with the struct that the
runtimes know (made of the vocabulary's roles), followed by the fields of entries without a role.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from odsmith.canopen_types import DataType
from odsmith.model import Device, Entry, Object, Scope
from odsmith.vocabulary import Role

Struct = Literal["device", "axis", "pdo"]

_C_TYPES = {
    DataType.BOOLEAN: "uint8_t",
    DataType.INTEGER8: "int8_t",
    DataType.INTEGER16: "int16_t",
    DataType.INTEGER32: "int32_t",
    DataType.INTEGER64: "int64_t",
    DataType.UNSIGNED8: "uint8_t",
    DataType.UNSIGNED16: "uint16_t",
    DataType.UNSIGNED32: "uint32_t",
    DataType.UNSIGNED64: "uint64_t",
    DataType.REAL32: "float",
    DataType.REAL64: "double",
}


@dataclass(frozen=True, slots=True)
class Field:
    """A member of a generated struct; `length` is its number of elements, 0 for a scalar."""

    type: str
    name: str
    length: int
    alignment: int
    text: str

    @property
    def declarator(self) -> str:
        return f"{self.name}[{self.length}]" if self.length else self.name


@dataclass(frozen=True, slots=True)
class Location:
    """A member of a struct of values: `common.controlword`, `common.error_behaviour[1]`, `pwm_gradient`."""

    struct: Struct
    path: tuple[str, ...]
    element: int | None = None

    @property
    def designator(self) -> str:
        path = ".".join(self.path)
        return path if self.element is None else f"{path}[{self.element}]"


def struct_of(scope: Scope) -> Struct:
    return "pdo" if scope == "rpdo" or scope == "tpdo" else scope


def is_constant(entry: Entry) -> bool:
    """True for an entry that needs no memory: nothing that happens can change what it reads.

    Beside what can not be written these are commands (a signature is acted upon, never kept), entries that can not
    be read back, and those with a single value that may be written. What is stored is no constant, nor is a default
    with the node-ID, and a string that is written needs a place where it can come in piece by piece.
    """
    if entry.role or entry.stored != "never" or (entry.default and entry.default.node_id):
        return False
    if entry.access.writable and not entry.type.bits:
        return False
    if not entry.access.writable or entry.signatures or not entry.access.readable:
        return True
    only = entry.allowed.members if entry.allowed else None
    return only is not None and entry.default is not None and only == (entry.default.number,)


def by_size(fields: Iterable[Field]) -> tuple[Field, ...]:
    """Large members first, so that a struct has no holes; otherwise in the order given."""
    return tuple(sorted(fields, key=lambda field: -field.alignment))


def role_field(role: Role) -> Field:
    """The member of the runtimes' struct for a role."""
    if role.type.bits:
        return Field(_C_TYPES[role.type], role.name, role.count if role.count > 1 else 0, _size(role.type), role.text)
    return Field("uint8_t", role.name, max(role.length, 1), 1, role.text)


def sized_by_device(role: Role) -> bool:
    """An array of a PDO is as long as the device needs it: 8 mapping entries in each of 48 PDOs would waste a lot."""
    return role.scope == "pdo" and role.count > 1


@dataclass(frozen=True)
class Storage:
    """The structs of values of a device."""

    device: Device

    @cached_property
    def structs(self) -> tuple[Struct, ...]:
        """The structs that the device needs; it always has the first one."""
        used = {struct_of(obj.scope) for obj in self.device.objects}
        structs: tuple[Struct, ...] = ("device", "axis", "pdo")
        return tuple(struct for struct in structs if struct == "device" or struct in used)

    def own_fields(self, struct: Struct) -> tuple[Field, ...]:
        """What follows the runtimes' part of a struct: first the arrays that are sized by the device, then the rest."""
        return (*self._arrays(struct), *by_size(self._own(struct)))

    def location(self, obj: Object, entry: Entry) -> Location | None:
        """Where the value of an entry lives; None for a constant."""
        if is_constant(entry):
            return None
        struct = struct_of(obj.scope)
        if not entry.role:
            return Location(struct, (_own_name(obj, entry),))
        role = self.device.roles[entry.role]
        path = (role.name,) if sized_by_device(role) else ("common", role.name)
        return Location(struct, path, entry.repeat if role.count > 1 else None)

    def _entries(self, struct: Struct) -> Iterator[tuple[Object, Entry]]:
        for obj in self.device.objects:
            if struct_of(obj.scope) == struct:
                for entry in obj.entries:
                    yield obj, entry

    def _arrays(self, struct: Struct) -> Iterator[Field]:
        for role in filter(sized_by_device, self.device.roles.values()):
            elements = [entry.repeat + 1 for _, entry in self._entries(struct) if entry.role == role.name]
            if elements:
                yield Field(_C_TYPES[role.type], role.name, max(elements), _size(role.type), role.text)

    def _own(self, struct: Struct) -> Iterator[Field]:
        for obj, entry in self._entries(struct):
            if entry.role or is_constant(entry):
                continue
            text = f"{obj.index:04X}h:{entry.sub:02X} {entry.title}"
            if entry.type.bits:
                yield Field(_C_TYPES[entry.type], _own_name(obj, entry), 0, _size(entry.type), text)
            else:
                yield Field("uint8_t", _own_name(obj, entry), max(entry.length, 1), 1, text)


def _own_name(obj: Object, entry: Entry) -> str:
    return obj.name if len(obj.entries) == 1 and entry.sub == 0 else f"{obj.name}_{entry.name}"


def _size(data_type: DataType) -> int:
    return max(data_type.bits // 8, 1)
