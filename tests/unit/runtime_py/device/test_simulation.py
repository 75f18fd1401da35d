"""The simulated hardware of an axis: what it does is plain enough to be said once more, from the outside."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime.device import DriverFlags, Lines, MotorAnswer, MotorDemand, Output
from odsmith_runtime.device.simulation import INPUTS, SUPPLY, Simulation

MIN, MAX = -0x80000000, 0x7FFFFFFF

steps = st.integers(-300, 300)
walks = st.lists(steps, max_size=40)
positions = st.integers(-500, 500)


def powered(**inputs: int) -> Simulation:
    """An axis whose motor has current."""
    axis = Simulation()
    for name, value in inputs.items():
        axis.set(name, value)
    axis.output(Output.CURRENT, 17)
    return axis


def walk(axis: Simulation, way: Iterable[int]) -> list[MotorAnswer]:
    return [axis.motor(MotorDemand(step, 1000 * step)) for step in way]


def lines(axis: Simulation) -> Lines:
    return Lines(axis.answer.lines)


# ---- the shaft -------------------------------------------------------------------------------------------------------


@given(walks)
def test_the_shaft_makes_every_step(way: list[int]) -> None:
    axis = powered()
    walk(axis, way)
    assert axis.shaft == sum(way)


def test_a_shaft_turns_only_with_current_and_only_if_it_can() -> None:
    axis = Simulation()
    walk(axis, [5])
    axis.output(Output.POWER, 1)
    walk(axis, [5])
    assert axis.shaft == 0
    axis.output(Output.CURRENT, 1)
    walk(axis, [5])
    assert axis.shaft == 5
    axis.set("blocked", 1)
    walk(axis, [5])
    assert axis.shaft == 5
    axis.set("blocked", 0)
    axis.output(Output.CURRENT, 0)
    walk(axis, [5])
    assert axis.shaft == 5


def test_a_hand_turns_it_at_any_time() -> None:
    axis = Simulation()
    axis.set("left_at", -10)
    axis.set("shaft", -10)
    assert axis.shaft == -10
    assert lines(axis) == Lines.LEFT


def test_power_changes_nothing_on_the_bench() -> None:
    axis = powered(left_at=100, temperature=130, right=1, load=23)
    axis.output(Output.DRIVER, DriverFlags.STEALTH_CHOP)
    before = walk(axis, [7])[-1]
    assert (before.velocity, before.load, before.pwm_scale) == (7000, 1000, 7)
    axis.power_on()
    assert axis.shaft == 7
    assert axis.answer == before._replace(velocity=0, load=0, pwm_scale=0)
    walk(axis, [7])
    assert axis.shaft == 7, "no current was put out since"
    assert axis.answer == before._replace(pwm_scale=0)


# ---- switches --------------------------------------------------------------------------------------------------------


def outside(axis: Simulation, line: Lines, near: int, far: int) -> int:
    """Microsteps from the shaft to where the switch is active."""
    distances = {Lines.LEFT: axis.shaft - near, Lines.RIGHT: near - axis.shaft}
    return max(0, distances.get(line, max(near - axis.shaft, axis.shaft - far)))


@given(
    st.sampled_from([Lines.LEFT, Lines.RIGHT, Lines.HOME]), positions, st.integers(0, 200), st.integers(0, 400), walks
)
def test_hysteresis(line: Lines, near: int, width: int, hysteresis: int, way: list[int]) -> None:
    """Inside a switch is active, far outside it is not, and in between it stays as it was."""
    axis = powered(hysteresis=hysteresis)
    if line is Lines.HOME:
        axis.set("home_to", near + width)
    axis.set({Lines.LEFT: "left_at", Lines.RIGHT: "right_at", Lines.HOME: "home_from"}[line], near)
    for step in way:
        was = lines(axis)
        axis.motor(MotorDemand(step, step))
        distance = outside(axis, line, near, near + width)
        if distance == 0:
            assert lines(axis) == line
        elif distance > hysteresis:
            assert lines(axis) == Lines(0)
        else:
            assert lines(axis) == was


@given(positions, positions, positions, st.integers(0, 400), walks)
def test_what_is_mirrored_moves_like_its_mirror(
    at: int, home_from: int, home_to: int, hysteresis: int, way: list[int]
) -> None:
    encoder = {"hysteresis": hysteresis, "revolution": 1, "increments": 3}
    plain = powered(left_at=at, home_from=home_from, home_to=home_to, **encoder)
    mirror = powered(right_at=-at, home_from=-home_to, home_to=-home_from, **encoder)
    for answer, mirrored in zip(walk(plain, way), walk(mirror, (-step for step in way)), strict=True):
        assert mirrored.velocity == -answer.velocity
        assert mirrored.encoder == -answer.encoder
        assert (mirrored.load, mirrored.faults) == (answer.load, answer.faults)
        swapped = {Lines.LEFT: Lines.RIGHT}
        assert Lines(mirrored.lines) == sum((swapped.get(line, line) for line in Lines(answer.lines)), Lines(0))


@pytest.mark.parametrize(("name", "line"), [("left", Lines.LEFT), ("right", Lines.RIGHT), ("home", Lines.HOME)])
def test_a_hand_presses_a_switch(name: str, line: Lines) -> None:
    axis = powered(hysteresis=100, left_at=-1, right_at=1, home_from=1, home_to=2)
    axis.set(name, 1)
    assert lines(axis) == line
    axis.set(name, 0)
    assert lines(axis) == Lines(0), "hysteresis is of those at positions"


def test_there_is_no_switch_before_its_place_is_known() -> None:
    axis = powered(home_from=0, left_at=-1, right_at=1)
    assert lines(axis) == Lines(0)
    axis.set("home_to", 0)
    assert lines(axis) == Lines.HOME


# ---- what is measured ------------------------------------------------------------------------------------------------


def test_load_and_velocity() -> None:
    axis = powered(load=23)
    assert axis.answer.load == 0, "nothing was measured yet"
    assert axis.motor(MotorDemand(-1, -1))[2:4] == (-1, 1000)
    axis.set("load", 1023)
    assert axis.answer.load == 1000, "it is measured in motion"
    assert axis.motor(MotorDemand(0, 0))[2:4] == (0, 1000)
    assert axis.motor(MotorDemand(1, MAX))[2:4] == (MAX, 0)
    axis.set("load", 0)
    assert axis.motor(MotorDemand(1, MIN))[2:4] == (MIN, 1023)
    axis.set("blocked", 1)
    assert axis.motor(MotorDemand(0, 0))[2:4] == (0, 1023)
    assert axis.motor(MotorDemand(1, 1))[2:4] == (0, 0)


@pytest.mark.parametrize(
    ("velocity", "scale"), [(0, 0), (999, 0), (1000, 1), (-1999, 1), (255_000, 255), (256_000, 255), (MIN, 255)]
)
def test_pwm_scale(velocity: int, scale: int) -> None:
    axis = powered()
    assert axis.motor(MotorDemand(0, velocity)).pwm_scale == 0
    axis.output(Output.DRIVER, DriverFlags.STEALTH_CHOP | DriverFlags.COOL_STEP)
    assert axis.motor(MotorDemand(0, velocity)).pwm_scale == scale
    axis.output(Output.DRIVER, DriverFlags.COOL_STEP)
    assert axis.motor(MotorDemand(0, velocity)).pwm_scale == 0


LEVELS = [
    ("temperature_warning", "temperature", 119, 120, 111, 110),
    ("overtemperature", "temperature", 149, 150, 141, 140),
    ("undervoltage", SUPPLY, 7000, 6999, 7499, 7500),
]


@pytest.mark.parametrize(("condition", "name", "good", "bad", "still", "well"), LEVELS)
def test_conditions_begin_and_end_at_their_levels(
    condition: str, name: str, good: int, bad: int, still: int, well: int
) -> None:
    axis = Simulation()
    for value, holds in ((good, False), (bad, True), (still, True), (well, False), (still, False), (good, False)):
        axis.set(name, value)
        assert (condition in axis.answer.faults) == holds, value
        assert axis.motor(MotorDemand()).faults == axis.answer.faults


def test_at_first_all_is_well() -> None:
    assert Simulation().answer == Simulation().motor(MotorDemand()) == MotorAnswer()


# ---- encoder ---------------------------------------------------------------------------------------------------------


@given(st.integers(MIN, MAX), st.integers(1, MAX), st.integers(1, MAX))
def test_encoder(shaft: int, revolution: int, increments: int) -> None:
    """The count is the angle in increments, rounded down; the index is once in a revolution, at its beginning."""
    axis = powered(revolution=revolution, increments=increments)
    axis.set("shaft", shaft)
    count = axis.answer.encoder
    assert MIN <= count <= MAX
    assert (count - shaft * increments // revolution) % (1 << 32) == 0
    into = shaft - shaft // revolution * revolution
    assert (lines(axis) == Lines.INDEX) == (into == 0 or into < revolution // increments)


def test_without_increments_there_is_no_encoder() -> None:
    axis = powered(shaft=-12345)
    assert (axis.answer.encoder, axis.answer.lines) == (0, 0)


@pytest.mark.parametrize(
    ("shaft", "count", "index"), [(-1, -1, False), (0, 0, True), (127, 0, True), (128, 1, False), (51_200, 400, True)]
)
def test_a_usual_encoder(shaft: int, count: int, index: bool) -> None:
    axis = powered(increments=400, shaft=shaft)  # 128 microsteps for each increment
    assert (axis.answer.encoder, lines(axis) == Lines.INDEX) == (count, index)


# ---- inputs ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", INPUTS)
def test_ranges(name: str) -> None:
    axis, low, high = Simulation(), INPUTS[name].low, INPUTS[name].high
    for value in (low - 1, high + 1):
        with pytest.raises(ValueError, match=name):
            axis.set(name, value)
    assert (axis.shaft, axis.answer) == (0, MotorAnswer())
    axis.set(name, low)
    axis.set(name, high)


def test_what_there_is_not_cannot_be_set() -> None:
    with pytest.raises(KeyError):
        Simulation().set("button", 1)
