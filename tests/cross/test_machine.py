"""A state machine over both devices: hypothesis chooses what happens, and after each line they have told the same.

`make cross-long` runs it for hours; the environment says how much it tries, and where it leaves the figures:

    CROSS_EXAMPLES  dialogues of each device
    CROSS_STEPS     events in one, at most
    CROSS_STRETCH   milliseconds in a stretch of plain traffic, at most; an event among the others
    CROSS_COUNT     a file to which each device adds what it compared (count.py)
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import TypeVar

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from tests.cross.clocks import CLOCKS
from tests.cross.count import Count
from tests.cross.events import START, TIME_OUT, Events, Lines, events_of
from tests.cross.library import CBench, StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.stretch import Stretch
from tests.cross.testee import Bench

from odsmith.model import Device

pytestmark = pytest.mark.slow

EXAMPLES = int(os.environ.get("CROSS_EXAMPLES", "25"))
STEPS = int(os.environ.get("CROSS_STEPS", "40"))
STRETCH = int(os.environ.get("CROSS_STRETCH", "40"))
COUNT = os.environ.get("CROSS_COUNT", "")

T = TypeVar("T")

DUMPED = 24
"""Objects that are looked at after each event."""


def drawn(choose: Callable[[Events], st.SearchStrategy[T]]) -> st.SearchStrategy[T]:
    """What may happen to the device of the machine, under the node-ID that it has by then."""
    return st.runner().flatmap(lambda twins: choose(events_of(twins.device, twins.node_id)))


def beginnings() -> st.SearchStrategy[tuple[int, Lines]]:
    """A configured node-ID, 0 being that of the specification, and lines with which an axis sets out, or none."""
    return st.runner().flatmap(
        lambda twins: st.sampled_from([0, 1, 5, 127]).flatmap(
            lambda node_id: st.tuples(st.just(node_id), events_of(twins.device, node_id or 1).departure)
        )
    )


class Twins(RuleBasedStateMachine):
    """One device in C and in Python; subclasses name it."""

    device: Device
    count: Count
    start_c: StartC
    start_python: Callable[..., Bench]

    def __init__(self) -> None:
        super().__init__()
        self.node_id = 1
        self.told: list[str] = []
        self.next = "-"
        self.agree = True
        self.indices = [obj.index for obj in self.device.expanded]

    @initialize(
        beginning=beginnings(),
        serial=st.sampled_from([0, 0xFFFFFFFF]),
        time=st.sampled_from(CLOCKS),
        seed=st.integers(0, 0xFFFF),
        start=st.booleans(),
    )
    def begin(self, beginning: tuple[int, Lines], serial: int, time: int, seed: int, start: bool) -> None:
        node_id, lines = beginning
        options = {"node_id": node_id, "serial": serial, "time": time}
        self.c: CBench = type(self).start_c(self.device, **options)
        self.python: Bench = type(self).start_python(self.device, **options)
        self.random = Random(seed)
        self.told.append(f"options: {options}")
        self.power_on(start)
        self.obey(lines)

    def line(self, line: str) -> None:
        """Both obey, and tell the same."""
        self.told.append(f"> {line}")
        for text in (answer := self.compare(line)):
            if text.startswith("BUS "):
                self.node_id = int(text.split(" ")[2])
        self.next = "-" if answer[-1].startswith("NACK") else answer[-1].removeprefix("NEXT ")

    def obey(self, lines: Lines) -> None:
        for line in lines:
            self.line(line)

    @property
    def powered(self) -> bool:
        return self.python.power == "on"

    # ---- rules -------------------------------------------------------------------------------------------------------

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.frame))
    def frame(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.sdo_frame))
    def sdo_frame(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: st.one_of(events.read, events.write)))
    def transfer(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.disturbed))
    def disturbed(self, lines: Lines) -> None:
        """A transfer, or several, with something wrong."""
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(groups=drawn(lambda events: st.lists(events.pdo, min_size=1, max_size=3)))
    def configure_pdos(self, groups: list[Lines]) -> None:
        for lines in groups:
            self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.nmt))
    def nmt(self, lines: Lines) -> None:
        self.obey(lines)

    @rule(lines=drawn(lambda events: events.time))
    def time(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.next not in ("-", "0"))
    @rule(beside=st.integers(-1, 1))
    def until_next(self, beside: int) -> None:
        """To the instant at which the device has something to do, or beside it."""
        self.line(f"T {min(int(self.next) + beside, 2 * TIME_OUT)}")

    @rule(lines=drawn(lambda events: events.bench))
    def bench(self, lines: Lines) -> None:
        """Inputs, hardware, faults, events of the CAN controller, memory that fails, answers to OS commands."""
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.store))
    def store(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.traffic))
    def traffic(self, lines: Lines) -> None:
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.motion))
    def motion(self, lines: Lines) -> None:
        """An axis sets out, and things happen to it on its way."""
        self.obey(lines)

    @precondition(lambda self: self.powered)
    @rule(lines=drawn(lambda events: events.command))
    def command(self, lines: Lines) -> None:
        """Controlwords, set-points, switches, faults, whatever an axis does."""
        self.obey(lines)

    @precondition(lambda self: self.next not in ("-", "0") and int(self.next) <= 1000)
    @rule(ms=st.integers(1, 500))
    def go_on(self, ms: int) -> None:
        """Ticks; most likely an axis moves."""
        self.line(f"T {ms * 1000}")

    @precondition(lambda self: self.powered)
    @rule(ms=st.integers(1, STRETCH), seed=st.integers(0, 0xFFFFFFFF))
    def stretch(self, ms: int, seed: int) -> None:
        """Plain traffic, which is not drawn by hypothesis: many frames in little time."""
        traffic = Stretch(self.device, self.node_id, Random(seed))
        for line in traffic.begin():
            self.line(line)
        for _ in range(ms):
            for line in traffic.step():
                self.line(line)

    @precondition(lambda self: self.powered)
    @rule(cut=drawn(lambda events: events.cut), lines=drawn(lambda events: events.store), now=st.booleans())
    def lose_power(self, cut: Lines, lines: Lines, now: bool) -> None:
        """At the k-th octet that is written; what happens after that happens to nobody."""
        self.obey([*cut, *lines, *(["POWER cut"] if now else [])])

    @precondition(lambda self: not self.powered)
    @rule(start=st.booleans())
    def power_again(self, start: bool) -> None:
        self.power_on(start)

    def power_on(self, start: bool) -> None:
        self.obey(["POWER on", *([START] if start else [])])

    @precondition(lambda self: not self.powered)
    @rule(address=st.integers(0, 0x1000), octets=st.binary(min_size=1, max_size=4))
    def damage(self, address: int, octets: bytes) -> None:
        """The image while the device is off: somebody else writes to it."""
        self.line(f"NVM set {address % len(self.python.image):X} {octets.hex(' ')}")

    # ---- what holds after each rule ----------------------------------------------------------------------------------

    @invariant()
    def same_entries(self) -> None:
        first = self.random.randrange(len(self.indices))
        last = min(first + DUMPED, len(self.indices)) - 1
        self.look(f"DUMP {self.indices[first]:04X}-{self.indices[last]:04X}")

    @invariant()
    def same_image(self) -> None:
        self.look("NVM")

    def look(self, line: str) -> None:
        """Like `line`, but it is no part of the dialogue if they agree."""
        self.told.append(f"> {line}")
        self.compare(line)
        self.told.pop()

    def compare(self, line: str) -> list[str]:
        self.agree = False
        c, python = self.c.answer(line), self.python.answer(line)
        assert c == python, "\n".join([*self.told, *_differing(c, python)])
        self.agree = True
        self.count.add(line, c)
        return c

    def teardown(self) -> None:
        if self.agree and self.told:
            self.look("DUMP 0000-FFFF")


def _differing(c: list[str], python: list[str]) -> list[str]:
    """Short answers, or what differs in long ones of equal length."""
    if len(c) != len(python) or len(c) < 10:
        return ["--- C", *c, "--- Python", *python]
    pairs = [(mine, other) for mine, other in zip(c, python, strict=True) if mine != other]
    return [line for mine, other in pairs for line in (f"C      {mine}", f"Python {other}")]


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212", "io_module", "toy", "every_type"])
def test_twins(name: str, start_c: StartC, start_python: Callable[..., Bench], request: pytest.FixtureRequest) -> None:
    class Twin(Twins):
        device = request.getfixturevalue(name)
        count = Count()

    Twin.start_c = staticmethod(start_c)
    Twin.start_python = staticmethod(start_python)
    try:
        run_state_machine_as_test(
            Twin,
            settings=settings(
                max_examples=EXAMPLES,
                stateful_step_count=STEPS,
                suppress_health_check=list(HealthCheck),
                print_blob=True,
            ),
        )
    finally:
        if COUNT:
            Twin.count.append_to(Path(COUNT))
