"""Set-points in a fixed cycle: csp and csv, many axes in step."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from odsmith_cia.codes import ModeCode

from . import diagnosis

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from .async_axis import AsyncAxis
    from .core import Core
    from .errors import EmergencyError

TARGETS: Mapping[int, str] = {
    ModeCode.CYCLIC_SYNCHRONOUS_POSITION: "target_position",
    ModeCode.CYCLIC_SYNCHRONOUS_VELOCITY: "target_velocity",
}
"""The role of the set-point in each cyclic mode."""

_EXPONENTS = (-3, -4, -2, -1, 0)
"""Powers of ten for the cycle time, the most usual one first."""


async def prepare(core: Core, axes: Sequence[AsyncAxis], period: float, mode: int) -> None:
    """Tell the axes the cycle time and choose the mode; they stand until the first set-point."""
    for axis in axes:
        value, exponent = _time_period(core, axis.number, period)
        for role, number in (
            ("interpolation_time_period_value", value),
            ("interpolation_time_period_index", exponent),
        ):
            await core.access.write(core.facts.entry(role, axis.number), number)
        await axis.set_mode(mode)
        await axis.resume()
        await axis.require_enabled()


def _time_period(core: Core, axis: int, period: float) -> tuple[int, int]:
    """Mantissa and power of ten of a cycle time. Raises ValueError for one that 60C2h cannot say."""
    mantissa = core.facts.entry("interpolation_time_period_value", axis)
    power = core.facts.entry("interpolation_time_period_index", axis)
    exact = Fraction(period).limit_denominator(1_000_000)
    for exponent in _EXPONENTS:
        value = exact / Fraction(10) ** exponent
        if value.denominator == 1 and power.allows(exponent) and 0 < value <= (mantissa.high or 0):
            return int(value), exponent
    raise ValueError(f"{mantissa.label} cannot say a cycle of {period:g} s")


async def stream(
    core: Core, rows: Iterable[Mapping[int, int]], period: float, mode: int, keep_going: bool
) -> dict[int, EmergencyError]:
    """Send a row of set-points and SYNC in each cycle; `AsyncDrive.stream` says the rest."""
    link, exchange, role = core.link, core.exchange, TARGETS[mode]
    failed: dict[int, EmergencyError] = {}
    told = len(link.emergencies)
    exchange.sync_is_produced = True
    try:
        due = link.now()
        for row in rows:
            targets = {core.facts.entry(role, axis): value for axis, value in row.items() if axis not in failed}
            await core.put(targets)
            exchange.sync()
            due += period
            await link.pause_until(due)
            for axis, error in _faults(core, told):
                if not keep_going:
                    raise error
                failed[axis] = error
            told = len(link.emergencies)
        await link.pause(period)  # for the last way, which began a little after its frame was sent
    finally:
        exchange.sync_is_produced = False
    return failed


def _faults(core: Core, told: int) -> Iterator[tuple[int, EmergencyError]]:
    """The axes that became faulty since so many emergencies, and why."""
    for frame in core.link.emergencies[told:]:
        error = diagnosis.emergency(core.facts, frame)
        if frame.code >> 8 and error.emergency and error.emergency.reaction.startswith("fault"):
            axes = range(core.facts.dictionary.axis_count) if error.axis is None else (error.axis,)
            yield from ((axis, error) for axis in axes)
