"""Six axes in step: set-points by PDO every 10 ms, taken over at SYNC (cyclic synchronous position mode)."""

from __future__ import annotations

import math
from collections.abc import Iterator

from tmcm6212 import TMCM6212

from connection import arguments
from odsmith_runtime.client import Rpdo, Tpdo

PERIOD = 0.010
CYCLES = 150
RADIUS = 8000


def waves(start: list[int]) -> Iterator[dict[int, int]]:
    """A row for each cycle: all axes swing, each a little later than the one before, and end where they began."""
    for cycle in range(1, CYCLES + 1):
        rise = math.sin(math.pi * cycle / CYCLES) ** 2  # soft at both ends
        yield {
            axis: position + round(RADIUS * rise * math.sin(2 * math.pi * cycle / 50 + axis))
            for axis, position in enumerate(start)
        }


def main(drive: TMCM6212) -> None:
    plan: list[Rpdo | Tpdo] = []
    for axis in drive.axes:
        axis.switch_parameters.raw = 3  # no limit switches are connected
        plan.append(Rpdo(axis.controlword, axis.target_position, on_sync=1))
        plan.append(Tpdo(axis.statusword, axis.position_actual_value, on_sync=1))
    print(drive.configure_pdos(plan, sync_period=PERIOD))
    drive.enable()
    drive.stream(waves([axis.position() for axis in drive.axes]), period=PERIOD)
    print("at", *(axis.position() for axis in drive.axes))
    drive.disable()


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
