"""The client on buses with threads, in real time: python-can's virtual interface and socketcand."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest
from tests.unit.runtime_py.client.faces import FACES, did, tune

from odsmith_runtime.io import VirtualDevice

pytestmark = pytest.mark.slow

SPEED = 5
PATIENCE = 60.0  # seconds: a machine may be busy with something else


@pytest.fixture(params=["virtual", "socketcand"])
def bus(request: pytest.FixtureRequest, package: ModuleType, engine: str) -> Iterator[dict[str, Any]]:
    """How to reach a device that runs in threads of its own, five times as fast as a real one."""
    if request.param == "virtual":
        here: dict[str, Any] = {"interface": "virtual", "channel": request.node.name}
        with VirtualDevice(package, 5, engine=engine, speed=SPEED, **here):
            yield here
    else:
        with VirtualDevice(package, 5, engine=engine, speed=SPEED, listen="127.0.0.1:0") as device:
            yield {"interface": "socketcand", "host": "127.0.0.1", "port": device.port, "channel": "can0"}


@pytest.mark.parametrize("face", FACES)
def test_a_move(package: ModuleType, bus: dict[str, Any], face: str) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[3]
        await tune(axis)
        await did(axis.enable(PATIENCE))
        await did(axis.move_to(2000, timeout=PATIENCE))
        assert await did(axis.position()) == 2000
        await did(drive.disable(PATIENCE))
        assert drive.nmt_state in ("INITIALISING", "PRE-OPERATIONAL")

    async def on_asyncio() -> None:
        async with package.AsyncTMCM6212.connect(node_id=5, answer_timeout=PATIENCE, **bus) as drive:
            await story(drive)

    if face == "asyncio":
        asyncio.run(on_asyncio())
        return
    with package.TMCM6212.connect(node_id=5, answer_timeout=PATIENCE, **bus) as drive, pytest.raises(StopIteration):
        story(drive).send(None)
