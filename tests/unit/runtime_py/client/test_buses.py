"""The client on buses with threads, in real time: python-can's virtual interface and socketcand."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Iterator
from types import ModuleType
from typing import Any, NamedTuple

import pytest
from tests.unit.runtime_py.client.faces import FACES, did, tune

from odsmith_runtime.client import EmergencyError, MotionTimeoutError, Rpdo, StateError, Tpdo
from odsmith_runtime.client.waiting import run
from odsmith_runtime.io import VirtualDevice

pytestmark = pytest.mark.slow

SPEED = {"python": 1, "c": 5}
"""Times as fast as a real one: a simulation that cannot keep up answers late. Here nothing takes long anyway."""
PERIOD = 0.005
PATIENCE = 60.0  # seconds: a machine may be busy with something else


class Here(NamedTuple):
    """A device that runs in threads of its own, and how to reach it."""

    device: VirtualDevice
    bus: dict[str, Any]


@pytest.fixture(params=["virtual", "socketcand"])
def here(request: pytest.FixtureRequest, package: ModuleType, engine: str) -> Iterator[Here]:
    if request.param == "virtual":
        bus: dict[str, Any] = {"interface": "virtual", "channel": request.node.name}
        with VirtualDevice(package, 5, engine=engine, speed=SPEED[engine], **bus) as device:
            yield Here(device, bus)
    else:
        with VirtualDevice(package, 5, engine=engine, speed=SPEED[engine], listen="127.0.0.1:0") as device:
            yield Here(device, {"interface": "socketcand", "host": "127.0.0.1", "port": device.port, "channel": "can0"})


Play = Callable[[Callable[[Any], Coroutine[Any, Any, None]]], None]


@pytest.fixture(params=FACES)
def play(request: pytest.FixtureRequest, package: ModuleType, here: Here) -> Play:
    """Tell a story to a drive of each face."""

    async def on_asyncio(story: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
        async with package.AsyncTMCM6212.connect(node_id=5, answer_timeout=PATIENCE, **here.bus) as drive:
            await story(drive)

    def tell(story: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
        if request.param == "asyncio":
            asyncio.run(on_asyncio(story))
        else:
            with package.TMCM6212.connect(node_id=5, answer_timeout=PATIENCE, **here.bus) as drive:
                run(story(drive))

    return tell


async def until(drive: Any, holds: Callable[[], bool]) -> None:
    """Let time pass until something has come by itself."""
    for _ in range(round(PATIENCE / 0.001)):
        if holds():
            return
        await did(drive.pause(0.001))
    pytest.fail("it does not come")


def test_a_move(play: Play) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[3]
        await tune(axis)
        await did(axis.enable(PATIENCE))
        await did(axis.move_to(2000, timeout=PATIENCE))
        assert await did(axis.position()) == 2000
        await did(drive.disable(PATIENCE))
        assert drive.nmt_state in ("INITIALISING", "PRE-OPERATIONAL")

    play(story)


def test_process_data(play: Play) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await tune(axis)
        plan = [
            Rpdo(axis.controlword, axis.target_position),
            Tpdo(axis.statusword),
            Tpdo(axis.position_actual_value, on_sync=True),
        ]
        load = await did(drive.configure_pdos(plan, sync_period=0.01))
        assert 0 < load.ratio < 0.1
        assert drive.nmt_state == "OPERATIONAL"
        await did(axis.enable(PATIENCE))
        await did(axis.move_to(1500, timeout=PATIENCE))
        assert await did(axis.position()) == 1500
        assert await did(axis.position_actual_value.read()) == 1500  # by SDO
        await did(axis.disable(PATIENCE))

    play(story)


def test_a_stream_with_sync(play: Play) -> None:
    async def story(drive: Any) -> None:
        axes = drive.axes[:2]
        plan: list[Rpdo | Tpdo] = [Rpdo(axis.target_position, on_sync=True) for axis in axes]
        plan += [Tpdo(axis.statusword, axis.position_actual_value, on_sync=True) for axis in axes]
        await did(drive.configure_pdos(plan, sync_period=PERIOD))
        for axis in axes:
            await did(axis.enable(PATIENCE))
        rows = [{0: 20 * step, 1: -10 * step} for step in range(20)]
        assert await did(drive.stream(rows, period=PERIOD, axes=[0, 1])) == {}
        for axis, target in zip(axes, (380, -190), strict=True):
            await did(axis.wait(PATIENCE))
            assert await did(axis.position()) == target

    play(story)


def test_a_fault_and_the_way_out(play: Play, here: Here) -> None:
    async def story(drive: Any) -> None:
        axis, other = drive.axes[1], drive.axes[4]
        for each in (axis, other):
            await tune(each)
            await did(each.enable(PATIENCE))
            await did(each.run(20_000, timeout=PATIENCE))
        here.device.fault(1, "overtemperature")
        await until(drive, lambda: bool(drive.emergencies))
        with pytest.raises(EmergencyError, match="axis 1 reports") as caught:
            await did(axis.wait(PATIENCE))
        assert caught.value.axis == 1
        assert await did(other.velocity()) == 20_000
        here.device.fault(1, "overtemperature", False)
        with pytest.raises(StateError, match="bit 3 of the statusword"):
            await did(axis.enable(PATIENCE))
        await did(axis.reset_fault(PATIENCE))
        await until(drive, lambda: drive.emergencies[-1].code == 0)
        await did(axis.enable(PATIENCE))
        await did(axis.move_by(500, timeout=PATIENCE))
        await did(other.stop(PATIENCE))

    play(story)


def test_six_axes_in_different_modes(play: Play) -> None:
    async def story(drive: Any) -> None:
        for axis in drive.axes:
            await tune(axis)
        await did(drive.enable(PATIENCE))
        await did(drive.axes[0].move_to(5000, wait=False))
        await did(drive.axes[1].move_by(-3000, wait=False))
        await did(drive.axes[2].run(20_000, wait=False))
        await did(drive.axes[3].run(-30_000, wait=False))
        await did(drive.axes[4].home(35, wait=False))
        await did(drive.axes[5].set_mode("csp"))
        await did(drive.axes[5].target_position.write(40))
        await did(drive.wait(timeout=PATIENCE))
        assert [await did(drive.axes[axis].position()) for axis in (0, 1, 4, 5)] == [5000, -3000, 0, 40]
        assert [await did(drive.axes[axis].velocity()) for axis in (2, 3)] == [20_000, -30_000]
        await did(drive.disable(PATIENCE))

    play(story)


def test_a_wait_that_is_over(play: Play) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await tune(axis)
        await did(axis.enable(PATIENCE))
        await did(axis.profile_velocity.write(1000))
        with pytest.raises(MotionTimeoutError, match=r"axis 0 did not end its movement within 0.01 s") as caught:
            await did(axis.move_to(1_000_000_000, timeout=0.01))
        assert "target_position 1000000000" in caught.value.seen
        await did(axis.stop(PATIENCE))
        assert await did(axis.state()) == "operation_enabled"

    play(story)
