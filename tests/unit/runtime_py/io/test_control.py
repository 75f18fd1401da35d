"""Commands of hands: each does what it says, and others are refused with what would be possible."""

from __future__ import annotations

import pytest
from tests.unit.runtime_py.io.conftest import number, read

from odsmith_runtime.device.simulation import INPUTS, SUPPLY
from odsmith_runtime.io import CommandError, VirtualDevice
from odsmith_runtime.io.control import UNITS


@pytest.mark.parametrize("condition", ["overtemperature", "open_load_b", "following_error"])
def test_faults(device: VirtualDevice, condition: str) -> None:
    device.inject(f"axis4 {condition} on")
    device.run(0.002)
    _, _, emergency = device.emergencies[-1]
    assert emergency is not None
    assert (emergency.condition, emergency.axis) == (condition, 4)
    assert number(device, 0x1001) != 0
    device.inject(f"axis4 {condition} off")
    device.run(0.002)
    assert number(device, 0x1001) == 0


def test_on_may_be_left_out(device: VirtualDevice) -> None:
    device.inject("axis0 left")
    device.inject("axis0 overtemperature")
    device.run(0.002)
    assert number(device, 0x60FD) & 1
    assert number(device, 0x1001) != 0


def test_every_input_is_a_switch_or_has_a_unit() -> None:
    assert {name for name, limits in INPUTS.items() if (limits.low, limits.high) != (0, 1)} == {*INPUTS} & {*UNITS}


@pytest.mark.parametrize("name", sorted({*INPUTS} & {*UNITS} - {SUPPLY}))
@pytest.mark.parametrize("value", ["", "on"])
def test_a_number_is_not_left_out(device: VirtualDevice, name: str, value: str) -> None:
    """`axis0 home_from` would else be a switch at position 1."""
    with pytest.raises(CommandError, match=rf"{name} wants a whole number \({UNITS[name]}\)"):
        device.inject(f"axis0 {name} {value}")


@pytest.mark.parametrize(("command", "faulty"), [("supply 5000", True), ("supply 24000", False)])
def test_supply(device: VirtualDevice, command: str, faulty: bool) -> None:
    device.inject(command)
    device.run(0.002)
    assert bool(number(device, 0x1001)) is faulty


def test_a_stall_holds_the_shaft(device: VirtualDevice) -> None:
    device.inject("axis1 stall on")
    assert device.simulator.wire.stations[0].engine is device.engine
    device.inject("axis1 shaft 700")
    assert device.engine.shaft(1) == 700
    device.inject("axis1 blocked off")


def test_module(device: VirtualDevice) -> None:
    device.inject("enable off")
    device.inject("in1 on")
    device.inject("in3 on")
    device.inject("in1 off")
    device.inject("analog2 1234")
    device.run(0.002)
    assert not number(device, 0x6041) & 0x10  # no voltage enabled
    assert (number(device, 0x3002), number(device, 0x300E, 3)) == (0x80000, 1234)
    device.inject("can passive")
    device.run(0.002)
    assert number(device, 0x1001) & 0x10


def test_the_bus(device: VirtualDevice) -> None:
    device.inject("lose 1")
    assert device.exchange(read(0x1000)) == []
    assert len(device.exchange(read(0x1000))) == 1
    device.inject("delay 3")
    assert device.exchange(read(0x1000)) == []
    assert len(device.run(0.003)) == 1


def test_power(device: VirtualDevice) -> None:
    device.inject("address 77")
    device.inject("power off")
    assert not device.view().is_on
    assert device.view().state == "no power"
    device.inject("power on")
    assert device.node_id == 77
    device.inject("power cycle")
    assert device.view().is_on


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("", "nothing to do"),
        ("axis6 left on", "no axis 6, axes are 0 to 5"),
        ("axis0", "wanted: the name"),
        ("axis0 left on now", "wanted: the name"),
        ("axis0 lift on", "no `lift` of an axis, but .*left, left_at"),
        ("axis0 supply 7", "no `supply` of an axis"),
        ("axis0 fault_reset on", "no `fault_reset`"),
        ("axis0 left 2", "on or off, not `2`"),
        ("axis0 load 2000", "load is 0 to 1023, not 2000"),
        ("axis0 overtemperature 2", "on or off, not `2`"),
        ("axis0 temperature warm", r"a whole number \(degrees Celsius\), not `warm`"),
        ("axis0 shaft 99999999999999999", "a whole number"),
        ("axis0 shaft 999999999999", "shaft is -"),
        ("supply", "wants one value: millivolts"),
        ("supply on", "supply wants a whole number"),
        ("supply -1", "supply is 0 to 100000"),
        ("lose", "wants one value: frames"),
        ("enable", "`enable` wants one value$"),
        ("analog0 on", "analog wants a whole number, not `on`"),
        ("in4 on", "no in4, the device has 4"),
        ("analog9 1", "no analog9"),
        ("can great", "ok, warning, passive"),
        ("power up", "on, off, cycle, not `up`"),
        ("delay 60001", "delay is 0 to 60000, not 60001"),
        ("coffee 1", "no `coffee`; known: axisN"),
    ],
)
def test_other_commands_are_refused(device: VirtualDevice, command: str, message: str) -> None:
    with pytest.raises(CommandError, match=message):
        device.inject(command)
