"""The little languages inside YAML values: ranges, defaults, bit patterns, scales, bit keys.

Each parser takes text (or a number) and returns a value, or raises `FieldError` with a sentence that says what is
wrong. The caller knows the place.
"""

from __future__ import annotations

import re

from odsmith.canopen_types import DataType
from odsmith.model import Allowed, Default


class FieldError(ValueError):
    """A value that cannot be read; `hint` says what would be right."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.hint = hint


_NUMBER = r"[+-]?(?:0[xX][0-9a-fA-F]+|[0-9]+)"
_INTERVAL = re.compile(rf"\s*({_NUMBER})\s*(?:\.\.\s*({_NUMBER})\s*)?")


def parse_range(text: str | int) -> Allowed:
    """`0..63`, `0, 2..15`, `1` or a bare number; intervals are sorted and joined where they touch."""
    if isinstance(text, int):
        return Allowed(((text, text),), listed=True)
    intervals = []
    for piece in text.split(","):
        match = _INTERVAL.fullmatch(piece)
        if not match:
            raise FieldError(f"cannot read `{piece.strip()}` as a range", "write it as 0..63, or as a list: 0, 2..15")
        low = int(match[1], 0)
        high = int(match[2], 0) if match[2] else low
        if low > high:
            raise FieldError(f"the range {piece.strip()} is empty", f"write the smaller value first: {high}..{low}")
        intervals.append((low, high))
    return Allowed(_join(intervals), listed="," in text or ".." not in text)


def allowed_values(values: list[int]) -> Allowed:
    """The set of exactly these values."""
    return Allowed(_join([(value, value) for value in values]), listed=True)


def _join(intervals: list[tuple[int, int]]) -> tuple[tuple[int, int], ...]:
    joined: list[tuple[int, int]] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1] + 1:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return tuple(joined)


_NODE_ID = re.compile(rf"\$NODEID\s*(?:\+\s*({_NUMBER}))?")


def parse_default(value: str | int | bool, data_type: DataType) -> Default:
    """A number, text for a string type, or `$NODEID+0x80` (CiA 306, clause 4.7.2)."""
    if data_type.string:
        return Default(text=str(value))
    if isinstance(value, (bool, int)):
        return Default(int(value))
    match = _NODE_ID.fullmatch(value)
    if not match:
        raise FieldError(
            f"`{value}` is no default for {data_type}",
            "write a number, or $NODEID+0x80 for a value that has the node-ID",
        )
    return Default(int(match[1], 0) if match[1] else 0, node_id=True)


def parse_pattern(text: str) -> tuple[int, int, int]:
    """A bit pattern, highest bit first: `x` any, `0`, `1`, `^` a rising edge. Returns (mask, value, edge)."""
    bits = text.replace(" ", "")
    if not re.fullmatch(r"[01x^]{8}|[01x^]{16}", bits):
        raise FieldError(
            f"`{text}` is no pattern of 8 or 16 bits",
            "use x for any, 0, 1 and ^ for a rising edge: xxxx xxxx x01x 0111",
        )
    mask = value = edge = 0
    for bit in bits:
        mask, value, edge = mask << 1, value << 1, edge << 1
        if bit in "01":
            mask |= 1
            value |= int(bit)
        elif bit == "^":
            edge |= 1
    return mask, value, edge


def parse_bits(key: str) -> tuple[int, int]:
    """`5` or `16..23`: lowest and highest bit."""
    match = re.fullmatch(r"(\d+)(?:\.\.(\d+))?", key)
    if not match:
        raise FieldError(f"`{key}` is no bit", 'write a bit as "5", a field as "16..23"')
    low, high = int(match[1]), int(match[2] or match[1])
    if low > high:
        raise FieldError(f"the bit field {key} is empty", f'write the lower bit first: "{high}..{low}"')
    return low, high


def parse_scale(value: str | int) -> tuple[int, int]:
    """`1/1000` or `5`: numerator and denominator."""
    match = re.fullmatch(r"(\d+)(?:/(\d+))?", str(value))
    if not match or int(match[1]) == 0 or (match[2] and int(match[2]) == 0):
        raise FieldError(f"`{value}` is no scale", "write an exact fraction of whole numbers such as 1/1000")
    return int(match[1]), int(match[2] or 1)


def parse_number(key: str) -> int:
    """A key that is a number: `3`, `-1`, `0x1F`."""
    if not re.fullmatch(_NUMBER, key):
        raise FieldError(f"`{key}` is no number", "write a decimal or 0x number")
    return int(key, 0)
