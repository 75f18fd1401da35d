"""What the live view shows, and what its keys do."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from tests.unit.runtime_py.io.conftest import generated, number

from odsmith.commands.live_view import Desk, picture
from odsmith_runtime.device import Frame
from odsmith_runtime.io import Simulator, VirtualDevice

OPERATIONAL = Frame(0, b"\x01\0")


def make(count: int) -> Desk:
    """A desk with devices that nobody has started."""
    simulator, package = Simulator(), generated("tmcm6212")
    return Desk([VirtualDevice(package, node, engine="python", simulator=simulator) for node in range(1, count + 1)])


def seen(desk: Desk, height: int = 40) -> list[str]:
    """The lines of the picture, on a terminal of so many of them."""
    console = Console(file=io.StringIO(), width=120, height=height)
    with console.capture() as captured:
        console.print(picture(desk.device.simulator, desk, ["socketcand 127.0.0.1:29536"], height))
    return captured.get().splitlines()


def test_everything_is_shown() -> None:
    desk = make(1)
    desk.device.exchange(OPERATIONAL, Frame(0x601, bytes.fromhex("2f60600003000000")))
    for key in "3t":
        assert desk.press(key)
    desk.device.run(0.01)
    lines = seen(desk)
    assert lines[0].split() == ["TMCM-6212", "on", "socketcand", "127.0.0.1:29536", "engine", "python", "0.0", "s"]
    assert "node 1   Operational   LEDs green" in lines[1]
    assert "last EMCY 4310h Overtemperature error, axis 3" in lines[1]
    assert lines[2].strip("│ ").split() == ["axis", "state", "mode", "position", "velocity", "load", "shaft"]
    assert lines[3].strip("│ ").split() == ["0", "Switch", "on", "disabled", "pv", "0", "0", "0", "0"]
    assert lines[6].strip("│ ").split() == ["3", "Fault", "none", "0", "0", "0", "0"]
    assert lines[-1].startswith("0-9 axis")


@pytest.mark.parametrize("height", [24, 30])
def test_the_chosen_node_is_seen_on_any_terminal(height: int) -> None:
    desk = make(4)
    desk.press("n")
    desk.press("n")
    lines = seen(desk, height)
    assert len(lines) <= height
    assert [line.split("node ")[1][0] for line in lines if "Pre-operational" in line] == ["1", "2", "3", "4"]
    assert "node 3" in next(line for line in lines if line.startswith("╭"))
    assert sum("Switch on disabled" in line for line in lines) == 6
    assert lines[-1].startswith("0-9 axis")
    assert sum("Switch on disabled" in line for line in seen(desk, 60)) == 24


def test_keys_do_to_the_chosen_node_what_they_say() -> None:
    desk = make(2)
    one, two = desk.devices
    for key in "n2l":
        assert desk.press(key)
    one.run(0.002)
    assert number(two, 0x70FD) & 1  # the limit switch of axis 2
    assert not number(one, 0x70FD) & 1
    for key in "lx":
        desk.press(key)
    one.run(0.002)
    assert not number(two, 0x70FD) & 1
    assert two.exchange(Frame(0x602, bytes.fromhex("4000100000000000"))) == []  # lost
    desk.press("p")
    assert not two.view().is_on
    desk.press("p")
    assert two.view().is_on
    assert not any(desk.press(key) for key in ("q", "\x03"))
