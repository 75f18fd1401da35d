"""Finds the axes of a drive in the flat dictionary of an EDS: blocks of the same objects at a constant distance."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple


class Area(NamedTuple):
    """Objects that repeat: axis n has at `first + n * stride` what axis 0 has at `first`."""

    first: int
    stride: int


PROFILE = Area(0x6000, 0x800)
"""Where CiA 402 puts the axes."""

OTHER_AREAS = (Area(0x2000, 0x200), *(Area(first, 0x40) for first in (0x1400, 0x1600, 0x1800, 0x1A00)))
"""Where vendors put what else belongs to an axis; CiA 402 gives each axis 64 PDOs."""

MAX_AXES = 8
"""6000h to 9FFFh have room for eight."""


@dataclass(frozen=True, slots=True)
class Axes:
    """How many axes there are, and the areas that repeat for each. A device without axes has a count of 1."""

    count: int
    areas: tuple[Area, ...]

    def fold(self, index: int) -> tuple[int, int | None]:
        """The index on axis 0, and the axis; None for an object of the whole device."""
        for first, stride in self.areas:
            if first <= index < first + self.count * stride:
                axis, offset = divmod(index - first, stride)
                return first + offset, axis
        return index, None


def find_axes(indices: Iterable[int]) -> Axes:
    """The axes among the objects with these indices."""
    present = frozenset(indices)
    count = 1
    while count < MAX_AXES and _alike(present, PROFILE, count):
        count += 1
    if count == 1:
        return Axes(1, ())
    repeated = [area for area in OTHER_AREAS if all(_alike(present, area, axis) for axis in range(1, count))]
    return Axes(count, (PROFILE, *repeated))


def _alike(present: frozenset[int], area: Area, axis: int) -> bool:
    """More than half of the objects that axis 0 or this axis has are on both."""
    start = area.first + axis * area.stride
    first = {offset for offset in range(area.stride) if area.first + offset in present}
    other = {offset for offset in range(area.stride) if start + offset in present}
    return 2 * len(first & other) > len(first | other)
