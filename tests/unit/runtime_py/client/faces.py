"""Both faces of the client behind one: a story is told once and played by a program that blocks and by asyncio."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Callable, Coroutine
from types import ModuleType
from typing import Any

from odsmith_runtime.client.virtual import VirtualNetwork
from odsmith_runtime.client.waiting import run

FACES = ("blocking", "asyncio")


async def did(result: Any) -> Any:
    """What a method gave: at once on a blocking drive, after waiting on one for asyncio."""
    return await result if inspect.isawaitable(result) else result


class Bench:
    """A device in this process, and a drive that talks to it."""

    def __init__(self, package: ModuleType, face: str, engine: str = "python", node_id: int = 1) -> None:
        self.face = face
        self.network = VirtualNetwork(package, node_id, engine=engine)
        self.device = self.network.devices[0]
        drive_class = getattr(package, "TMCM6212" if face == "blocking" else "AsyncTMCM6212")
        waiter = self.network.waiter() if face == "blocking" else self.network.async_waiter()
        self.drive: Any = drive_class(self.network, node_id, waiter=waiter)

    @property
    def seconds(self) -> float:
        """Virtual time since power-on."""
        return self.network.now_us / 1e6

    def play(self, story: Callable[[Any], Coroutine[Any, Any, None]]) -> None:
        """Tell a story to the drive."""
        if self.face == "blocking":
            run(story(self.drive))
        else:
            asyncio.run(story(self.drive))

    def set(self, axis: int, name: str, value: int) -> None:
        """Set an input of the simulated hardware of an axis."""
        self.device.set_hardware(self.network.now_us, axis, name, value)

    def fault(self, axis: int, condition: str, holds: bool = True) -> None:
        """Let a condition of an axis hold, or end."""
        self.device.fault(self.network.now_us, axis, condition, holds)

    def sent(self, can_id: int) -> list[bytes]:
        """What was sent with a CAN-ID so far."""
        return [frame.data for _, frame in self.network.log if frame.id == can_id]


async def tune(axis: Any) -> None:
    """Make an axis quick, so that its moves are short; without limit switches."""
    for name, value in (
        ("switch_parameters", 3),
        ("profile_velocity", 500_000),
        ("profile_acceleration", 5_000_000),
        ("profile_deceleration", 5_000_000),
        ("quick_stop_deceleration", 5_000_000),
    ):
        await did(getattr(axis, name).write(value))


async def ready(drive: Any, axis: int = 0) -> Any:
    """A quick axis in operation."""
    found = drive.axes[axis]
    await tune(found)
    await did(found.enable())
    return found
