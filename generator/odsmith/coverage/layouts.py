"""Compares the drawings of the controlword and the statusword: bit numbers, and below them abbreviations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from odsmith.coverage.cells import Cell, cell, object_of
from odsmith.coverage.manual_text import TextCell, TextTable
from odsmith.coverage.words import mode_of, word_of
from odsmith.model import Bit, Device

_UNUSED = frozenset({"r", "nu"})
_OF_THE_MODE = "oms"
"""Reserved, not used, operation mode specific: the abbreviations that stand for no bit of their own."""


def layout(device: Device, table: TextTable) -> Iterator[Cell]:
    """A cell for each field. Numbers with a gap between them are the ends of a field; so are neighbours in one field of
    the model where there are more numbers than abbreviations, since the text does not show which cells are merged."""
    obj, mode = object_of(device, table), mode_of(device, table)
    rows = [[part for part in row if part.text] for row in table.rows]
    start = next((i for i, row in enumerate(rows) if row and all(part.text.isdecimal() for part in row)), len(rows))
    if obj is None or mode is None or not obj.entries[0].bits or len(rows) < start + 2 or not rows[start + 1]:
        yield cell(table, None, "layout", "no such word", False, ["objects"])
        return
    common = obj.entries[0].bits
    own = word_of(mode, obj.entries[0].role)
    numbers = [int(part.text) for part in rows[start]]
    names = rows[start + 1]
    fields = _fields(numbers, len(names), common)
    if len(fields) != len(names):
        yield cell(table, names[0], "layout", f"{len(fields)} fields", False, [f"objects.{obj.name}.bits"])
        return
    for name, (low, high) in zip(names, fields, strict=True):
        inside = [bit for bit in common if bit.low <= high and low <= bit.high]
        label = f"{low}..{high}" if low < high else str(low)
        shown = ", ".join(bit.name for bit in inside)
        same = _fits(name, low, high, inside, own)
        yield cell(table, name, f"bits {label}", shown, same, [f"objects.{obj.name}.bits.{label}"])


def _fields(numbers: Sequence[int], names: int, bits: Sequence[Bit]) -> list[tuple[int, int]]:
    """Lowest and highest bit of each field, from the left."""
    fields: list[tuple[int, int]] = []
    surplus = len(numbers) - names - sum(high - low > 1 for high, low in pairwise(numbers))
    rest = list(numbers)
    while rest:
        high, low = rest[0], rest[1] if len(rest) > 1 else rest[0]
        merged = surplus > 0 and low < high and any(bit.low <= low and high <= bit.high for bit in bits)
        if high - low > 1 or merged:
            surplus -= merged
            fields.append((low, high))
            del rest[:2]
        else:
            fields.append((high, high))
            del rest[0]
    return fields


def _fits(name: TextCell, low: int, high: int, inside: Sequence[Bit], own: Sequence[Bit]) -> bool:
    """True if an abbreviation may stand for what the model has there."""
    of_the_mode = [bit for bit in own if bit.low <= high and low <= bit.high]
    if name.text in _UNUSED:
        return not any(bit.supported for bit in of_the_mode) and all(
            bool(of_the_mode) or not bit.supported or _left_to_modes(bit) for bit in inside
        )
    if name.text == _OF_THE_MODE:
        return all(_left_to_modes(bit) for bit in inside)
    return len(inside) == 1 and (inside[0].low, inside[0].high) == (low, high) and _abbreviates(name.text, inside[0])


def _left_to_modes(bit: Bit) -> bool:
    return bit.name.startswith("mode_specific")


def _abbreviates(short: str, bit: Bit) -> bool:
    """`rtso` is ready_to_switch_on: its letters come in this order, the first of both is the same."""
    letters = iter(bit.name)
    return bit.name.startswith(short[:1]) and all(letter in letters for letter in short)
