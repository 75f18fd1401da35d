"""Values to bytes and back, by CiA 301 data type: little endian, as in SDO and PDO data (CiA 301, clause 7.1.6)."""

from __future__ import annotations

INTEGERS = {
    "BOOLEAN": (1, False),
    "INTEGER8": (1, True),
    "INTEGER16": (2, True),
    "INTEGER32": (4, True),
    "INTEGER64": (8, True),
    "UNSIGNED8": (1, False),
    "UNSIGNED16": (2, False),
    "UNSIGNED32": (4, False),
    "UNSIGNED64": (8, False),
}
"""Octets and signedness of the integer types. A BOOLEAN is one bit, in one octet of an SDO."""

REALS = {"REAL32": "<f", "REAL64": "<d"}
"""Formats of the floating-point types (IEEE 754)."""

TEXT = "VISIBLE_STRING"
OCTETS = ("OCTET_STRING", "DOMAIN")


def size(type: str) -> int:
    """Octets of a value of this type; 0 where the length is not the type's."""
    if type in INTEGERS:
        return INTEGERS[type][0]
    return {"REAL32": 4, "REAL64": 8}.get(type, 0)


def bits(type: str) -> int:
    """Length in a PDO mapping, in bits; 0 where the length is not the type's."""
    return 1 if type == "BOOLEAN" else 8 * size(type)


def limits(type: str) -> tuple[int, int] | None:
    """Smallest and largest value of an integer type, None for others."""
    if type == "BOOLEAN":
        return 0, 1
    if type not in INTEGERS:
        return None
    octets, signed = INTEGERS[type]
    return (-(1 << (8 * octets - 1)), (1 << (8 * octets - 1)) - 1) if signed else (0, (1 << 8 * octets) - 1)


def encode(type: str, value: int | float | str | bytes) -> bytes:
    """The octets of a value on the bus.

    Raises TypeError for a value that is not of the type's kind, ValueError for one that it cannot hold.
    """
    if type in INTEGERS:
        number = integer(value)
        low, high = limits(type) or (0, 0)
        if not low <= number <= high:
            raise ValueError(f"{number} is not in {low}..{high}, which {type} can hold")
        octets, signed = INTEGERS[type]
        return number.to_bytes(octets, "little", signed=signed)
    if type in REALS:
        import struct

        if isinstance(value, (str, bytes)):
            raise TypeError(f"{value!r} is no number")
        try:
            return struct.pack(REALS[type], value)
        except OverflowError:
            raise ValueError(f"{value!r} is more than {type} can hold") from None
    if type == TEXT:
        if not isinstance(value, str):
            raise TypeError(f"{value!r} is no text")
        if not value.isascii():
            raise ValueError(f"{value!r} is not ASCII")
        return value.encode("ascii")
    if not isinstance(value, (bytes, bytearray, memoryview)):
        raise TypeError(f"{value!r} is no bytes")
    return bytes(value)


def decode(type: str, data: bytes) -> int | float | str | bytes:
    """The value that octets from the bus stand for. Raises ValueError where their number is not that of the type.

    Text ends at the first zero octet; what is not ASCII in it becomes U+FFFD.
    """
    wanted = size(type)
    if wanted and len(data) != wanted:
        raise ValueError(f"{len(data)} octets instead of {wanted} for {type}")
    if type in INTEGERS:
        number = int.from_bytes(data, "little", signed=INTEGERS[type][1])
        return bool(number) if type == "BOOLEAN" else number
    if type in REALS:
        import struct

        value: float = struct.unpack(REALS[type], data)[0]
        return value
    if type == TEXT:
        return bytes(data).partition(b"\0")[0].decode("ascii", "replace")
    return bytes(data)


def integer(value: object) -> int:
    """The integer that a value is, whatever its class; floats are none. Raises TypeError."""
    index = getattr(value, "__index__", None)
    if index is None:
        raise TypeError(f"{value!r} is no integer")
    number: int = index()
    return number
