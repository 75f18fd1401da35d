"""What only the blocking face has: attributes that can be assigned."""

from __future__ import annotations

from types import ModuleType

import pytest
from tests.unit.runtime_py.client.faces import Bench


def test_assigning(blocking: Bench) -> None:
    axis = blocking.drive.axes[0]
    axis.target_position.raw = 77
    assert axis.target_position.raw == axis.target_position.read() == 77
    axis.microstep_resolution.desc = "fullstep"
    assert axis.microstep_resolution.raw == 0
    axis.brake_delay_times.apply.phys = 0.25
    assert axis.brake_delay_times.apply.raw == 250
    axis.controlword.bits["halt"] = 1
    assert axis.controlword.bits[8] == 1


def test_a_value_itself_cannot_be_replaced(blocking: Bench) -> None:
    with pytest.raises(AttributeError, match="'target_position' names an entry"):
        blocking.drive.axes[0].target_position = 5
    with pytest.raises(AttributeError):
        blocking.drive.axes[0].target_positoin = 5


def test_nobody_waits_for_an_assignment(package: ModuleType) -> None:
    axis = Bench(package, "asyncio").drive.axes[0]
    with pytest.raises(AttributeError, match="raw cannot be assigned: nobody would wait for it"):
        axis.target_position.raw = 5
