"""The values that the runtime knows by name, as the shipped vocabulary has them."""

from __future__ import annotations

from collections.abc import Callable

import odsmith_cia
import pytest
from odsmith_cia.values import AxisValues, DeviceValues, PdoValues

Values = AxisValues | DeviceValues | PdoValues


def test_the_package_has_them_too() -> None:
    assert odsmith_cia.AxisValues is AxisValues
    assert odsmith_cia.DeviceValues is DeviceValues
    assert odsmith_cia.PdoValues is PdoValues


@pytest.mark.parametrize("make", [AxisValues, DeviceValues, PdoValues])
def test_each_role_is_there_with_a_zero_of_its_type(make: Callable[[], Values]) -> None:
    values = make()
    scope = {AxisValues: "axis", DeviceValues: "device", PdoValues: "pdo"}[type(values)]
    roles = [role for role in odsmith_cia.ROLES.values() if role.scope == scope]
    assert set(type(values).__slots__) == {role.name for role in roles}
    for role in roles:
        value = getattr(values, role.name)
        if role.length:
            assert value == bytes(role.length), role.name
        else:
            assert value == ([0] * role.count if role.count > 1 else 0), role.name


def test_lists_are_not_shared() -> None:
    one, other = PdoValues(), PdoValues()
    one.pdo_mapping[7] = 0x60400010
    assert other.pdo_mapping == [0] * 8
