"""Plans of PDOs, and what is wrong with them."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import pytest

from odsmith_runtime.client import BusLoad, PlanError, Rpdo, Tpdo
from odsmith_runtime.client.pdo_plan import frame_bits, place


@pytest.fixture
def axes(package: ModuleType) -> Any:
    return package.DICTIONARY.axes


def test_places(package: ModuleType, axes: Any) -> None:
    plan = [
        Rpdo(axes[0].controlword, axes[0].target_position),
        Tpdo(axes[0].statusword),
        Rpdo(axes[4].controlword, on_sync=1),
        Rpdo(axes[4].target_velocity, cob_id=0x690),
        Tpdo(axes[4].statusword, axes[4].position_actual_value, on_sync=2),
    ]
    places = place(plan, package.DICTIONARY, 5)
    assert [(each.label, each.can_id, each.octets) for each in places] == [
        ("RPDO 1 of axis 0", 0x205, 6),
        ("TPDO 1 of axis 0", 0x185, 2),
        ("RPDO 1 of axis 4", 0x680, 2),
        ("RPDO 2 of axis 4", 0x690, 4),
        ("TPDO 1 of axis 4", 0x681, 6),
    ]


def test_everything_that_is_wrong(package: ModuleType, axes: Any) -> None:
    x = axes[1]
    plan = [
        Rpdo(),
        Rpdo(x.statusword),
        Tpdo(x.statusword, cob_id=0x601),
        Rpdo(x.controlword, cob_id=0x300),
        Rpdo(x.target_position, cob_id=0x300, on_sync=241),
        Tpdo(x.position_actual_value, x.position_demand_value, x.velocity_actual_value, x.statusword),
        Rpdo(x.target_velocity),
        Rpdo(x.velocity_offset),
    ]
    with pytest.raises(PlanError) as caught:
        place(plan, package.DICTIONARY, 1)
    for problem in (
        "RPDO with nothing: it maps nothing",
        "statusword of axis 1 (6841h) cannot be received in a PDO",
        "the CAN-ID 601h is not for PDOs",
        "the CAN-ID 300h is that of RPDO 2 of axis 1 already",
        "on_sync is 0 to 240, not 241",
        "4 entries, a PDO of this device takes 3",
        "112 bits, a PDO has 64",
        "axis 1 has no RPDO left",
    ):
        assert problem in str(caught.value)


def test_the_longest_frame() -> None:
    assert (frame_bits(0), frame_bits(8)) == (55, 135)


def test_bus_load(package: ModuleType, axes: Any) -> None:
    plan = [
        Rpdo(axes[0].controlword, axes[0].target_position, on_sync=1),
        Tpdo(axes[0].statusword, axes[0].position_actual_value, on_sync=2),
        Tpdo(axes[0].velocity_actual_value, event_timer=0.1),
        Tpdo(axes[0].position_demand_value),
    ]
    load = BusLoad(place(plan, package.DICTIONARY, 1), 0.01, 125_000)
    bits = 100 * frame_bits(0) + 100 * frame_bits(6) + 50 * frame_bits(6) + 10 * frame_bits(4)
    assert load.ratio == pytest.approx(bits / 125_000)
    assert str(load).splitlines() == [
        "                      CAN-ID octets  frames/s   load",
        "SYNC                    080h      0     100.0  4.40%",
        "RPDO 1 of axis 0        201h      6     100.0  9.20%",
        "TPDO 1 of axis 0        181h      6      50.0  4.60%",
        "TPDO 2 of axis 0        281h      4      10.0  0.76%",
        "TPDO 3 of axis 0        381h      4 on change",
        "all at 125 kbit/s                             18.96%",
    ]
