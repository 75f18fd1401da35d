"""The drive profile of python-canopen, as it is, drives axis 0 of our device with our EDS.

It knows no other axes: their controlwords are at other indices.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest
from canopen.pdo import PdoMap
from canopen.profiles.p402 import BaseNode402

from odsmith_runtime.client.virtual import VirtualNetwork

TPDO_PERIOD_MS = 5


@pytest.fixture(params=["by_sdo", "by_pdo"])
def node(request: pytest.FixtureRequest, root: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A node of python-canopen on a network without a bus.

    By PDO it takes what it received twice for periodic and waits for the next one, so TPDO 1 and 2 (statusword, mode)
    get an event timer. Where it waits, virtual time passes.
    """
    for name in ("cia", "tmcm6212"):
        monkeypatch.syspath_prepend(str(root / "generated" / name / "python"))
    network = VirtualNetwork(importlib.import_module("tmcm6212"))

    def wait_for_reception(pdo: Any, timeout: float = 10) -> float | None:
        pdo.is_received = False
        until = network.now_us + timeout * 1e6
        while not pdo.is_received and network.now_us < until:
            network.advance(1000)
        return pdo.timestamp if pdo.is_received else None

    monkeypatch.setattr(PdoMap, "wait_for_reception", wait_for_reception)
    found: Any = BaseNode402(1, str(root / "generated/tmcm6212/eds/TMCM-6212.eds"))  # type: ignore[no-untyped-call]
    network.add_node(found)
    found.nmt.state = "PRE-OPERATIONAL"
    found.setup_402_state_machine(read_pdos=request.param == "by_pdo")
    if request.param == "by_pdo":
        for number in (1, 2):
            found.tpdo[number].event_timer = TPDO_PERIOD_MS
            found.tpdo[number].save()
    found.nmt.state = "OPERATIONAL"  # which brings the first statusword by TPDO
    return found


def test_it_drives_axis_0(node: Any) -> None:
    assert node.state == "SWITCH ON DISABLED"
    node.sdo["Switch Parameters 1"].raw = 3
    node.state = "OPERATION ENABLED"
    assert node.state == "OPERATION ENABLED"
    node.sdo[0x6098].raw = 35
    node.op_mode = "HOMING"
    assert node.homing(timeout=1)
    node.op_mode = "PROFILED VELOCITY"  # by RPDO 2, whose controlword it leaves 0
    node.state = "OPERATION ENABLED"
    node.sdo[0x6083].raw = 1_000_000
    node.sdo[0x60FF].raw = 20_000
    questions = range(1000)  # each lets virtual time pass
    assert any(node.sdo[0x606C].raw == 20_000 for _ in questions)
    node.state = "SWITCHED ON"
    node.state = "SWITCH ON DISABLED"
    assert node.sdo[0x606C].raw == 0


def test_it_resets_a_fault(node: Any) -> None:
    network = node.network
    assert isinstance(network, VirtualNetwork)
    node.state = "OPERATION ENABLED"
    network.devices[0].fault(network.now_us, 0, "overtemperature", True)
    network.advance(5000)
    assert node.is_faulted()
    assert [error.code for error in node.emcy.active] == [0x4310]
    network.devices[0].fault(network.now_us, 0, "overtemperature", False)
    network.advance(5000)
    node.reset_from_fault()
    assert node.state == "OPERATION ENABLED"
