"""The simulator and its clock, driven by a clock that a test holds."""

from __future__ import annotations

from types import ModuleType

import pytest
from tests.unit.runtime_py.io.conftest import read, write

from odsmith_runtime.device import Frame
from odsmith_runtime.io import Simulator, VirtualDevice
from odsmith_runtime.io.clock import RealClock
from odsmith_runtime.io.simulator import LONGEST_LAG_US, LONGEST_STRIDE_US


class HeldClock:
    """Time stands still until a test moves it."""

    def __init__(self) -> None:
        self.time = 0

    def now(self) -> int:
        return self.time

    def wait_seconds(self, microseconds: int) -> float:
        return 1000.0  # nobody but the test wakes the thread

    def set_back(self, now: int) -> None:
        self.time = now


class Sink:
    """A link that keeps what it is given, or breaks."""

    def __init__(self) -> None:
        self.frames: list[tuple[int, Frame, bool]] = []
        self.started = self.closed = 0
        self.is_broken = False

    def start(self) -> None:
        self.started += 1

    def send(self, time: int, frame: Frame, *, from_device: bool) -> None:
        if self.is_broken:
            raise OSError("broken")
        self.frames.append((time, frame, from_device))

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def clock() -> HeldClock:
    return HeldClock()


@pytest.fixture
def simulator(clock: HeldClock) -> Simulator:
    return Simulator(clock=clock)


def test_frames_reach_the_other_links(simulator: Simulator, package: ModuleType) -> None:
    one, two = Sink(), Sink()
    simulator.connect(one)
    VirtualDevice(package, engine="python", simulator=simulator)
    simulator.connect(two)
    simulator.receive(read(0x1000), one)
    answer = Frame(0x581, bytes.fromhex("430010009201fcff"))
    assert one.frames == [(0, Frame(0x701, b"\0"), True), (0, answer, True)]
    assert two.frames == [(0, read(0x1000), False), (0, answer, True)]


def test_a_frame_finds_the_wire_up_to_date(simulator: Simulator, clock: HeldClock, package: ModuleType) -> None:
    sink = Sink()
    VirtualDevice(package, engine="python", simulator=simulator)
    simulator.connect(sink)
    with simulator:
        simulator.receive(write(0x1017, 5, 2), sink)
        clock.time = 12_000
        simulator.receive(read(0x1000), sink)
        times = [(time, frame.id) for time, frame, _ in sink.frames]
        assert times == [(0, 0x581), (5000, 0x701), (10_000, 0x701), (12_000, 0x581)]


def test_what_is_too_slow_gives_up_time(simulator: Simulator, clock: HeldClock, package: ModuleType) -> None:
    sink = Sink()
    VirtualDevice(package, engine="python", simulator=simulator)
    with simulator:
        simulator.receive(write(0x1017, 5, 2), sink)
        clock.time = 1000 + LONGEST_LAG_US + 1  # the first tick is long due
        simulator.receive(read(0x1000), sink)
        assert simulator.wire.now == clock.time == 1000 + LONGEST_STRIDE_US
        assert simulator.given_up_us == LONGEST_LAG_US + 1 - LONGEST_STRIDE_US


def test_what_sleeps_is_not_slow(simulator: Simulator, clock: HeldClock) -> None:
    with simulator:
        clock.time = 10 * LONGEST_LAG_US
        simulator.receive(read(0x1000), Sink())
        assert (simulator.wire.now, simulator.given_up_us) == (clock.time, 0)


def test_a_broken_link_is_given_up(simulator: Simulator, package: ModuleType) -> None:
    sink, said = Sink(), list[str]()
    simulator.log = said.append
    simulator.connect(sink)
    sink.is_broken = True
    VirtualDevice(package, engine="python", simulator=simulator)
    sink.is_broken = False
    simulator.receive(read(0x1000), Sink())
    assert sink.frames == []
    assert said == ["a link broke and is given up: broken"]
    simulator.stop()
    assert sink.closed == 1
    assert str(simulator.link_error) == "broken"


def test_a_link_may_break_when_it_is_closed(simulator: Simulator, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise OSError("no space left")

    sink, other, said = Sink(), Sink(), list[str]()
    monkeypatch.setattr(sink, "close", fail)
    simulator.log = said.append
    simulator.connect(sink)
    simulator.connect(other)
    simulator.stop()
    assert said == ["a link broke and is given up: no space left"]
    assert (str(simulator.link_error), other.closed) == ("no space left", 1)


def test_links_live_as_long_as_it(simulator: Simulator) -> None:
    early, late = Sink(), Sink()
    simulator.connect(early)
    assert not early.started
    with simulator:
        simulator.start()
        simulator.connect(late)
        assert (early.started, late.started) == (1, 1)
        simulator.disconnect(late)
        assert late.closed == 1
    assert (early.closed, late.closed) == (1, 1)


@pytest.mark.parametrize("speed", [0, -1, float("inf"), float("nan")])
def test_there_is_no_such_speed(speed: float) -> None:
    with pytest.raises(ValueError, match="speed"):
        Simulator(speed=speed)


def test_the_clock_runs_at_its_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("time.monotonic_ns", lambda: 1_000_000_000)
    clock = RealClock(10)
    assert clock.now() == 0
    monkeypatch.setattr("time.monotonic_ns", lambda: 1_002_000_000)
    assert clock.now() == 20_000
    assert clock.wait_seconds(1_000_000) == 0.1
    clock.set_back(5)
    assert clock.now() == 5
