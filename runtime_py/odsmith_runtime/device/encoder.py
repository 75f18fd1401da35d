"""The encoder of an axis: where the shaft really is; the twin of `ods_encoder.c`.

It is in use while 608Fh:01 is not 0. Then an increment is 2001h * 2^(2000h) * 608Fh:02 / 608Fh:01 microsteps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .port import Lines
from .units import PER_MICROSTEP, int32, truncate

if TYPE_CHECKING:
    from .axis import Axis

_ACTIVE_HIGH = 0x01  # 200Bh:01
_REVERSED = 0x01  # 200Bh:02
_ONCE, _EACH = 0x01, 0x02  # 200Fh:01


class Encoder:
    """`position` in microsteps, `velocity` in 1/1000 microstep per second; `has_pulse`: the index has just begun."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self.reset()

    def reset(self) -> None:
        self._origin = 0  # the position at...
        self._increments = 0  # ...0 increments, which count from there
        self._count = self._axis.answer.encoder
        self.position = 0
        self.velocity = 0
        self._is_index = False
        self.has_pulse = False

    @property
    def is_used(self) -> bool:
        return bool(self._axis.values.encoder_increments)

    def set_position(self, position: int) -> None:
        """The shaft stands at a position."""
        self._origin = self.position = position
        self._increments = 0

    def sample(self) -> None:
        """Read the encoder. Before the axis moves in a tick."""
        axis = self._axis
        turned = int32(axis.answer.encoder - self._count)
        self._count = axis.answer.encoder
        if axis.values.encoder_direction & _REVERSED:
            turned = int32(-turned)
        before = self.position
        if self.is_used:
            self._increments += turned
            self._fold()
            self.position = int32(self._origin + self._microsteps(self._increments))
        self.velocity = int32(self.position - before) * PER_MICROSTEP
        self._find_pulse()

    def _fold(self) -> None:
        """Whole revolutions go into the origin, so that the count of increments stays small."""
        turns = truncate(self._increments, self._axis.values.encoder_increments)
        self._increments -= turns * self._axis.values.encoder_increments
        self._origin = int32(self._origin + turns * self._per_turn)

    @property
    def _per_turn(self) -> int:
        """Microsteps that 608Fh:01 increments stand for."""
        values = self._axis.values
        return values.fullstep_resolution * (1 << values.microstep_resolution) * values.encoder_motor_revolutions

    def _microsteps(self, increments: int) -> int:
        return truncate(increments * self._per_turn, self._axis.values.encoder_increments)

    def follow(self, position: int) -> None:
        """Where the axis went in a tick: without an encoder in use the shaft is there."""
        if not self.is_used:
            self.set_position(position)

    def parameter_written(self) -> None:
        """Counts made before are not read anew."""
        self.set_position(self.position)

    def _find_pulse(self) -> None:
        """The index begins: latch the positions if 200Fh says so."""
        values = self._axis.values
        is_high = bool(self._axis.answer.lines & Lines.INDEX)
        is_index = is_high == bool(values.encoder_polarity & _ACTIVE_HIGH)
        self.has_pulse = is_index and not self._is_index
        self._is_index = is_index
        if self.has_pulse and values.encoder_latch_mode & (_ONCE | _EACH):
            values.latched_internal_position = self._axis.motion.demand
            values.latched_encoder_position = self.position
            values.encoder_latch_mode &= ~_ONCE
