"""`python bench/bench_virtual.py`: how many virtual TMCM-6212 one core runs in real time, in one process.

All on one wire, frames by function call, engines in C (`make engine`); each with six axes that turn at a constant
speed, a heartbeat and SYNC at 100 Hz. Counted in time of the CPU, which what else the machine does leaves alone: with n
devices that take c seconds of it for s simulated ones, a core keeps up with n s / c of them.

Measured with all TPDOs off; with those of delivery, which are those of axis 0: statusword and mode on change,
statusword and position with each SYNC; and with the same ones of all six axes.
"""

from __future__ import annotations

import argparse
import importlib
import statistics
import sys
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT / "generated" / name / "python") for name in ("cia", "tmcm6212")]

from odsmith_runtime.device import Frame  # noqa: E402
from odsmith_runtime.io.engine import make_engine  # noqa: E402
from odsmith_runtime.io.wire import Wire  # noqa: E402

HEARTBEAT_MS = 100
CYCLE_US = 10_000
SPEED_PPS = 51_200
OFF, NO_RTR = 1 << 31, 1 << 30
FREE_CAN_IDS = range(0x680, 0x6E0)  # all devices share them: nobody listens to TPDOs here


class Bus:
    """A wire with devices whose axes turn; `frames` counts what they sent."""

    def __init__(self, package: Any, count: int, axes: range) -> None:
        self.frames = 0
        self.wire = Wire(self._heard)
        self._package = package
        for node in range(1, count + 1):
            station = self.wire.attach(make_engine(package, node, choice="c", serial_number=node))
            self.wire.power_on(station)
        for node in range(1, count + 1):
            self._set_up(node, axes)
        self.wire.transmit(Frame(0x000, bytes([1, 0])), None)
        self.run(1_000_000)  # everything that is enabled on the way is over

    def _heard(self, time: int, frame: Frame, origin: object) -> None:
        self.frames += origin is not None
        if frame.id >> 7 == 0x580 >> 7 and frame.data[0] == 0x80:
            raise SystemExit(f"node {frame.id & 0x7F} aborted: {frame.data.hex()}")

    def _set_up(self, node: int, axes: range) -> None:
        objects = self._package.DICTIONARY
        self._write(node, objects[0x1017][0], HEARTBEAT_MS)
        free = iter(FREE_CAN_IDS)
        for record in objects.pdos:
            if record.kind == "tpdo":
                cob_id = record.communication["cob_id"]
                default = (cob_id.default(node) or 0) & 0x7FF
                can_id = default or next(free)
                self._write(node, cob_id, can_id | NO_RTR | (OFF if record.axis not in axes else 0))
        for axis in range(objects.axis_count):
            for index, value in (
                (0x2005, 3),  # no limit switches
                (0x6083, 1_000_000),
                (0x6060, 3),
                (0x60FF, SPEED_PPS),
                (0x6040, 6),
                (0x6040, 7),
                (0x6040, 15),
            ):
                self._write(node, objects.at(index, axis)[0], value)

    def _write(self, node: int, entry: Any, value: int) -> None:
        data = entry.encode(value)
        head = bytes([0x23 | 4 - len(data) << 2, entry.index & 0xFF, entry.index >> 8, entry.sub])
        self.wire.transmit(Frame(0x600 + node, (head + data).ljust(8, b"\0")), None)

    def run(self, microseconds: int) -> None:
        """Let time pass, with SYNC."""
        sync = Frame(0x080, b"")
        for _ in range(microseconds // CYCLE_US):
            self.wire.run(self.wire.now + CYCLE_US)
            self.wire.transmit(sync, None)

    def check(self) -> None:
        """That it is the load that it claims to be: every axis turns."""
        for axis in range(self._package.IDENTITY.axes):
            before = [station.engine.shaft(axis) for station in self.wire.stations]
            self.run(CYCLE_US)
            for station, start in zip(self.wire.stations, before, strict=True):
                if station.engine.shaft(axis) - start != SPEED_PPS * CYCLE_US // 1_000_000:
                    raise SystemExit(f"axis {axis} of node {station.engine.node_id} does not turn")


def measure(bus: Bus, seconds: float) -> tuple[float, float]:
    """Simulated seconds for a second of the CPU, and frames of devices per simulated second."""
    before, start = bus.frames, time.process_time()
    bus.run(round(seconds * 1e6))
    return seconds / (time.process_time() - start), (bus.frames - before) / seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--devices", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=1.0, help="simulated, of each run")
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    package = importlib.import_module("tmcm6212")
    print(
        f"TMCM-6212 that a core runs in real time: six axes at {SPEED_PPS} pps, SYNC at {1e6 / CYCLE_US:.0f} Hz, "
        f"a heartbeat each {HEARTBEAT_MS} ms\n({options.devices} of them, {options.runs} runs of "
        f"{options.seconds:g} s; median)"
    )
    for name, axes in (
        ("without TPDOs", range(0)),
        ("with the TPDOs of delivery", range(1)),
        ("with those of all axes", range(package.IDENTITY.axes)),
    ):
        bus = Bus(package, options.devices, axes)
        bus.check()
        runs = [measure(bus, options.seconds) for _ in range(options.runs)]
        bus.check()
        rate = statistics.median(each[0] for each in runs)
        print(f"  {name:<30} {options.devices * rate:6.0f} devices   {runs[0][1]:8.0f} frames/s")


if __name__ == "__main__":
    main()
