"""Homing, method by method: which ways the axis goes, how fast, and where it stands in the end.

The judge knows the methods from the model of the device, which is the YAML, and has two sentences of the contract: the
switch is searched fast, its edge is passed slowly in the direction of `edge`; and the search goes in `direction` until
the switch that `reverse_at` names turns it round. It sees what a master sees: the velocity of each tick.

Switches are at 20 positions, with hysteresis. Those that are active when their line is high are the simulated
hardware's; with the other polarity this module presses and releases them as the axis moves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, groupby, pairwise
from typing import Protocol

import pytest
from tests.cross.events import download
from tests.cross.expected import encode, entries
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.testee import Bench

from odsmith.model import Device, ExpandedEntry, HomingMethod

NODE_ID = 5
TPDO = f"TX {0x480 + NODE_ID:03X} "  # statusword and velocity of axis 0

FAST, SLOW, SLOPE = 3000, 1300, 500  # pps, pps, pps in a tick
PATIENCE = 190  # ticks; the longest homing takes about 150

FOUND = 0x1400  # bits 10 and 12 of the statusword

REVOLUTION, INCREMENTS = 32, 8  # microsteps and counts of the encoder
INDEX_WIDTH = REVOLUTION // INCREMENTS  # microsteps

LINES = {"negative_limit": "left", "positive_limit": "right", "home": "home"}
IGNORED = {"left": 0x01, "right": 0x02, "home": 0x10}  # bits of 2005h
INVERTED = {"left": 0x04, "right": 0x08, "home": 0x20}

FAR = 1_000_000

AHEAD, ON, BEHIND = "ahead", "on the switch", "behind"

# Where an axis can begin: with its switch ahead, on it, and with the switch behind it where the search can turn round.
CASES = (
    *(("tmcm3230", number, side) for number in (17, 18) for side in (AHEAD, ON)),
    *(("tmcm3230", number, side) for number in (19, 21) for side in (AHEAD, ON, BEHIND)),
    *(("tmcm6212", number, side) for number in (1, 2) for side in (AHEAD, ON)),
    *(("tmcm6212", number, side) for number in (3, 5) for side in (AHEAD, ON, BEHIND)),
    *(("tmcm6212", number, AHEAD) for number in (33, 34)),
)

each_case = pytest.mark.parametrize(("name", "number", "side"), CASES)


class Answering(Protocol):
    """What all testees are."""

    def answer(self, line: str) -> list[str]: ...


# ---- the place -------------------------------------------------------------------------------------------------------


@dataclass
class Switch:
    """Active from `low` to `high`; once active, until the shaft is farther away than `hysteresis`."""

    line: str
    low: int
    high: int
    hysteresis: int
    is_active: bool = False

    def look(self, shaft: int) -> bool:
        outside = max(self.low - shaft, shaft - self.high)
        self.is_active = outside <= (self.hysteresis if self.is_active else 0)
        return self.is_active

    def inputs(self) -> Iterator[str]:
        """It as one of the simulated hardware."""
        if self.line == "home":
            yield f"IN axis0.home_from {self.low}"
            yield f"IN axis0.home_to {self.high}"
        else:
            yield f"IN axis0.{self.line}_at {self.high if self.line == 'left' else self.low}"


@dataclass
class Place:
    """Where the switches of a method are, that of the method first; the axis begins at `shaft`."""

    method: HomingMethod
    side: str
    position: int  # 0 to 19
    switches: list[Switch] = field(default_factory=list)
    shaft: int = 0

    def __post_init__(self) -> None:
        if self.method.switch == "none":
            self.shaft = self.method.edge * self.position
            return
        self._add(LINES[self.method.switch], *self._begin())
        if self.side == BEHIND:
            self._add(LINES[self.method.reverse_at], self.method.direction * 15, self.method.direction)

    def _begin(self) -> tuple[int, int]:
        """Where the switch of the method begins, and in which direction it goes on."""
        method = self.method
        if self.side == ON:
            return method.edge * (5 + self.position), -method.edge
        way = method.direction if self.side == AHEAD else -method.direction
        return way * (20 + self.position), way

    def _add(self, line: str, begin: int, way: int) -> None:
        """A limit switch goes on to the end of the axis."""
        end = begin + way * (30 + self.position if line == "home" else FAR)
        self.switches.append(Switch(line, min(begin, end), max(begin, end), hysteresis=self.position % 6))

    def legs(self) -> list[tuple[int, tuple[int, ...]]]:
        """The directions that the axis takes one after the other, and the speeds that it keeps in them."""
        method = self.method
        if method.switch == "none" or self.side == ON:
            return [(method.edge, (SLOW,))]
        ways = [method.direction] if self.side == AHEAD else [method.direction, -method.direction]
        if ways[-1] == method.edge:  # the search leads over the edge
            return [*((way, (FAST,)) for way in ways[:-1]), (method.edge, (FAST, SLOW))]
        return [*((way, (FAST,)) for way in ways), (method.edge, (SLOW,))]


def is_index(shaft: int) -> bool:
    return shaft % REVOLUTION < INDEX_WIDTH


# ---- a run -----------------------------------------------------------------------------------------------------------


@dataclass
class Run:
    """What was told: a velocity in pps for each tick, and what a dump says at the end."""

    velocities: list[int]
    objects: dict[str, bytes]
    answers: list[list[str]]


class Master:
    """Has a testee home, and records it."""

    def __init__(self, testee: Answering, device: Device) -> None:
        self.testee = testee
        self.roles: dict[str, ExpandedEntry] = {}
        for item in entries(device):
            self.roles.setdefault(item.entry.role, item)
        self.answers: list[list[str]] = []
        self.velocities: list[int] = []
        self.way = 0  # in 1/1000 microstep
        self.statusword = 0

    def say(self, lines: Sequence[str]) -> None:
        for line in lines:
            self.answers.append(self.testee.answer(line))
            assert "NACK" not in self.answers[-1][-1], line

    def write(self, role: str, value: int) -> None:
        item = self.roles[role]
        self.say(download(NODE_ID, item.index, item.entry.sub, encode(item.entry, value)))
        assert self.answers[-1][0].startswith(f"TX {0x580 + NODE_ID:03X} 60"), role

    def advance(self, ticks: int) -> None:
        """Note the velocity of each tick; what is told is what has changed."""
        self.say([f"T {1000 * ticks}"])
        told: dict[int, str] = {}
        tick = 0
        for line in self.answers[-1]:
            if line.startswith("AT "):
                tick = int(line[3:]) // 1000
            elif line.startswith(TPDO):
                told[tick] = line.removeprefix(TPDO)
        for tick in range(1, ticks + 1):
            velocity = self.velocities[-1] if self.velocities else 0
            if tick in told:
                octets = bytes.fromhex(told[tick])
                self.statusword = int.from_bytes(octets[:2], "little")
                velocity = int.from_bytes(octets[2:], "little", signed=True)
            self.velocities.append(velocity)
            self.way += velocity

    @property
    def is_done(self) -> bool:
        return self.statusword & 0x0400 != 0

    def home(self, place: Place, offset: int, *, by_hand: bool) -> Run:
        """`by_hand`: the switches are active when their lines are low."""
        used = {switch.line for switch in place.switches}
        parameters = sum(bit for line, bit in IGNORED.items() if line not in used)
        if by_hand:
            parameters += sum(INVERTED[line] for line in used)
        self.say(["POWER on"])
        self.write("switch_parameters", parameters)
        if place.method.index_pulse:
            self._connect_encoder()
        self.write("standby_current", 128)
        self.write("homing_method", place.method.method)
        self.write("homing_speeds_fast", FAST)
        self.write("homing_speeds_slow", SLOW)
        self.write("homing_acceleration", SLOPE * 1000)
        self.write("home_offset", offset)
        self.write("modes_of_operation", 6)
        self.say([f"IN axis0.shaft {place.shaft}", f"RX 000 01 {NODE_ID:02X}"])
        if by_hand:
            self._press(place, anew=True)
        else:
            self._build(place)
        self.write("controlword", 0x06)
        self.write("controlword", 0x0F)
        self.say(["T 2000"])
        self.write("controlword", 0x1F)
        if by_hand:
            while not self.is_done and len(self.velocities) < PATIENCE:
                self.advance(1)
                self._press(place)
        else:
            self.advance(PATIENCE)
        self.say(["DUMP 2100-2100", "DUMP 6041-6041", "DUMP 6062-6064"])
        return Run(self.velocities, self._objects(), self.answers)

    def _connect_encoder(self) -> None:
        """A count of it is so many microsteps; the velocity told stays that of the ramp."""
        self.say([f"IN axis0.revolution {REVOLUTION}", f"IN axis0.increments {INCREMENTS}"])
        self.write("microstep_resolution", 0)
        self.write("fullstep_resolution", REVOLUTION)
        self.write("encoder_increments", INCREMENTS)
        self.write("encoder_polarity", 1)
        self.write("sensor_selection_code", 1)

    def _build(self, place: Place) -> None:
        for switch in place.switches:
            self.say([f"IN axis0.hysteresis {switch.hysteresis}", *switch.inputs()])

    def _press(self, place: Place, *, anew: bool = False) -> None:
        """Press and release the switches where the shaft is now."""
        shaft = place.shaft + whole(self.way)
        for switch in place.switches:
            before = switch.is_active
            if switch.look(shaft) != before or anew:
                self.say([f"IN axis0.{switch.line} {int(not switch.is_active)}"])

    def _objects(self) -> dict[str, bytes]:
        lines = [line.split() for answer in self.answers[-3:] for line in answer if line.startswith("OD ")]
        return {address: bytes.fromhex("".join(octets)) for _, address, *octets in lines}


def whole(way: int) -> int:
    """Microsteps of a way in 1/1000 of them: no axis makes a part of one."""
    return way // 1000 if way >= 0 else -(-way // 1000)


# ---- the judge -------------------------------------------------------------------------------------------------------


def judge(place: Place, run: Run, offset: int) -> None:
    velocities = run.velocities[: max((n for n, velocity in enumerate(run.velocities) if velocity), default=0) + 1]
    assert [(way, kept(speeds)) for way, speeds in legs(velocities)] == place.legs()
    assert all(abs(after - before) <= SLOPE for before, after in pairwise([0, *velocities]))
    assert velocities[-1] == place.method.edge * SLOW
    assert not any(run.velocities[len(velocities) :])
    judge_end(place, [place.shaft + whole(way) for way in accumulate(velocities, initial=0)])
    position = (-offset).to_bytes(4, "little", signed=True)
    assert run.objects["6062:00"] == run.objects["6063:00"] == run.objects["6064:00"] == position
    assert run.objects["2100:00"] == offset.to_bytes(4, "little", signed=True)
    assert int.from_bytes(run.objects["6041:00"], "little") & FOUND == FOUND


def legs(velocities: Sequence[int]) -> Iterator[tuple[int, list[int]]]:
    """The ways from one standstill to the next."""
    for way, leg in groupby(velocities, key=lambda velocity: (velocity > 0) - (velocity < 0)):
        if way:
            yield way, [abs(velocity) for velocity in leg]


def kept(speeds: Sequence[int]) -> tuple[int, ...]:
    """The speeds of more than one tick."""
    return tuple(speed for speed, ticks in groupby(speeds) if len(list(ticks)) > 1)


def judge_end(place: Place, at: Sequence[int]) -> None:
    """The last tick, a slow one, has released the switch, or has brought the first index pulse behind its edge.

    `at` is where the shaft was before the first tick and after each.
    """
    edge = 0
    if place.switches:
        switch = place.switches[0]
        switch.is_active = False
        active = [switch.look(shaft) for shaft in at]
        edge = max(n for n in range(1, len(at)) if active[n - 1] and not active[n])
    if place.method.index_pulse:
        begins = [n for n in range(edge + 1, len(at)) if is_index(at[n]) and not is_index(at[n - 1])]
        assert begins == [len(at) - 1]
    else:
        assert edge == len(at) - 1


# ---- tests -----------------------------------------------------------------------------------------------------------


def homed(testee: Answering, device: Device, number: int, side: str, position: int, *, by_hand: bool) -> Run:
    """A homing that the judge has nothing against."""
    method = next(each for each in device.homing_methods if each.method == number)
    offset = 10 * position - 100
    place = Place(method, side, position)
    run = Master(testee, device).home(place, offset, by_hand=by_hand)
    judge(place, run, offset)
    return run


@each_case
def test_python(
    name: str, number: int, side: str, start_python: Callable[..., Bench], request: pytest.FixtureRequest
) -> None:
    """One position, with either polarity."""
    device: Device = request.getfixturevalue(name)
    for by_hand in (False, True):
        homed(start_python(device, node_id=NODE_ID), device, number, side, number % 20, by_hand=by_hand)


@pytest.mark.slow
@each_case
def test_both(
    name: str,
    number: int,
    side: str,
    start_python: Callable[..., Bench],
    start_c: StartC,
    request: pytest.FixtureRequest,
) -> None:
    """C at each position, with either polarity; Python takes turns with them, and says the same."""
    device: Device = request.getfixturevalue(name)
    for position in range(20):
        runs = [
            homed(start_c(device, node_id=NODE_ID), device, number, side, position, by_hand=by_hand)
            for by_hand in (False, True)
        ]
        by_hand = position % 2 == 1
        python = homed(start_python(device, node_id=NODE_ID), device, number, side, position, by_hand=by_hand)
        assert python.answers == runs[by_hand].answers
        assert runs[0].velocities[: len(runs[1].velocities)] == runs[1].velocities


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_all_methods_are_tried(name: str, request: pytest.FixtureRequest) -> None:
    """Those that move the axis; and each with a switch from all sides that there are."""
    device: Device = request.getfixturevalue(name)
    tried = {number for _, number, _ in CASES}
    assert {each.method for each in device.homing_methods if each.needs_power} <= tried
    for each in device.homing_methods:
        sides = {side for _, number, side in CASES if number == each.method}
        if each.switch != "none":
            assert sides == ({AHEAD, ON, BEHIND} if each.reverse_at != "none" else {AHEAD, ON})
