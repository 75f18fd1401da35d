"""Scans of simulated buses, on which waiting takes no time."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import cast

import pytest
from tests.unit.runtime_py.io.conftest import write

from odsmith_runtime.device import Frame
from odsmith_runtime.io import Simulator, VirtualDevice
from odsmith_runtime.io.scan import scan
from odsmith_runtime.io.transport import SimulatedTransport


def changed(package: ModuleType, **parts: object) -> ModuleType:
    """A package with other parts."""
    names = ("IDENTITY", "DICTIONARY", "NMT_STATES", "ABORT_CODES", "UNITS")
    return cast(ModuleType, SimpleNamespace(**{name: getattr(package, name) for name in names} | parts))


class Spoiled(SimulatedTransport):
    """A bus on which answers under an address become something else."""

    def __init__(self, device: VirtualDevice, address: bytes, answer: bytes | None) -> None:
        super().__init__(device)
        self._address, self._answer = address, answer

    def receive(self, timeout: float) -> Frame | None:
        frame = super().receive(timeout)
        if frame is None or frame.data[1:4] != self._address:
            return frame
        return None if self._answer is None else Frame(frame.id, self._answer)


def test_all_nodes_are_found(package: ModuleType, other_package: ModuleType) -> None:
    simulator = Simulator()
    device = VirtualDevice(package, 5, engine="python", simulator=simulator)
    VirtualDevice(other_package, 127, engine="python", simulator=simulator)
    found = scan(SimulatedTransport(device), [other_package, package])
    assert (found[0].name, found[0].serial_number, found[0].revision_number) == ("TMCM-6212", 5, 0x30018)
    assert [(node.node_id, node.model) for node in found] == [(5, "TMCM-6212"), (127, "TMCM-3230")]
    assert not any(node.differences for node in found)


def test_only_some_nodes_are_asked(device: VirtualDevice, package: ModuleType) -> None:
    assert scan(SimulatedTransport(device), [package], nodes=range(2, 128), listen_s=0.1) == []


def test_a_node_that_is_stopped_is_heard(device: VirtualDevice, package: ModuleType) -> None:
    device.exchange(write(0x1017, 500, 2), Frame(0, b"\x02\x01"))
    (node,) = scan(SimulatedTransport(device), [package], nodes=range(1, 3))
    assert (node.node_id, node.state, node.model) == (1, "Stopped", "")
    assert node.differences == ["it sends heartbeats, and answers no SDO request"]


def test_a_deep_scan_compares_everything(device: VirtualDevice, package: ModuleType) -> None:
    (node,) = scan(SimulatedTransport(device), [package], nodes=[1], deep=True)
    assert node.differences == []
    assert node.compared == sum(entry.readable for item in package.DICTIONARY.values() for entry in item)


@pytest.mark.parametrize(
    ("address", "answer", "difference"),
    [
        ("646000", "8064600000000206", "position_actual_value of axis 0 (6064h) is missing"),
        ("646000", "8064600000000008", "position_actual_value of axis 0 (6064h): General error"),
        ("646000", None, "position_actual_value of axis 0 (6064h) does not answer"),
        ("646000", "4B64600000000000", "position_actual_value of axis 0 (6064h) has 2 octets, in the model 4"),
        ("026500", "4302650001000000", "supported_drive_modes of axis 0 (6502h) is"),
        ("181003", "4318100301000000", "the revision number is 00000001h, the model's 00030018h"),
        ("001000", "4300100001000000", "device_type (1000h) is 1, in the model"),
    ],
)
def test_differences(
    device: VirtualDevice, package: ModuleType, address: str, answer: str | None, difference: str
) -> None:
    transport = Spoiled(device, bytes.fromhex(address), bytes.fromhex(answer) if answer else None)
    (node,) = scan(transport, [package], nodes=[1], deep=True, answer_s=0.05)
    assert [item for item in node.differences if item.startswith(difference)]
    assert len(node.differences) <= 3


def test_an_unknown_device_has_no_model(device: VirtualDevice, other_package: ModuleType) -> None:
    (node,) = scan(SimulatedTransport(device), [other_package], nodes=[1])
    assert (node.name, node.model, node.differences) == ("TMCM-6212", "", [])


def test_of_two_models_the_nearer_one_is_chosen(device: VirtualDevice, package: ModuleType) -> None:
    older = SimpleNamespace(**vars(package.IDENTITY) | {"revision_number": 1, "name": "older"})
    (node,) = scan(SimulatedTransport(device), [changed(package, IDENTITY=older), package], nodes=[1])
    assert node.model == "TMCM-6212"
