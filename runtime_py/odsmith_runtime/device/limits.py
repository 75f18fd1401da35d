"""Limit switches, the home switch and software limits of an axis; the twin of `ods_limits.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import ModeCode
from odsmith_cia.words import Condition

from .port import Lines

if TYPE_CHECKING:
    from .axis import Axis

# Bits of the digital inputs 60FDh (CiA 402).
LEFT, RIGHT, HOME = 0x1, 0x2, 0x4
_GENERAL = 0x00FF0000

# Each line with its bits in the switch parameters 2005h, and its bit in 60FDh.
_SWITCHES = (
    (Lines.LEFT, 0x01, 0x04, LEFT),
    (Lines.RIGHT, 0x02, 0x08, RIGHT),
    (Lines.HOME, 0x10, 0x20, HOME),
)

_POSITIVE = {Condition.LIMIT_SWITCH_POSITIVE, Condition.SOFTWARE_LIMIT_POSITIVE}
_NEGATIVE = {Condition.LIMIT_SWITCH_NEGATIVE, Condition.SOFTWARE_LIMIT_NEGATIVE}

_INT32 = range(-(1 << 31), 1 << 31)


class Limits:
    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self.conditions: set[str] = set()  # those found at the end of the last tick

    def reset(self) -> None:
        self.conditions = set()

    def sample(self) -> None:
        """Switches as 2005h says how to read them, and the general inputs of the module."""
        axis = self._axis
        inputs = axis.node.values.general_inputs & _GENERAL
        parameters = axis.values.switch_parameters
        for line, off, inverted, bit in _SWITCHES:
            is_high = bool(axis.answer.lines & line)
            if not parameters & off and is_high != bool(parameters & inverted):
                inputs |= bit
        axis.values.digital_inputs = inputs

    def blocks(self, velocity: int) -> bool:
        """Whether something forbids to move that way. A homing looks for its switches and is not held back."""
        axis = self._axis
        if not velocity or axis.values.modes_of_operation_display == ModeCode.HOMING:
            return False
        switch, conditions = (RIGHT, _POSITIVE) if velocity > 0 else (LEFT, _NEGATIVE)
        return bool(axis.values.digital_inputs & switch or axis.conditions & conditions)

    def check(self) -> None:
        """Which limits have been reached in this tick."""
        values = self._axis.values
        found: set[str] = set()
        if values.modes_of_operation_display != ModeCode.HOMING:
            lowest, highest = self._software_limits()
            if values.position_actual_value > highest:
                found.add(Condition.SOFTWARE_LIMIT_POSITIVE)
            if values.position_actual_value < lowest:
                found.add(Condition.SOFTWARE_LIMIT_NEGATIVE)
            if values.digital_inputs & RIGHT:
                found.add(Condition.LIMIT_SWITCH_POSITIVE)
            if values.digital_inputs & LEFT:
                found.add(Condition.LIMIT_SWITCH_NEGATIVE)
        self.conditions = found

    @property
    def is_active(self) -> bool:
        """Whether a limit holds the axis back."""
        return bool(self._axis.conditions & (_POSITIVE | _NEGATIVE))

    def clamp(self, target: int) -> int:
        """The position allowed that is nearest to a target."""
        lowest, highest = self._software_limits()
        return min(max(target, lowest, _INT32[0]), max(highest, _INT32[0]), _INT32[-1])

    def _software_limits(self) -> tuple[int, int]:
        """607Dh is counted from the home position (manual, section 6.1.11)."""
        values = self._axis.values
        offset = values.home_offset_display
        return values.software_position_limit_minimum - offset, values.software_position_limit_maximum - offset
