"""Draws the pictures of this folder: what an axis of the TMCM-6212 really did, recorded from the device in Python.

    python site/motion/draw.py [DIRECTORY]

A drawing is a number of objects to write, a simulated hardware, and the lines to mark; nothing in it is drawn by hand.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent.parent
sys.path[:0] = [str(ROOT / "generated" / folder / "python") for folder in ("cia", "tmcm6212")]

from odsmith_runtime.device import Frame, Node, Output, Port, Tables  # noqa: E402  (the packages above come first)
from odsmith_runtime.device.port import MotorAnswer, MotorDemand  # noqa: E402
from odsmith_runtime.device.simulation import Simulation  # noqa: E402

NODE_ID = 1
TICK_US = 1000
LONGEST_MS = 20_000
SETTLED_MS = 50  # drawn after the end of a move

WIDTH, HEIGHT, LEFT, TOP, GAP, RIGHT, BOTTOM = 720, 150, 70, 24, 34, 90, 36
MANY = 700  # points of a line: more cannot be told apart


class Bench(Port):
    """A device whose axis 0 has simulated hardware."""

    def __init__(self, switches: Mapping[str, int]) -> None:
        self.tables = Tables.of(importlib.import_module("tmcm6212"))
        self.simulations = [Simulation() for _ in range(self.tables.identity.axes)]
        for name, value in switches.items():
            self.simulations[0].set(name, value)
        self.node = Node(self.tables, self)
        self.now = 0
        self.node.power_on(self.now)
        self.node.motor(self.now, 0, self.simulations[0].answer)

    def output(self, output: Output, channel: int, value: int) -> None:
        if output >= Output.POWER:
            self.simulations[channel].output(output, value)

    def motor(self, axis: int, demand: MotorDemand, answer: MotorAnswer) -> MotorAnswer:
        return self.simulations[axis].motor(demand)

    def write(self, name: str, value: int) -> None:
        """Write an object of axis 0 by SDO. `name` is that of an object, with the sub-index behind a point."""
        name, _, sub = name.partition(".")
        entry = self.tables.dictionary[name][sub or 0]
        octets = value.to_bytes(4, "little", signed=value < 0)
        command = bytes([0x22, *entry.index.to_bytes(2, "little"), entry.sub])
        self.node.receive(self.now, Frame(0x600 + NODE_ID, command + octets))

    def tick(self) -> None:
        self.now += TICK_US
        self.node.advance(self.now)


class Drawing(NamedTuple):
    """`objects` are written before the start; lines are drawn at the velocities `marks` and the positions `places`."""

    name: str
    title: str
    mode: int
    objects: Mapping[str, int]
    switches: Mapping[str, int] = {}
    marks: Mapping[str, int] = {}
    places: Mapping[str, int] = {}


SIX_POINT = {
    "profile_start_velocity": 4000,
    "profile_a1": 60_000,
    "profile_v1": 30_000,
    "profile_acceleration": 150_000,
    "profile_velocity": 80_000,
    "profile_deceleration": 200_000,
    "profile_d1": 80_000,
    "end_velocity": 12_000,
    "target_position": 80_000,
}
HOMING = {"homing_speeds.fast": 20_000, "homing_speeds.slow": 2000, "homing_acceleration": 100_000}
MACHINE = {"left_at": -8000, "right_at": 8000, "home_from": 2000, "home_to": 4000, "hysteresis": 100}
ENCODER = {"increments": 400, "revolution": 3200}
PLACES = {name.replace("_", " "): value for name, value in MACHINE.items() if name != "hysteresis"}
SPEEDS = {name.removeprefix("homing_speeds."): value for name, value in HOMING.items() if "speeds" in name}


def homing(method: int, title: str, shaft: int = 0) -> Drawing:
    objects = HOMING | {"homing_method": method, "encoder_parameters.polarity": 1, "sensor_selection_code": 1}
    objects |= {"position_encoder_resolution.encoder_increments": 400}
    switches = MACHINE | ENCODER | {"shaft": shaft}
    return Drawing(f"homing_{method}", f"Homing method {method}: {title}", 6, objects, switches, SPEEDS, PLACES)


DRAWINGS = (
    Drawing(
        "six_point_move",
        "A six point move",
        1,
        SIX_POINT,
        marks={
            "VSTART": SIX_POINT["profile_start_velocity"],
            "V1": SIX_POINT["profile_v1"],
            "VMAX": SIX_POINT["profile_velocity"],
            "VSTOP": SIX_POINT["end_velocity"],
        },
        places={"target": SIX_POINT["target_position"]},
    ),
    homing(17, "negative limit switch"),
    homing(18, "positive limit switch"),
    homing(19, "positive home switch"),
    homing(21, "negative home switch", shaft=6000),
    homing(1, "negative limit switch and index pulse"),
    homing(2, "positive limit switch and index pulse"),
    homing(3, "positive home switch and index pulse"),
    homing(5, "negative home switch and index pulse", shaft=6000),
    homing(33, "next index pulse in negative direction", shaft=3000),
    homing(34, "next index pulse in positive direction", shaft=-3000),
)


# ---- recording -------------------------------------------------------------------------------------------------------


class Sample(NamedTuple):
    velocity: int  # pps
    position: int  # of the shaft, microsteps


def record(drawing: Drawing) -> list[Sample]:
    """A sample for each millisecond from the start to a little after target reached."""
    bench = Bench(drawing.switches)
    bench.write("switch_parameters", 0 if drawing.switches else 3)
    for name, value in (dict(drawing.objects) | {"modes_of_operation": drawing.mode}).items():
        bench.write(name, value)
    bench.tick()
    for word in (6, 7, 15, 31):
        bench.write("controlword", word)
    samples: list[Sample] = []
    rest = SETTLED_MS
    while rest and len(samples) < LONGEST_MS:
        bench.tick()
        values = bench.node.axes[0].values
        samples.append(Sample(values.velocity_actual_value, bench.simulations[0].shaft))
        if values.statusword & 0x0400:
            rest -= 1
    return samples


# ---- drawing ---------------------------------------------------------------------------------------------------------


class Panel(NamedTuple):
    """A diagram over time: `top` in pixels, and what it shows."""

    top: int
    label: str
    values: Sequence[int]
    marks: Mapping[str, int]

    def lines(self) -> Iterable[str]:
        low, high = min(*self.values, *self.marks.values(), 0), max(*self.values, *self.marks.values(), 0)
        milliseconds = len(self.values)

        def at(value: int) -> float:
            return round(self.top + HEIGHT - (value - low) * HEIGHT / (high - low or 1), 1)

        yield f'<rect x="{LEFT}" y="{self.top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#999"/>'
        yield f'<text x="{LEFT}" y="{self.top - 6}">{self.label}</text>'
        for name, value in self.marks.items():
            y = at(value)
            yield f'<line x1="{LEFT}" x2="{LEFT + WIDTH}" y1="{y}" y2="{y}" stroke="#bbb" stroke-dasharray="4 3"/>'
            yield f'<text x="{LEFT + WIDTH + 6}" y="{y + 4}">{name}</text>'
            yield f'<text x="{LEFT - 6}" y="{y + 4}" text-anchor="end">{value}</text>'
        step = -(-milliseconds // MANY)
        chosen = [*range(0, milliseconds, step), milliseconds - 1]
        points = " ".join(f"{round(LEFT + n * WIDTH / milliseconds, 1)},{at(self.values[n])}" for n in chosen)
        yield f'<polyline points="{points}" fill="none" stroke="#05c" stroke-width="1.5"/>'


def draw(drawing: Drawing, samples: Sequence[Sample]) -> str:
    """The picture as SVG."""
    velocities = [sample.velocity for sample in samples]
    positions = [sample.position for sample in samples]
    second = TOP + HEIGHT + GAP
    directions = {name: -value for name, value in drawing.marks.items() if min(velocities) < 0}
    marks = dict(drawing.marks) | {f"-{name}": value for name, value in directions.items()}
    panels = (
        Panel(TOP, "velocity in microsteps per second", velocities, marks),
        Panel(second, "position of the shaft in microsteps", positions, drawing.places),
    )
    width, height = LEFT + WIDTH + RIGHT, second + HEIGHT + BOTTOM
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}"',
        ' font-family="sans-serif" font-size="11">',
        f"<title>{drawing.title}</title>",
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *(line for panel in panels for line in panel.lines()),
        f'<text x="{LEFT + WIDTH}" y="{height - 16}" text-anchor="end">{len(samples)} ms</text>',
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def main(folder: Path) -> None:
    for drawing in DRAWINGS:
        (folder / f"{drawing.name}.svg").write_text(draw(drawing, record(drawing)), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
