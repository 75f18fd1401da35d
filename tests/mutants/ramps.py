"""What the ramp generators are asked directly: dialogues would take hours to meet all corners of them.

A line is a function of the generator and its numbers; the answer is what it gives. `move` asks tick after tick.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from random import Random
from typing import Protocol

from tests.unit.runtime_py.device.test_ramp import way_to_stop

from odsmith_runtime.device.ramp import Ramp

DEVICE = "ramps"
"""Stands where a talk names its device."""

TICKS = 60
ROUNDS = 150

RAMP = 8
"""Numbers of a six point ramp."""

ARGUMENTS = {"advance": RAMP + 2, "move": RAMP + 2, "turn": 5, "slow_down": 2}


class Generator(Protocol):
    """The ramp generator of a runtime."""

    def advance(self, ramp: Sequence[int], velocity: int, distance: int) -> tuple[int, bool]: ...
    def turn(self, velocity: int, target: int, acceleration: int, v_start: int, v_stop: int) -> int: ...
    def slow_down(self, velocity: int, deceleration: int) -> int: ...


def lines(sizes: tuple[int, ...]) -> Iterator[str]:
    """Questions whose numbers are as large as one of these sizes, always the same ones."""
    random = Random(1)
    for _ in range(ROUNDS):
        for function, count in ARGUMENTS.items():
            signed = {"turn": (0, 1), "slow_down": (0,)}.get(function, (RAMP, RAMP + 1))
            numbers = [_number(random, sizes, place in signed) for place in range(count)]
            yield " ".join([function, *map(str, numbers)])


def braking(size: int) -> Iterator[str]:
    """Questions of an axis that is about to have to slow down, of numbers up to a size."""
    random = Random(1)
    for _ in range(10 * ROUNDS):
        ramp = [random.randint(0, random.choice((3, size))) for _ in range(RAMP)]
        velocity = random.randint(0, size)
        distance = way_to_stop(Ramp(*ramp), velocity) + random.randint(-2, size)
        yield " ".join(map(str, ["advance", *ramp, velocity, distance]))


def _number(random: Random, sizes: tuple[int, ...], is_signed: bool) -> int:
    number = random.randint(0, random.choice((0, *sizes)))
    return -number if is_signed and random.random() < 0.5 else number


def answer(generator: Generator, line: str) -> tuple[str, ...]:
    function, *words = line.split()
    numbers = [int(word) for word in words]
    ask: dict[str, Callable[[], object]] = {
        "advance": lambda: generator.advance(numbers[:RAMP], *numbers[RAMP:]),
        "move": lambda: _move(generator, numbers[:RAMP], *numbers[RAMP:]),
        "turn": lambda: generator.turn(*numbers),
        "slow_down": lambda: generator.slow_down(*numbers),
    }
    return (str(ask[function]()),)


def _move(generator: Generator, ramp: Sequence[int], velocity: int, distance: int) -> list[tuple[int, bool]]:
    found = []
    for _ in range(TICKS):
        velocity, arrives = generator.advance(ramp, velocity, distance)
        found.append((velocity, arrives))
        distance = 0 if arrives else distance - velocity
    return found
