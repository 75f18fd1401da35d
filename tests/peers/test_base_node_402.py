"""The drive profile of python-canopen, as it is, drives axis 0 of our device with our EDS, on a bus of python-can.

It knows no other axes: their controlwords are at other indices.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import canopen
import pytest
from canopen.profiles.p402 import BaseNode402
from tests.unit.runtime_py.client.conftest import c_library, engine, package

from odsmith_runtime.io import VirtualDevice

__all__ = ["c_library", "engine", "package"]

pytestmark = pytest.mark.slow

TPDO_PERIOD_MS = 5
PATIENCE = 60.0  # seconds: a machine may be busy with something else


class Patient(NamedTuple):
    """A node of python-canopen, and the device that it drives."""

    node: Any
    device: VirtualDevice


@pytest.fixture(params=["by_sdo", "by_pdo"])
def patient(request: pytest.FixtureRequest, root: Path, package: ModuleType, engine: str) -> Iterator[Patient]:
    """A node on a bus in real time, with more patience than it has by itself.

    By PDO it takes what it received twice for periodic and waits for the next one, so TPDO 1 and 2 (statusword, mode)
    get an event timer.
    """
    bus: dict[str, Any] = {"interface": "virtual", "channel": request.node.name}
    network = canopen.Network()
    with VirtualDevice(package, 1, engine=engine, **bus) as device:
        network.connect(**bus)
        try:
            node: Any = BaseNode402(1, str(root / "generated/tmcm6212/eds/TMCM-6212.eds"))  # type: ignore[no-untyped-call]
            node.sdo.RESPONSE_TIMEOUT = PATIENCE
            for name in ("SWITCH_OP_MODE", "SWITCH_STATE_FINAL", "SWITCH_STATE_SINGLE", "CHECK_TPDO"):
                setattr(node, f"TIMEOUT_{name}", PATIENCE)
            network.add_node(node)
            node.nmt.state = "PRE-OPERATIONAL"
            node.setup_402_state_machine(read_pdos=request.param == "by_pdo")
            if request.param == "by_pdo":
                for number in (1, 2):
                    node.tpdo[number].event_timer = TPDO_PERIOD_MS
                    node.tpdo[number].save()
            node.nmt.state = "OPERATIONAL"  # which brings the first statusword by TPDO
            until(lambda: node.state == "SWITCH ON DISABLED")
            yield Patient(node, device)
        finally:
            network.disconnect()


def until(holds: Any) -> None:
    """Wait for something that the device does by itself."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.001)


def test_it_drives_axis_0(patient: Patient) -> None:
    node = patient.node
    node.sdo["Switch Parameters 1"].raw = 3
    node.state = "OPERATION ENABLED"
    assert node.state == "OPERATION ENABLED"
    node.sdo[0x6098].raw = 35
    node.op_mode = "HOMING"
    assert node.homing(timeout=PATIENCE)
    node.op_mode = "PROFILED VELOCITY"  # by RPDO 2, whose controlword it leaves 0
    node.state = "OPERATION ENABLED"
    node.sdo[0x6083].raw = 1_000_000
    node.sdo[0x60FF].raw = 20_000
    until(lambda: node.sdo[0x606C].raw == 20_000)
    node.state = "SWITCHED ON"
    node.state = "SWITCH ON DISABLED"
    assert node.sdo[0x606C].raw == 0


def test_it_resets_a_fault(patient: Patient) -> None:
    node, device = patient
    node.state = "OPERATION ENABLED"
    device.fault(0, "overtemperature")
    until(node.is_faulted)
    until(lambda: [error.code for error in node.emcy.active] == [0x4310])
    device.fault(0, "overtemperature", False)
    until(lambda: node.sdo[0x2102].raw == 0)
    node.reset_from_fault()
    assert node.state == "OPERATION ENABLED"
