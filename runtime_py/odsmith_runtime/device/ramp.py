"""The ramp generator: how fast an axis is one tick later; the twin of `ods_ramp.c`.

Pure functions. Velocities count 1/1000 microstep per second, distances 1/1,000,000 microstep, accelerations 1/1000
microstep per second and tick: a tick adds them up as they are (see `units`).
"""

from __future__ import annotations

from typing import NamedTuple

_FAR = 1 << 61  # further than any distance, and two of them can be added in 64 bits
_PLAIN = 1 << 31  # the way to stop from a speed below it is never that far


class Ramp(NamedTuple):
    """The parameters of a six point ramp (section 1.5 of the manuals), none of them negative."""

    v_start: int
    a1: int
    v1: int  # 0: a trapezoid of v_start, a2, v_max, d2 and v_stop
    a2: int
    v_max: int
    d2: int
    d1: int
    v_stop: int


def slow_down(velocity: int, deceleration: int) -> int:
    """Towards standstill on a single slope. A deceleration of 0 stops at once."""
    if not deceleration:
        return 0
    return max(velocity - deceleration, 0) if velocity > 0 else min(velocity + deceleration, 0)


def turn(velocity: int, target: int, acceleration: int, v_start: int, v_stop: int) -> int:
    """Towards a target velocity on a trapezoid whose slopes are equal (profile velocity mode).

    A change of direction leads through standstill. An acceleration of 0 never starts, and slows down at once.
    """
    if target < 0 or (target == 0 and velocity < 0):
        return -turn(-velocity, -target, acceleration, v_start, v_stop)
    if velocity < 0 or target == 0:
        speed = abs(velocity)
        slower = 0 if speed <= v_stop or not acceleration else max(speed - acceleration, v_stop)
        return -slower if velocity < 0 else slower
    if velocity < target:
        if not acceleration:
            return velocity
        return min(v_start if velocity < v_start else velocity + acceleration, target)
    return max(velocity - acceleration, target) if acceleration else target


def advance(ramp: Ramp, velocity: int, distance: int) -> tuple[int, bool]:
    """Towards a target on a six point ramp: the velocity, and whether the target is reached in this tick.

    In that tick the axis makes just the distance, and stands. Otherwise it is as fast as the ramp allows from where the
    target can still be reached without going past it. If that is nowhere, it slows down, stops and comes back.
    """
    if distance < 0 or (distance == 0 and velocity < 0):
        back, arrives = advance(ramp, -velocity, -distance)
        return -back, arrives
    if velocity < 0:
        return -_slower(ramp, -velocity), False
    low, high = _slower(ramp, velocity), _faster(ramp, velocity)
    if low <= distance <= high and not _slower(ramp, distance):
        return 0, True
    if _fits(ramp, high, distance):
        return high, False
    if _fits(ramp, low, distance):
        return _fastest(ramp, low, high, distance), False
    return low, False


def _fits(ramp: Ramp, speed: int, distance: int) -> bool:
    """Whether a tick at this speed leaves way enough to stop."""
    return speed + _way_to_stop(ramp, speed) <= distance


def _fastest(ramp: Ramp, low: int, high: int, distance: int) -> int:
    """The highest speed that fits, from one that does to one that does not. It is mostly the first, or near to it."""
    step = 1
    while low + step < high and _fits(ramp, low + step, distance):
        low += step
        step *= 2
    high = min(high, low + step)
    while high - low > 1:
        middle = (low + high) // 2
        if _fits(ramp, middle, distance):
            low = middle
        else:
            high = middle
    return low


def _slower(ramp: Ramp, speed: int) -> int:
    """A tick nearer to standstill. A speed at which the slope changes is not jumped over."""
    if speed <= ramp.v_stop:
        return 0
    if ramp.v1 and speed <= ramp.v1:
        deceleration, end = ramp.d1, ramp.v_stop
    else:
        deceleration, end = ramp.d2, max(ramp.v1, ramp.v_stop)
    return max(speed - deceleration, end) if deceleration else 0


def _faster(ramp: Ramp, speed: int) -> int:
    """A tick nearer to the cruising speed, or back to it."""
    if speed > ramp.v_max:
        return max(_slower(ramp, speed), ramp.v_max)
    if speed < ramp.v1:
        acceleration, end = ramp.a1, min(ramp.v1, ramp.v_max)
    else:
        acceleration, end = ramp.a2, ramp.v_max
    if not acceleration:
        return speed
    if speed < ramp.v_start:
        return min(ramp.v_start, ramp.v_max)
    return min(speed + acceleration, end)


def _way_to_stop(ramp: Ramp, speed: int) -> int:
    """The sum of all speeds that `_slower` leads through."""
    if speed <= ramp.v_stop:
        return 0
    way = 0
    deceleration = ramp.d2
    if ramp.v1:
        if speed > ramp.v1:
            if not deceleration:
                return 0
            end = max(ramp.v1, ramp.v_stop)
            way, speed = _way(speed, deceleration, end), end
        deceleration = ramp.d1
    if speed <= ramp.v_stop or not deceleration:
        return way
    return way + _way(speed, deceleration, ramp.v_stop)


def _way(speed: int, deceleration: int, end: int) -> int:
    """The sum of the speeds from the next one down to the end of a slope."""
    ticks = (speed - end + deceleration - 1) // deceleration
    if speed >= _PLAIN and ticks > _FAR // speed:
        return _FAR
    return (ticks - 1) * speed - (ticks - 1) * ticks // 2 * deceleration + end
