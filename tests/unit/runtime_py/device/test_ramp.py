"""The ramp generator against the contract's words, and against what a ramp has to be whatever happens in mid-move.

The numbers are those of the generator: a tick adds an acceleration to a velocity and a velocity to a position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from hypothesis import example, given, settings
from hypothesis import strategies as st

from odsmith_runtime.device import ramp
from odsmith_runtime.device.ramp import Ramp

# ---- the contract, read word by word ---------------------------------------------------------------------------------


def slower(r: Ramp, speed: int) -> int:
    if speed <= r.v_stop:
        return 0
    if r.v1 and speed <= r.v1:
        return max(speed - r.d1, r.v_stop) if r.d1 else 0
    return max(speed - r.d2, r.v1, r.v_stop) if r.d2 else 0


def faster(r: Ramp, speed: int) -> int:
    if speed > r.v_max:
        return max(slower(r, speed), r.v_max)
    acceleration = r.a1 if speed < r.v1 else r.a2
    if not acceleration:
        return speed
    if speed < r.v_start:
        return min(r.v_start, r.v_max)
    return min(speed + acceleration, r.v_max, r.v1 if speed < r.v1 else r.v_max)


def way_to_stop(r: Ramp, speed: int) -> int:
    """The distance in which going slower in each tick leads to standstill."""
    way = 0
    while speed := slower(r, speed):
        way += speed
    return way


def next_of(r: Ramp, velocity: int, distance: int) -> tuple[int, int]:
    """Velocity and way of a tick. Slow: it tries all speeds."""
    if distance < 0 or (distance == 0 and velocity < 0):
        velocity, way = next_of(r, -velocity, -distance)
        return -velocity, -way
    if velocity < 0:
        back = -slower(r, -velocity)
        return back, back
    low, high = slower(r, velocity), faster(r, velocity)
    if low <= distance <= high and slower(r, distance) == 0:
        return 0, distance
    fitting = [speed for speed in range(low, high + 1) if speed + way_to_stop(r, speed) <= distance]
    speed = max(fitting, default=low)
    return speed, speed


# ---- what is drawn ---------------------------------------------------------------------------------------------------


def ramps(most: int, slowest: int = 0, flattest: int = 0) -> st.SearchStrategy[Ramp]:
    """Any ramp. With a slowest VMAX and a flattest slope it also comes to an end in a bearable number of ticks."""
    speed = st.integers(0, most)
    slope = st.integers(flattest, most)
    return st.builds(
        Ramp,
        v_start=st.just(0) | speed,
        a1=slope,
        v1=st.just(0) | speed,
        a2=slope,
        v_max=st.integers(slowest, most),
        d2=slope,
        d1=slope,
        v_stop=st.just(0) | speed,
    )


class Change(NamedTuple):
    """What the master does in mid-move, `after` so many ticks."""

    after: int
    ramp: Ramp
    target: int


live_ramps = ramps(10_000, slowest=500, flattest=20)
changes = st.lists(
    st.builds(Change, st.integers(1, 100), live_ramps, st.integers(-200_000, 200_000)),
    min_size=1,
    max_size=5,
)


@dataclass
class Tick:
    """A tick of a move: `distance` is the one before it, `way` what was made of it."""

    ramp: Ramp
    before: int
    velocity: int
    distance: int
    way: int
    arrives: bool

    @property
    def can_stop(self) -> bool:
        """Whether the target could still be reached without going past it."""
        return self.before * self.distance >= 0 and way_to_stop(self.ramp, abs(self.before)) <= abs(self.distance)


def drive(moves: Sequence[Change]) -> list[Tick]:
    """All ticks up to the last target."""
    ticks: list[Tick] = []
    position = velocity = 0
    for number, (after, parameters, target) in enumerate(moves):
        left = after if number + 1 < len(moves) else 20_000
        while left and (velocity or position != target):
            distance, before = target - position, velocity
            velocity, arrives = ramp.advance(parameters, velocity, distance)
            way = distance if arrives else velocity
            position += way
            ticks.append(Tick(parameters, before, velocity, distance, way, arrives))
            left -= 1
    assert (velocity, position) == (0, target), "a move does not end"
    return ticks


# ---- against the contract --------------------------------------------------------------------------------------------

SMALL = 40


@settings(max_examples=5 * settings().max_examples)
@given(ramps(SMALL), st.integers(-SMALL, SMALL), st.integers(-20 * SMALL, 20 * SMALL) | st.integers(-SMALL, SMALL))
def test_a_tick_is_that_of_the_contract(r: Ramp, velocity: int, distance: int) -> None:
    speed, arrives = ramp.advance(r, velocity, distance)
    assert (speed, distance if arrives else speed) == next_of(r, velocity, distance)


@settings(max_examples=5 * settings().max_examples)
@given(ramps(SMALL, flattest=1), st.integers(0, SMALL), st.integers(-2, 2 * SMALL))
def test_a_tick_is_that_of_the_contract_where_it_has_to_slow_down(r: Ramp, velocity: int, left: int) -> None:
    distance = way_to_stop(r, velocity) + left
    speed, arrives = ramp.advance(r, velocity, distance)
    assert (speed, distance if arrives else speed) == next_of(r, velocity, distance)


@given(ramps(100_000, flattest=100) | ramps(SMALL), st.integers(0, 200_000))
def test_way_to_stop_is_the_sum_of_all_slower_speeds(r: Ramp, speed: int) -> None:
    assert ramp._way_to_stop(r, speed) == way_to_stop(r, speed)


@given(st.integers(1, 1 << 60), st.integers(1, 1 << 20))
@example((1 << 32) * 1000, 1)
def test_the_way_to_stop_is_never_that_long(speed: int, deceleration: int) -> None:
    """What 64 bits could not hold is far, not wrong."""
    r = Ramp(0, 0, 0, 0, 0, deceleration, 0, 0)
    ticks = -(-speed // deceleration)
    exact = (ticks - 1) * speed - (ticks - 1) * ticks // 2 * deceleration
    way = ramp._way_to_stop(r, speed)
    assert way == exact if exact < 1 << 60 else 1 << 60 <= way <= 1 << 63


# ---- whatever happens in mid-move ------------------------------------------------------------------------------------


@given(changes)
def test_a_move_ends_exactly_at_its_target(moves: list[Change]) -> None:
    ticks = drive(moves)
    assert sum(tick.way for tick in ticks) == moves[-1].target
    assert not ticks or ticks[-1].velocity == 0


@given(changes)
def test_a_speed_is_never_beyond_v_max(moves: list[Change]) -> None:
    """Only where it was lowered; then the speed falls in each tick until it is not."""
    for tick in drive(moves):
        before, speed = abs(tick.before), abs(tick.velocity)
        assert speed <= tick.ramp.v_max if before <= tick.ramp.v_max else speed < before
        assert abs(tick.way) <= max(before, tick.ramp.v_max)


@given(changes)
def test_a_target_is_not_passed_by_an_axis_that_can_stop(moves: list[Change]) -> None:
    for tick in drive(moves):
        if tick.can_stop:
            left = tick.distance - tick.way
            assert left * tick.distance >= 0
            assert way_to_stop(tick.ramp, abs(tick.velocity)) <= abs(left)


@given(changes)
def test_an_axis_that_cannot_stop_in_time_gets_slower(moves: list[Change]) -> None:
    for tick in drive(moves):
        if not tick.can_stop and not tick.arrives:
            assert abs(tick.velocity) < abs(tick.before)
            assert tick.velocity * tick.before >= 0


@given(changes)
def test_accelerations_are_those_of_their_phase(moves: list[Change]) -> None:
    """But for the jump to VSTART, the one from VSTOP and the last step, which is what is left of the way."""
    for tick in drive(moves):
        r, before, speed = tick.ramp, abs(tick.before), abs(tick.velocity)
        if tick.arrives:
            assert before == 0 or slower(r, before) <= abs(tick.way)
            assert slower(r, abs(tick.way)) == 0
        elif speed > before:
            assert speed <= r.v_start or speed - before <= (r.a1 if before < r.v1 else r.a2)
            assert not before < r.v1 < speed or speed <= r.v_start
        elif speed < before:
            is_below = before <= r.v1
            assert before <= r.v_stop or before - speed <= (r.d1 if is_below else r.d2)
            assert before <= r.v_stop or is_below or speed >= r.v1


@given(changes)
def test_a_negative_move_is_the_mirror_of_a_positive_one(moves: list[Change]) -> None:
    mirrored = drive([move._replace(target=-move.target) for move in moves])
    assert [(-tick.velocity, -tick.way, tick.arrives) for tick in mirrored] == [
        (tick.velocity, tick.way, tick.arrives) for tick in drive(moves)
    ]


# ---- how long an undisturbed move takes ------------------------------------------------------------------------------


class Slope(NamedTuple):
    """Velocities that a constant acceleration leads through. Empty where `high` is not above `low`."""

    low: float
    high: float
    acceleration: float

    def up_to(self, peak: float) -> Slope:
        return self._replace(high=min(self.high, peak))

    @property
    def time(self) -> float:
        return (self.high - self.low) / self.acceleration if self.high > self.low else 0

    @property
    def way(self) -> float:
        return (self.high**2 - self.low**2) / (2 * self.acceleration) if self.high > self.low else 0


def closed_form(r: Ramp, distance: int) -> float:
    """Ticks that a move takes in continuous time.

    It consists of the slopes A1, A2, D2 and D1, each up to the peak velocity at most, and of a way at the peak. The way
    of a slope is linear in the square of the peak, so their sum is a polyline, and the peak of a move without cruising
    lies where that polyline meets the distance. Before all that the jump to VSTART takes a tick.
    """
    jump = 1 if r.v_start else 0
    distance -= jump * r.v_start
    slopes = (
        Slope(r.v_start, r.v1, r.a1),
        Slope(max(r.v_start, r.v1), math.inf, r.a2),
        Slope(max(r.v_stop, r.v1), math.inf, r.d2),
        Slope(r.v_stop, r.v1, r.d1),
    )

    def way(peak: float) -> float:
        return sum(slope.up_to(peak).way for slope in slopes)

    corners = sorted({float(r.v_max), *(slope.low for slope in slopes if slope.low < r.v_max)})
    peak = next((corner for corner in corners if way(corner) >= distance), float(r.v_max))
    if way(peak) > distance:
        low = max((corner for corner in corners if corner < peak), default=0.0)
        share = (distance - way(low)) / (way(peak) - way(low))
        peak = math.sqrt(low**2 + share * (peak**2 - low**2))
    return jump + sum(slope.up_to(peak).time for slope in slopes) + max(distance - way(peak), 0) / peak


def takes_the_time_of_the_closed_form(r: Ramp, distance: int) -> bool:
    expected = closed_form(r, distance)
    return abs(len(drive([Change(1, r, distance)])) - expected) <= max(2, expected / 100)


speeds = st.integers(1_000, 100_000)
slopes = st.integers(50, 1_000)
shares = st.just(0.0) | st.floats(0.5, 1)
distances = st.integers(1, 1_000_000) | st.integers(1, 10_000_000)


@given(speeds, slopes, slopes, distances)
def test_time_of_a_trapezoid(v_max: int, a2: int, d2: int, distance: int) -> None:
    assert takes_the_time_of_the_closed_form(Ramp(0, 0, 0, a2, v_max, d2, 0, 0), distance)


@given(speeds, slopes, slopes, slopes, slopes, st.floats(0.5, 1.5), distances)
def test_time_of_six_points(v_max: int, a1: int, a2: int, d2: int, d1: int, v1: float, distance: int) -> None:
    """V1 also above VMAX, and moves too short to reach either."""
    assert takes_the_time_of_the_closed_form(Ramp(0, a1, int(v1 * v_max), a2, v_max, d2, d1, 0), distance)


@given(speeds, slopes, slopes, st.floats(0.5, 1.5), shares, shares, st.floats(0, 10))
def test_time_with_start_and_stop_speed(
    v_max: int, slope_1: int, slope_2: int, v1: float, v_start: float, v_stop: float, longer: float
) -> None:
    """Moves that are long enough to reach both of them."""
    r = Ramp(int(v_start * v_max), slope_1, int(v1 * v_max), slope_2, v_max, slope_1, slope_2, int(v_stop * v_max))
    least = max(r.v_start, r.v_stop) ** 2 // min(slope_1, slope_2) + v_max
    assert takes_the_time_of_the_closed_form(r, int(least * (1 + longer)))
