"""The examples do what they say, with a device in this process."""

from __future__ import annotations

import asyncio
import importlib
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from odsmith_runtime.client.virtual import VirtualNetwork

pytestmark = pytest.mark.slow


@pytest.fixture
def network(root: Path, monkeypatch: pytest.MonkeyPatch) -> VirtualNetwork:
    for folder in ("examples", "generated/cia/python", "generated/tmcm6212/python"):
        monkeypatch.syspath_prepend(str(root / folder))
    return VirtualNetwork(importlib.import_module("tmcm6212"))


@pytest.fixture
def drive(network: VirtualNetwork) -> Any:
    return sys.modules["tmcm6212"].TMCM6212(network, waiter=network.waiter())


def example(name: str) -> ModuleType:
    return importlib.import_module(name)


def test_profile_position(drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    example("profile_position").main(drive)
    assert capsys.readouterr().out == "axis 0 is at 25600 microsteps, 0.5 revolutions\n"


def test_profile_velocity(drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    example("profile_velocity").main(drive)
    assert capsys.readouterr().out.splitlines() == [
        "axis 0 turns at 100000 pps, 1.953 revolutions per second",
        "axis 0 turns at -51200 pps",
    ]


def test_homing(network: VirtualNetwork, drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    for name, value in (("home_from", 20_000), ("home_to", 30_000)):
        network.devices[0].set_hardware(network.now_us, 0, name, value)
    example("homing").main(drive)
    assert capsys.readouterr().out == "axis 0 found its home and is at 0\n"


def test_two_axes(drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    example("two_axes").main(drive)
    assert capsys.readouterr().out.split("\n") == ["(20000, 0)", "(20000, 20000)", "(0, 20000)", "(0, 0)", ""]


def test_six_axes_asyncio(network: VirtualNetwork, drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    drive.close()
    asynchronous = sys.modules["tmcm6212"].AsyncTMCM6212(network, waiter=network.async_waiter())
    asyncio.run(example("six_axes_asyncio").main(asynchronous))
    assert sorted(capsys.readouterr().out.splitlines()) == [
        f"axis {axis} is at {2000 * (axis + 1)}" for axis in range(6)
    ]


def test_six_axes_csp(drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    example("six_axes_csp").main(drive)
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 16  # a table of SYNC and 12 PDOs, its head and its sum, and the end
    assert said[-1] == "at 0 0 0 0 0 0"


def test_fault_and_recover(network: VirtualNetwork, drive: Any, capsys: pytest.CaptureFixture[str]) -> None:
    device = network.devices[0]

    def trouble(swing: int) -> None:
        device.fault(network.now_us, 1, "overtemperature", swing == 3)

    def repair() -> None:
        device.fault(network.now_us, 1, "overtemperature", False)
        network.advance(2000)

    example("fault_and_recover").main(drive, trouble, repair)
    stopped, others, not_yet, back = capsys.readouterr().out.splitlines()
    assert stopped.startswith(
        "Stopped: axis 1 is in fault, not in operation_enabled: bit 3 of the statusword (fault): Over"
    )
    assert others == "axis 0 arrived all the same and is operation_enabled, axis 1 is in fault"
    assert not_yet.startswith("Not yet: axis 1 is in fault, not in operation_enabled")
    assert back == "axis 1 is back, at 0"


def test_nothing_fails(drive: Any, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    story = example("fault_and_recover")
    monkeypatch.setattr(story, "SWINGS", 2)
    story.main(drive, story.say, lambda: None)
    assert capsys.readouterr().out.endswith("Nothing happened.\n")


def test_plot(drive: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plot = example("plot")
    samples = plot.record(drive)
    assert samples[-1].position == 102_400
    assert max(sample.velocity for sample in samples) == 80_000
    drive.axes[0].enable()
    drive.axes[0].move_to(102_000)
    drive.axes[0].disable()
    plot.main(drive, tmp_path / "move.png")
    assert "samples, the last one: Sample(time=" in capsys.readouterr().out
    assert (tmp_path / "move.png").exists() is (importlib.util.find_spec("matplotlib") is not None)


def test_the_picture_shows_this_move(drive: Any, root: Path, accept: bool) -> None:
    """The picture of the page was drawn from the very samples that the example records now."""
    plot = example("plot")
    samples = plot.record(drive)
    picture = root / "examples" / "move.png"
    if accept:
        plot.draw(samples, picture)
    assert b"tEXtComment\0" + plot.fingerprint(samples).encode() in picture.read_bytes(), "make pictures"


def test_the_command_line(network: VirtualNetwork, monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = example("connection").arguments
    monkeypatch.setattr(sys, "argv", ["x"])
    virtual = {"interface": "socketcand", "channel": "can0", "host": "127.0.0.1", "port": 29536, "node_id": 1}
    assert arguments() == virtual
    monkeypatch.setattr(sys, "argv", ["x", "--interface", "pcan", "--bitrate", "500000", "--node-id", "7"])
    assert arguments() == {"interface": "pcan", "channel": "can0", "bitrate": 500_000, "node_id": 7}
