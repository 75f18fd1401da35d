"""Six axes, each with a task of its own: the same drive for asyncio."""

from __future__ import annotations

import asyncio

from tmcm6212 import AsyncTMCM6212, AsyncTMCM6212Axis

from connection import arguments


async def swing(axis: AsyncTMCM6212Axis) -> None:
    """There and back, the further the higher the number of the axis."""
    await axis.switch_parameters.write(3)  # no limit switches are connected
    await axis.profile_velocity.write(100_000)
    await axis.profile_acceleration.write(400_000)
    await axis.profile_deceleration.write(400_000)
    await axis.enable()
    await axis.move_to(2000 * (axis.number + 1))
    print(f"axis {axis.number} is at {await axis.position()}")
    await axis.move_to(0)
    await axis.disable()


async def main(drive: AsyncTMCM6212) -> None:
    await asyncio.gather(*(swing(axis) for axis in drive.axes))


async def connected() -> None:
    async with AsyncTMCM6212.connect(**arguments()) as drive:
        await main(drive)


if __name__ == "__main__":
    asyncio.run(connected())
