"""A log once more: a virtual device does the same again, and what differs is found."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from tests.unit.runtime_py.io.conftest import Make, read, write

from odsmith_runtime.device import Frame
from odsmith_runtime.io.log import Logged, format_frame, read_log
from odsmith_runtime.io.replay import compare, is_of_device, of_masters


@pytest.fixture
def logged(make: Make, tmp_path: Path) -> list[Logged]:
    """A short story: heartbeats, a move, and its end."""
    path = tmp_path / "run.log"
    device = make(record=path)
    device.run(0.5)
    device.exchange(Frame(0, b"\x01\0"), write(0x1017, 20, 2), write(0x6060, 3, 1), write(0x2005, 3, 4))
    device.exchange(write(0x6083, 100_000, 4), write(0x60FF, 5000, 4))
    for word in (6, 7, 15):
        device.run(0.0103)
        device.exchange(write(0x6040, word, 2))
    device.run(0.1)
    device.exchange(write(0x60FF, 0, 4))
    device.run(0.2)
    device.exchange(read(0x6064))
    device.simulator.stop()
    return list(read_log(path.read_text().splitlines()))


def test_the_same_again(package: ModuleType, logged: list[Logged]) -> None:
    assert compare(package, logged, [1], engine="python") == (sum(item.way == "T" for item in logged), None)


def test_logs_without_marks(package: ModuleType, logged: list[Logged]) -> None:
    bare = [item._replace(way="") for item in logged]
    assert of_masters(bare) == [item._replace(way="") for item in of_masters(logged)]
    assert compare(package, bare, [1], engine="python")[1] is None


def test_a_difference_is_found(package: ModuleType, logged: list[Logged]) -> None:
    place = next(n for n, item in enumerate(logged) if item.frame.id == 0x181)
    other = logged[place]._replace(frame=Frame(0x181, b"\1\2"))
    same, difference = compare(package, [*logged[:place], other, *logged[place + 1 :]], [1], engine="python")
    assert same == sum(item.way == "T" for item in logged[:place])
    assert difference is not None
    assert (difference.logged, difference.sent) == ("181#0102", format_frame(logged[place].frame))


def test_missing_frames_are_found(package: ModuleType, logged: list[Logged]) -> None:
    device_frames = [item for item in logged if item.way == "T"]
    shorter = [item for item in logged if item is not device_frames[-1]]
    _, difference = compare(package, shorter, [1], engine="python")
    assert difference is not None
    assert (difference.logged, difference.sent) == ("", format_frame(device_frames[-1].frame))
    longer = [*logged, logged[-1]._replace(frame=Frame(0x701, b"\x05"))]
    _, difference = compare(package, longer, [1], engine="python")
    assert difference is not None
    assert (difference.logged, difference.sent) == ("701#05", "")


@pytest.mark.parametrize(
    ("identifier", "expected"),
    [
        *((0x000, False), (0x080, False), (0x081, True), (0x100, False), (0x181, True), (0x201, False)),
        *((0x281, True), (0x301, False), (0x4FF, True), (0x501, False), (0x581, True), (0x601, False), (0x701, True)),
    ],
)
def test_who_sends_what_as_delivered(identifier: int, expected: bool) -> None:
    assert is_of_device(Frame(identifier, b"\0")) is expected
    assert not is_of_device(Frame(identifier, remote=True, length=1))
