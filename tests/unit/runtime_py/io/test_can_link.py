"""Buses of python-can: frames go over as they are, and what cannot be opened says why."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import ModuleType

import can
import pytest
from hypothesis import given
from tests.unit.runtime_py.io.conftest import read
from tests.unit.runtime_py.io.test_log import frames

from odsmith_runtime.device import Frame
from odsmith_runtime.io import VirtualDevice
from odsmith_runtime.io.can_link import BIT_RATES, LinkError, from_message, open_bus, to_message

PATIENCE_S = 20  # only a failing test waits so long


@given(frames)
def test_frames_are_the_same_on_the_other_side(frame: Frame) -> None:
    assert from_message(to_message(frame)) == frame


@pytest.mark.parametrize("message", [can.Message(is_error_frame=True), can.Message(is_fd=True, data=bytes(12))])
def test_what_is_no_frame_of_a_node(message: can.Message) -> None:
    assert from_message(message) is None


@pytest.fixture
def bus() -> Iterator[can.BusABC]:
    with can.Bus(interface="virtual", channel="odsmith test") as bus:
        yield bus


@pytest.mark.slow
def test_a_device_on_a_bus(bus: can.BusABC, package: ModuleType) -> None:
    with VirtualDevice(package, engine="python", interface="virtual", channel="odsmith test"):
        bus.send(to_message(read(0x1000)))
        heard = [bus.recv(PATIENCE_S), bus.recv(PATIENCE_S)]
    assert [message and message.arbitration_id for message in heard] == [0x701, 0x581]


@pytest.mark.slow
def test_a_bus_of_somebody_else_stays_open(bus: can.BusABC, package: ModuleType) -> None:
    with can.Bus(interface="virtual", channel="odsmith test") as own:
        with VirtualDevice(package, engine="python", bus=own):
            pass
        own.send(to_message(read(0x1000)))
        bus.recv(PATIENCE_S)  # the boot-up frame
        assert bus.recv(PATIENCE_S) is not None


def test_frames_that_a_bus_does_not_take_are_lost(package: ModuleType) -> None:
    said: list[str] = []
    own = can.Bus(interface="virtual", channel="odsmith test")
    device = VirtualDevice(package, engine="python", bus=own)
    device.simulator.log = said.append
    own.shutdown()
    for _ in range(3):
        device.exchange(read(0x1000))
    assert len(said) == 1
    assert "frames are lost" in said[0]


def test_bit_rates_are_in_bits_per_second(monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of python-can are."""
    asked: list[object] = []

    def open_nothing(**options: object) -> None:
        asked.append(options.get("bitrate"))

    monkeypatch.setattr(can, "Bus", open_nothing)
    open_bus("pcan", "PCAN_USBBUS1", 500_000)
    open_bus("pcan", "PCAN_USBBUS1")
    assert asked == [500_000, None]
    for wrong in (0, 500, 123_456):
        with pytest.raises(LinkError, match=f"no CANopen bus has {wrong} bit/s") as raised:
            open_bus("pcan", "PCAN_USBBUS1", wrong)
        assert "100000, 125000, 250000, 500000, 800000, 1000000" in raised.value.hint


def test_all_devices_find_their_bit_rates(package: ModuleType, other_package: ModuleType) -> None:
    for device in (package, other_package):
        assert {1000 * rate for rate in device.IDENTITY.bit_rates} <= {*BIT_RATES}


def test_an_unknown_interface() -> None:
    with pytest.raises(LinkError, match="no bus at interface nonsense"):
        open_bus("nonsense", "x")


def test_without_python_can(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "can", None)
    with pytest.raises(LinkError, match="python-can is not installed") as raised:
        open_bus("virtual", "x")
    assert raised.value.hint == "pip install 'odsmith[can]'"
