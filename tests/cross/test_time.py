"""Time passes as it likes: `T n` does what its parts do in a row, in either language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.cross import events
from tests.cross.clocks import PLAIN, WRAPPING
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.testee import Bench

from odsmith.model import Device

pytestmark = pytest.mark.slow

Answer = Callable[[str], list[str]]

SMALL = 1 << 16
"""Microseconds; parts of about this size are no rarity in long steps."""


def joined(answer: Answer, parts: Sequence[int]) -> list[str]:
    """What a testee says to all parts, told as if they were one."""
    told: list[str] = []
    last = passed = at = 0
    end = ""
    for part in parts:
        at = passed
        *lines, end = answer(f"T {part}")
        for line in lines:
            if line.startswith("AT "):
                at = passed + int(line.removeprefix("AT "))
            else:
                told += [f"AT {at}", line] if at != last else [line]
                last = at
        passed += part
    return [*told, end]


@st.composite
def cuttings(draw: st.DrawFn, whole: int) -> list[int]:
    """Parts whose sum is `whole`: at any instants, near the beginning, or at ticks."""
    choices = [st.integers(0, whole), st.integers(0, min(whole, SMALL))]
    if whole >= 1000:
        choices.append(st.integers(0, min(whole // 1000, 200)).map(lambda ticks: ticks * 1000))
    instants = [0, *sorted(draw(st.lists(st.one_of(choices), max_size=6))), whole]
    return [later - earlier for earlier, later in pairwise(instants)]


@pytest.fixture(params=["C", "Python"])
def begin(request: pytest.FixtureRequest, start_c: StartC, start_python: Callable[..., Bench]) -> Callable[..., Answer]:
    """`begin(device, node_id=5)`: how a new testee of the language answers."""
    if request.param == "C":
        return lambda device, **options: start_c(device, **options).answer
    return lambda device, **options: start_python(device, **options).answer


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
@settings(max_examples=30, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_parts_do_what_the_whole_does(
    name: str, data: st.DataObject, begin: Callable[..., Answer], request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(name)
    node_id = data.draw(st.sampled_from([1, 5]), "node-ID")
    time = data.draw(st.sampled_from([PLAIN, WRAPPING]), "clock")
    own = events.events_of(device, node_id)
    happening = st.lists(st.one_of(own.lively, _steps), min_size=5, max_size=30)
    departure, groups = data.draw(own.departure, "departure"), data.draw(happening, "events")
    lines = ["POWER on", *departure, *(line for group in groups for line in group), "DUMP 0000-FFFF"]
    whole, parted = (begin(device, node_id=node_id, time=time) for _ in range(2))
    for line in lines:
        expected = whole(line)
        if line.startswith("T "):
            parts = data.draw(cuttings(int(line.removeprefix("T "))), "parts")
            assert joined(parted, parts) == expected, f"{line} as {parts}"
        else:
            assert parted(line) == expected, line


_steps = st.one_of(st.just(3000), st.integers(0, 20_000), st.integers(0, 1 << 21)).map(lambda step: [f"T {step}"])


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_three_ticks_are_three_times_a_tick(
    name: str, begin: Callable[..., Answer], request: pytest.FixtureRequest
) -> None:
    """With inputs and faults that only ticks see, timers of 1 ms, and a clock that wraps in the midst of it."""
    device: Device = request.getfixturevalue(name)
    lines = [
        "POWER on",
        *events.download(5, 0x1017, 0, b"\x01\x00"),
        "RX 000 01 00",
        "IN digital 255",
        "FAULT axis0 stall on",
        "RX 705 R",
    ]
    whole, parted = (begin(device, node_id=5, time=WRAPPING) for _ in range(2))
    for line in lines:
        assert whole(line) == parted(line)
        for _ in range(3):
            expected = whole("T 3000")
            assert joined(parted, [1000, 1000, 1000]) == expected
    assert sum(line.startswith("TX 705") for line in expected) == 3
    assert expected[-1] == "NEXT 1000"
