"""The ramp generators of C and Python give the same numbers, whatever they are asked."""

from __future__ import annotations

from typing import Any

import pytest
from cffi import FFI  # type: ignore[import-untyped]
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.cross.build import RUNTIME, WARNINGS, Build, run

from odsmith_runtime.device import ramp
from odsmith_runtime.device.ramp import Ramp

pytestmark = pytest.mark.slow

_FFI = FFI()
_FFI.cdef("""
    typedef struct { int64_t v_start, a1, v1, a2, v_max, d2, d1, v_stop; } ods_ramp_t;
    int64_t ods_ramp_slow_down(int64_t velocity, int64_t deceleration);
    int64_t ods_ramp_turn(int64_t velocity, int64_t target, int64_t acceleration, int64_t v_start, int64_t v_stop);
    int64_t ods_ramp_advance(const ods_ramp_t *ramp, int64_t velocity, int64_t distance, int *arrives);
""")

FASTEST = ((1 << 32) - 1) * 1000  # pps, of an UNSIGNED32
STEEPEST = ((1 << 32) - 1) * 244140625 // 2097152  # in internal units
FARTHEST = ((1 << 32) - 1) * 1_000_000  # microsteps, from one end of the INTEGER32 to the other


@pytest.fixture(scope="module")
def c(c_build: Build, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The functions of `ods_ramp.c`."""
    library = tmp_path_factory.mktemp("ramp") / "ods_ramp.so"
    source = RUNTIME / "src" / "ods_ramp.c"
    run([*c_build.command, "-std=c99", "-O2", "-fPIC", "-shared", *WARNINGS, str(source), "-o", str(library)])
    return _FFI.dlopen(str(library))


def up_to(most: int) -> st.SearchStrategy[int]:
    """Numbers of every size."""
    return st.just(0) | st.integers(0, 20) | st.integers(0, min(most, 1_000_000)) | st.integers(0, most)


def either_way(size: st.SearchStrategy[int]) -> st.SearchStrategy[int]:
    return st.builds(lambda number, sign: number * sign, size, st.sampled_from([1, -1]))


speeds = up_to(FASTEST)
velocities = either_way(speeds)
slopes = up_to(STEEPEST)
distances = either_way(up_to(FARTHEST))
ramps = st.builds(Ramp, speeds, slopes, speeds, slopes, speeds, slopes, slopes, speeds)


def advance_in_c(c: Any, r: Ramp, velocity: int, distance: int) -> tuple[int, bool]:
    arrives = _FFI.new("int *")
    speed = c.ods_ramp_advance(_FFI.new("ods_ramp_t *", r._asdict()), velocity, distance, arrives)
    return int(speed), bool(arrives[0])


@settings(max_examples=500)
@given(ramps, velocities, distances)
@example(Ramp(0, 0, 0, 1, FASTEST, 1, 0, 0), FASTEST, FARTHEST)
@example(Ramp(0, 1, FASTEST, 1, FASTEST, 1, 1, 0), FASTEST, -FARTHEST)
def test_a_tick_of_a_move_is_the_same(c: Any, r: Ramp, velocity: int, distance: int) -> None:
    assert advance_in_c(c, r, velocity, distance) == ramp.advance(r, velocity, distance)


@given(ramps, velocities, distances)
def test_moves_are_the_same(c: Any, r: Ramp, velocity: int, distance: int) -> None:
    """A hundred ticks, most of them at speeds that single ticks hardly ever meet."""
    for _ in range(100):
        expected, arrives = ramp.advance(r, velocity, distance)
        assert advance_in_c(c, r, velocity, distance) == (expected, arrives)
        distance = 0 if arrives else distance - expected
        velocity = expected


@settings(max_examples=300)
@given(velocities, velocities, slopes, speeds, speeds)
def test_turning_is_the_same(c: Any, velocity: int, target: int, slope: int, v_start: int, v_stop: int) -> None:
    assert c.ods_ramp_turn(velocity, target, slope, v_start, v_stop) == ramp.turn(
        velocity, target, slope, v_start, v_stop
    )


@given(velocities, slopes)
def test_slowing_down_is_the_same(c: Any, velocity: int, deceleration: int) -> None:
    assert c.ods_ramp_slow_down(velocity, deceleration) == ramp.slow_down(velocity, deceleration)
