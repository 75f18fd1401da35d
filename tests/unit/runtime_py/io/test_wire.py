"""The wire: who hears what, when, and what gets lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from tests.unit.runtime_py.io.conftest import read, write

from odsmith_runtime.device import Frame
from odsmith_runtime.io.c_engine import CEngine
from odsmith_runtime.io.engine import Engine, Sent
from odsmith_runtime.io.log import EXTENDED
from odsmith_runtime.io.python_engine import PythonEngine
from odsmith_runtime.io.wire import Station, Wire

Join = Callable[[Wire, int], Station]


class Heard:
    def __init__(self) -> None:
        self.frames: list[tuple[int, Frame, object]] = []

    def __call__(self, time: int, frame: Frame, origin: object) -> None:
        self.frames.append((time, frame, origin))


@pytest.fixture
def heard() -> Heard:
    return Heard()


@pytest.fixture
def wire(heard: Heard) -> Wire:
    return Wire(heard)


@pytest.fixture(
    params=["python", pytest.param("c", marks=pytest.mark.slow), pytest.param("both", marks=pytest.mark.slow)]
)
def join(request: pytest.FixtureRequest, package: ModuleType) -> Join:
    """`join(wire, 1)` connects a device with power. Devices in C are served together, unless there are others."""
    library: Path | None = None if request.param == "python" else request.getfixturevalue("c_library")

    def connect(wire: Wire, node_id: int) -> Station:
        engine: Engine = PythonEngine(package, node_id=node_id)
        if library is not None and (request.param == "c" or node_id % 2):
            engine = CEngine(package, library, node_id=node_id)
        station = wire.attach(engine)
        wire.power_on(station)
        return station

    return connect


def test_a_device_answers_in_the_same_instant(wire: Wire, heard: Heard, join: Join) -> None:
    station = join(wire, 1)
    wire.run(500)
    wire.transmit(read(0x1000), "me")
    answer = Frame(0x581, bytes.fromhex("430010009201fcff"))
    assert heard.frames == [(0, Frame(0x701, b"\0"), station), (500, read(0x1000), "me"), (500, answer, station)]


def test_devices_hear_each_other(wire: Wire, join: Join) -> None:
    """A heartbeat that another device watches: its loss is noticed, so it was heard before."""
    one, two = join(wire, 1), join(wire, 2)
    wire.transmit(write(0x1017, 50, 2, node=2), None)
    wire.transmit(write(0x1016, 2 << 16 | 100, 4, sub=1), None)
    wire.run(300_000)
    assert one.engine.read(0x1001, 0) == b"\0"
    wire.power_off(two)
    wire.run(500_000)
    assert one.engine.read(0x1001, 0) != b"\0"
    wire.power_on(two)
    wire.transmit(write(0x1017, 50, 2, node=2), None)
    wire.run(600_000)
    assert one.engine.read(0x1001, 0) == b"\0"


def test_a_frame_between_devices_takes_its_time(wire: Wire, join: Join) -> None:
    join(wire, 1)
    join(wire, 2)
    assert wire.next() == 55  # a boot-up frame has 55 bits, and a bit lasts 1 us
    wire.run(55)
    assert (wire.next() or 0) > 55


class Echo(PythonEngine):
    """A device that answers every frame with itself, whatever is in it."""

    def receive(self, now: int, frame: Frame) -> None:
        self._sent.append(Sent(now, frame))


def test_devices_that_answer_each_other_do_so_in_time(wire: Wire, heard: Heard, package: ModuleType) -> None:
    """There is no instant without end: a frame of 8 octets lasts 111 us, and two of them chase each other."""
    for node in (1, 2):
        wire.power_on(wire.attach(Echo(package, node_id=node)))
    wire.run(1000)
    heard.frames.clear()
    wire.transmit(Frame(0x123, bytes(8)), None)
    wire.run(wire.now + 1110)
    assert len([frame for _, frame, _ in heard.frames if frame.id == 0x123]) == 1 + 2 * 11


def test_frames_get_lost(wire: Wire, heard: Heard, join: Join) -> None:
    station = join(wire, 1)
    heard.frames.clear()
    wire.lose(station, 3)  # a request; then a request that arrives and its answer
    for _ in range(4):
        wire.transmit(read(0x1000), None)
    answers = [frame for _, frame, origin in heard.frames if origin is station]
    assert (len(answers), station.lose) == (1, 0)


def test_frames_are_late(wire: Wire, heard: Heard, join: Join) -> None:
    station = join(wire, 1)
    station.delay_us = 700
    wire.transmit(read(0x1000), None)
    assert [item for item in heard.frames if item[0] > 0] == []
    wire.run(699)
    assert len([item for item in heard.frames if item[2] is station]) == 1  # the boot-up frame
    wire.run(700)
    assert [(time, frame.id) for time, frame, origin in heard.frames if origin is station] == [(0, 0x701), (700, 0x581)]


def test_what_is_on_its_way_is_lost_with_its_sender(wire: Wire, heard: Heard, join: Join) -> None:
    station = join(wire, 1)
    station.delay_us = 700
    wire.transmit(read(0x1000), None)
    wire.detach(station)
    assert wire.next() is None


def test_long_can_ids_reach_no_device(wire: Wire, heard: Heard, join: Join) -> None:
    join(wire, 1)
    heard.frames.clear()
    wire.transmit(Frame(0x601 | EXTENDED, read(0x1000).data), None)
    assert len(heard.frames) == 1


def test_many_devices_move_in_step(wire: Wire, heard: Heard, join: Join) -> None:
    """SYNC reaches all of them, and their heartbeats come at their instants."""
    for node in (1, 2, 3):
        join(wire, node)
        wire.transmit(write(0x1017, 10 * node, 2, node=node), None)
        wire.transmit(write(0x1800, 1, 1, sub=2, node=node), None)
    wire.transmit(Frame(0, b"\x01\0"), None)
    wire.run(25_000)
    heard.frames.clear()
    wire.transmit(Frame(0x80), None)
    wire.run(60_000)
    assert [(time, frame.id) for time, frame, _ in heard.frames] == [
        *((25_000, identifier) for identifier in (0x080, 0x181, 0x381, 0x182, 0x382, 0x183, 0x383)),
        *((30_000, 0x701), (30_000, 0x703), (40_000, 0x701), (40_000, 0x702), (50_000, 0x701)),
        *((60_000, 0x701), (60_000, 0x702), (60_000, 0x703)),
    ]
