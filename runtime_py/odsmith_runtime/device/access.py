"""Access to an entry by its owner's rules: what an SDO and an RPDO have in common; the twin of `ods_access.c`.

A write is checked in this order: access, length, the present state, the value, what the effect refuses. Nothing changes
before all of it has passed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode

from .. import codec
from . import effect

if TYPE_CHECKING:
    from .node import Node
    from .od import Cell


def readable(node: Node, cell: Cell) -> int:
    """Whether an entry may be read now: 0 or an abort code."""
    if not cell.entry.readable:
        return AbortCode.WRITE_ONLY
    return AbortCode.DEVICE_STATE if _is_handed_over(node, cell) else 0


def check_length(cell: Cell, length: int) -> int:
    """Whether an entry takes so many octets: 0 or an abort code."""
    if length > cell.size:
        return AbortCode.TOO_LONG
    if length < cell.size and cell.entry.type != codec.TEXT:
        return AbortCode.TOO_SHORT
    return 0


def write(node: Node, cell: Cell, octets: bytes) -> int:
    """Write an entry; the number of octets has been checked. 0 or an abort code."""
    abort = _check_state(node, cell)
    if not abort and cell.is_number:
        number = cell.number(octets)
        abort = cell.check(number)
        if not abort and cell.instance.axis is None:
            abort, number = effect.check(node, cell, number)
            octets = (number & ((1 << 8 * cell.size) - 1)).to_bytes(cell.size, "little")
    if abort:
        return abort
    cell.write(octets)
    if cell.entry.transmittable:
        node.value_changed(cell.instance)
    if cell.entry.effect != "value":
        effect.apply(node, cell)
    return 0


def _is_handed_over(node: Node, cell: Cell) -> bool:
    """In TMCL mode the objects of the axes are out of reach."""
    return node.values.tmcl_mode != 0 and cell.instance.axis is not None


def _check_state(node: Node, cell: Cell) -> int:
    """Whether the present state forbids the write."""
    axis = cell.instance.axis
    if axis is None:
        return effect.check_state(node, cell)
    if _is_handed_over(node, cell):
        return AbortCode.DEVICE_STATE
    states = cell.entry.writable_in
    return AbortCode.DEVICE_STATE if states and node.axes[axis].state not in states else 0
