"""A virtual device as a program has it."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from tests.unit.runtime_py.io.conftest import Make, number, read, write

from odsmith_runtime.device import Frame
from odsmith_runtime.io import Simulator, StateError, VirtualDevice
from odsmith_runtime.io.log import read_log
from odsmith_runtime.io.watch import Watcher

SAVE = write(0x1010, 0x65766173, 4, sub=1)


def test_it_answers_in_the_same_instant(make: Make) -> None:
    device = make(9)
    assert device.exchange(read(0x1000, node=9)) == [Frame(0x589, bytes.fromhex("430010009201fcff"))]
    assert device.exchange(read(0x1000, node=8)) == []


def test_it_keeps_what_is_stored(make: Make, tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    device = make(state=path)
    device.exchange(write(0x1017, 77, 2))
    assert not path.exists()
    device.exchange(SAVE)
    assert number(make(state=path), 0x1017) == 77
    assert number(make(2, state=path), 0x1017) == 0
    assert device.save_error is None


def test_two_devices_share_a_file(package: ModuleType, tmp_path: Path) -> None:
    from odsmith_runtime.io.state_file import StateFile

    state, simulator = StateFile(tmp_path / "state.json", "tmcm6212"), Simulator()
    devices = [VirtualDevice(package, node, engine="python", state=state, simulator=simulator) for node in (1, 2)]
    for node, device in enumerate(devices, start=1):
        device.exchange(write(0x1017, 100 * node, 2, node=node), write(0x1010, 0x65766173, 4, sub=1, node=node))
    again = [VirtualDevice(package, node, engine="python", state=tmp_path / "state.json") for node in (1, 2)]
    assert [number(device, 0x1017) for device in again] == [100, 200]


def test_a_state_of_another_size_is_refused(package: ModuleType, tmp_path: Path) -> None:
    from odsmith_runtime.io.state_file import StateFile

    StateFile(tmp_path / "state.json", "tmcm6212").save(1, b"short")
    with pytest.raises(StateError, match="does not fit"):
        VirtualDevice(package, engine="python", state=tmp_path / "state.json")


def test_a_file_that_cannot_be_written_is_told(package: ModuleType, tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    device, said = VirtualDevice(package, engine="python", state=folder / "state.json"), list[str]()
    device.simulator.log = said.append
    folder.rmdir()
    device.exchange(SAVE)
    device.exchange(read(0x1000))
    assert len(said) == 1
    assert device.save_error is not None
    folder.mkdir()
    device.save()
    assert device.save_error is None


def test_a_record_is_a_log(package: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "run.log"
    device = VirtualDevice(package, engine="python", record=path)
    device.run(0.25)
    device.exchange(read(0x1000))
    device.simulator.stop()
    logged = list(read_log(path.read_text().splitlines()))
    assert [(item.frame.id, item.way) for item in logged] == [(0x701, "T"), (0x601, "R"), (0x581, "T")]
    begin, end = logged[0].time, logged[-1].time
    assert begin is not None
    assert end is not None
    assert end - begin == pytest.approx(0.25, abs=1e-5)


def test_a_record_can_be_read_while_it_is_written(package: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "run.log"
    device = VirtualDevice(package, engine="python", record=path)
    device.exchange(read(0x1000))
    assert [item.frame.id for item in read_log(path.read_text().splitlines())] == [0x701, 0x601, 0x581]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_record_that_cannot_be_written_is_told(package: ModuleType) -> None:
    device = VirtualDevice(package, engine="python", record="/dev/full")
    assert isinstance(device.simulator.link_error, OSError)
    assert device.simulator.link_error.filename == "/dev/full"
    assert len(device.exchange(read(0x1000))) == 1  # it goes on
    device.stop()


def test_it_is_seen(device: VirtualDevice) -> None:
    view = device.view()
    assert (view.node_id, view.bit_rate, view.state, view.leds) == (1, 1000, "Pre-operational", "green")
    assert {(axis.state, axis.mode) for axis in view.axes} == {("Switch on disabled", "none")}


def test_it_is_watched(device: VirtualDevice) -> None:
    watcher = Watcher(device)
    assert watcher.changes() == ["node 1: Pre-operational"]
    assert watcher.changes() == []
    device.exchange(Frame(0, b"\x01\0"), write(0x6060, 1, 1))
    device.inject("axis2 overtemperature")
    device.run(0.01)
    assert watcher.changes() == [
        "node 1: Operational",
        "node 1 axis 0: Switch on disabled, mode pp",
        "node 1 axis 2: Fault, mode none",
        "node 1: EMCY 4310h Overtemperature error, axis 2",
    ]
    assert watcher.changes() == []


def test_links_are_closed_where_one_fails(package: ModuleType, tmp_path: Path) -> None:
    """The log is open already when the bus turns out not to be there."""
    from odsmith_runtime.io.can_link import LinkError

    with pytest.raises(LinkError):
        VirtualDevice(package, engine="python", record=tmp_path / "run.log", interface="nonsense")
