"""The simulated hardware of an axis is one in C and in Python, call by call.

`tests/unit/runtime_py/device/test_simulation.py` says what it does.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import pytest
from cffi import FFI  # type: ignore[import-untyped]
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cross.build import Build, build_simulation, shared_folder

from odsmith.vocabulary import Vocabulary
from odsmith_runtime.device import DriverFlags, MotorAnswer, MotorDemand, Output
from odsmith_runtime.device.simulation import INPUTS, Simulation

pytestmark = pytest.mark.slow

_FFI = FFI()
_FFI.cdef("""
    typedef struct { int32_t steps; int32_t velocity; } ods_motor_demand_t;
    typedef struct {
        uint32_t faults;
        int32_t encoder;
        int32_t velocity;
        uint16_t load;
        uint8_t pwm_scale;
        uint8_t lines;
    } ods_motor_answer_t;
    size_t simulation_size(void);
    int64_t simulation_shaft(const void *axis);
    void simulation_answer(const void *axis, ods_motor_answer_t *answer);
    void ods_simulation_init(void *axis);
    void ods_simulation_power_on(void *axis);
    int ods_simulation_find(const char *name);
    int ods_simulation_set(void *axis, int input, int32_t value);
    void ods_simulation_output(void *axis, int output, uint32_t value);
    void ods_simulation_motor(void *axis, const ods_motor_demand_t *demand, ods_motor_answer_t *answer);
""")

MIN, MAX = -0x80000000, 0x7FFFFFFF


class InC:
    """The same interface over the C functions."""

    def __init__(self, library: Any, conditions: list[str]) -> None:
        self._library = library
        self._conditions = conditions
        self._axis = _FFI.new("char[]", library.simulation_size())
        library.ods_simulation_init(self._axis)

    @property
    def shaft(self) -> int:
        return int(self._library.simulation_shaft(self._axis))

    @property
    def answer(self) -> MotorAnswer:
        answer = _FFI.new("ods_motor_answer_t *")
        self._library.simulation_answer(self._axis, answer)
        return self._converted(answer)

    def power_on(self) -> None:
        self._library.ods_simulation_power_on(self._axis)

    def set(self, name: str, value: int) -> None:
        input = self._library.ods_simulation_find(name.encode())
        if not self._library.ods_simulation_set(self._axis, input, value):
            raise ValueError

    def output(self, output: Output, value: int) -> None:
        self._library.ods_simulation_output(self._axis, output, value)

    def motor(self, demand: MotorDemand) -> MotorAnswer:
        answer = _FFI.new("ods_motor_answer_t *")
        self._library.ods_simulation_motor(self._axis, _FFI.new("ods_motor_demand_t *", demand), answer)
        return self._converted(answer)

    def _converted(self, answer: Any) -> MotorAnswer:
        faults = frozenset(name for bit, name in enumerate(self._conditions) if answer.faults >> bit & 1)
        return MotorAnswer(faults, answer.encoder, answer.velocity, answer.load, answer.pwm_scale, answer.lines)


@pytest.fixture(scope="module")
def library(c_build: Build, vocabulary: Vocabulary, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return _FFI.dlopen(str(build_simulation(vocabulary, c_build, shared_folder(tmp_path_factory.getbasetemp()))))


@pytest.fixture(scope="module")
def start_c(library: Any, vocabulary: Vocabulary) -> Callable[[], InC]:
    conditions = [name for name, condition in vocabulary.conditions.items() if condition.scope == "axis"]
    return lambda: InC(library, conditions)


LEVELS = {"temperature": (110, 120, 140, 150), "supply": (7000, 7500), "revolution": (2, 51_200), "load": (1023,)}
"""Values around which something happens, beside those around 0 and the ends of the range."""


def _setting(name: str) -> st.SearchStrategy[tuple[str, str, int]]:
    low, high, _ = INPUTS[name]
    levels = [level + by for level in LEVELS.get(name, (0,)) for by in (-1, 0, 1)]
    ends = [value for value in (low - 1, low, high, high + 1) if MIN <= value <= MAX]
    near = st.integers(max(low, -300), min(high, 300))
    values = st.one_of(near, st.sampled_from(levels), st.sampled_from(ends), st.integers(MIN, MAX))
    return st.tuples(st.just("set"), st.just(name), values)


steps = st.one_of(st.integers(-500, 500), st.integers(MIN, MAX))
velocities = st.one_of(st.integers(-500, 500), st.integers(-300_000, 300_000), st.integers(MIN, MAX))
flags = st.sampled_from([DriverFlags.STEALTH_CHOP, DriverFlags.COOL_STEP, ~DriverFlags(0)])

motion = st.tuples(st.just("motor"), steps, velocities)
call = st.one_of(
    motion,
    motion.map(lambda same: same),  # one_of leaves out what it is given twice
    st.sampled_from(sorted(INPUTS)).flatmap(_setting),
    st.sampled_from(sorted(LEVELS)).flatmap(_setting),
    st.tuples(st.just("output"), st.just(Output.DRIVER), flags),
    st.tuples(st.just("output"), st.sampled_from(list(Output)[4:]), st.integers(0, 31)),
    st.just(("power_on",)),
)


@settings(max_examples=300)
@given(calls=st.lists(call, min_size=10, max_size=60))
def test_twins(start_c: Callable[[], InC], calls: list[tuple[Any, ...]]) -> None:
    twins: tuple[Simulation | InC, ...] = (Simulation(), start_c())
    python, c = twins
    for axis in twins:
        axis.output(Output.CURRENT, 8)
    for name, *arguments in calls:
        results = []
        for axis in twins:
            try:
                given_to = [MotorDemand(*arguments)] if name == "motor" else arguments
                results.append(getattr(axis, name)(*given_to))
            except ValueError:
                results.append("refused")
        assert results[0] == results[1]
        assert python.shaft == c.shaft
        assert python.answer == c.answer


@pytest.mark.parametrize("name", ["temperature", "supply"])
def test_each_way_from_level_to_level(start_c: Callable[[], InC], name: str) -> None:
    python, c = Simulation(), start_c()
    levels = [level + by for level in LEVELS[name] for by in (-1, 0, 1)]
    for value in (value for pair in product(levels, repeat=2) for value in pair):
        python.set(name, value)
        c.set(name, value)
        assert python.answer == c.answer, value


def test_each_pwm_scale(start_c: Callable[[], InC]) -> None:
    python, c = Simulation(), start_c()
    for axis in (python, c):
        axis.output(Output.DRIVER, DriverFlags.STEALTH_CHOP)
    for velocity in range(-258_000, 258_001, 500):
        assert python.motor(MotorDemand(0, velocity)) == c.motor(MotorDemand(0, velocity))


def test_names(library: Any) -> None:
    found = [library.ods_simulation_find(name.encode()) for name in INPUTS]
    assert found == list(range(len(INPUTS)))
    assert library.ods_simulation_find(b"button") == len(INPUTS)
