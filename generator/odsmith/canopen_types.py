"""Data types and codes of CiA 301, and where a fact was written and comes from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal


@dataclass(frozen=True, slots=True)
class Place:
    """A position in a source file; `line` and `column` count from 1."""

    path: str
    line: int
    column: int


NOWHERE = Place("<none>", 0, 0)


@dataclass(frozen=True, slots=True)
class Source:
    """Where a fact comes from.

    `kind` is the authority: the manual that describes the device or its family, the device's own manual where that is
    another one, the vendor's EDS file, a CiA document, or `inferred`, which needs a `note` that gives the reason. A
    fact may combine a manual section with a note.
    """

    kind: Literal["manual", "own_manual", "vendor_eds", "cia301", "cia303", "cia306", "cia401", "cia402", "inferred"]
    section: str = ""
    tables: tuple[int, ...] = ()
    figures: tuple[int, ...] = ()
    clause: str = ""
    note: str = ""


class DataType(StrEnum):
    """The static data types of CiA 301, table 44, that a model may use."""

    BOOLEAN = "BOOLEAN"
    INTEGER8 = "INTEGER8"
    INTEGER16 = "INTEGER16"
    INTEGER32 = "INTEGER32"
    INTEGER64 = "INTEGER64"
    UNSIGNED8 = "UNSIGNED8"
    UNSIGNED16 = "UNSIGNED16"
    UNSIGNED32 = "UNSIGNED32"
    UNSIGNED64 = "UNSIGNED64"
    REAL32 = "REAL32"
    REAL64 = "REAL64"
    VISIBLE_STRING = "VISIBLE_STRING"
    OCTET_STRING = "OCTET_STRING"
    DOMAIN = "DOMAIN"

    @property
    def code(self) -> int:
        """The type's index in the object dictionary (CiA 301, table 44)."""
        return _TYPE_CODES[self]

    @property
    def bits(self) -> int:
        """Length in bits; 0 for strings and domains, whose length the entry gives in `length`."""
        return _TYPE_BITS.get(self, 0)

    @property
    def signed(self) -> bool:
        return self.value.startswith("INTEGER")

    @property
    def integer(self) -> bool:
        return self.value.startswith(("INTEGER", "UNSIGNED")) or self is DataType.BOOLEAN

    @property
    def string(self) -> bool:
        return self in (DataType.VISIBLE_STRING, DataType.OCTET_STRING)

    @property
    def low(self) -> int:
        """Smallest value of an integer type."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def high(self) -> int:
        """Largest value of an integer type."""
        return (1 << (self.bits - 1)) - 1 if self.signed else (1 << self.bits) - 1


_TYPE_CODES = {
    DataType.BOOLEAN: 0x0001,
    DataType.INTEGER8: 0x0002,
    DataType.INTEGER16: 0x0003,
    DataType.INTEGER32: 0x0004,
    DataType.UNSIGNED8: 0x0005,
    DataType.UNSIGNED16: 0x0006,
    DataType.UNSIGNED32: 0x0007,
    DataType.REAL32: 0x0008,
    DataType.VISIBLE_STRING: 0x0009,
    DataType.OCTET_STRING: 0x000A,
    DataType.DOMAIN: 0x000F,
    DataType.REAL64: 0x0011,
    DataType.INTEGER64: 0x0015,
    DataType.UNSIGNED64: 0x001B,
}


_TYPE_BITS = {
    DataType.BOOLEAN: 1,
    DataType.INTEGER8: 8,
    DataType.INTEGER16: 16,
    DataType.INTEGER32: 32,
    DataType.INTEGER64: 64,
    DataType.UNSIGNED8: 8,
    DataType.UNSIGNED16: 16,
    DataType.UNSIGNED32: 32,
    DataType.UNSIGNED64: 64,
    DataType.REAL32: 32,
    DataType.REAL64: 64,
}


class ObjectType(StrEnum):
    """Object types of CiA 301, table 42."""

    VAR = "VAR"
    ARRAY = "ARRAY"
    RECORD = "RECORD"

    @property
    def code(self) -> int:
        return {"VAR": 7, "ARRAY": 8, "RECORD": 9}[self.value]


class Access(StrEnum):
    """Access by SDO. The EDS spells `rw` with a PDO direction as rww or rwr, see `Entry.mapping`."""

    RO = "ro"
    RW = "rw"
    WO = "wo"
    CONST = "const"

    @property
    def readable(self) -> bool:
        return self is not Access.WO

    @property
    def writable(self) -> bool:
        return self in (Access.RW, Access.WO)


class PdoDirection(StrEnum):
    """Which PDOs may carry an entry: `rx` an RPDO, `tx` a TPDO."""

    NO = "no"
    RX = "rx"
    TX = "tx"
    BOTH = "both"

    @property
    def receivable(self) -> bool:
        return self in (PdoDirection.RX, PdoDirection.BOTH)

    @property
    def transmittable(self) -> bool:
        return self in (PdoDirection.TX, PdoDirection.BOTH)
