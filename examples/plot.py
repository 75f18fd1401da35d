"""Record a move by PDO and plot it, if matplotlib is installed: `python examples/plot.py`, then look at move.png."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from tmcm6212 import TMCM6212

from connection import arguments
from odsmith_runtime.client import Rpdo, Tpdo

PERIOD = 0.010


class Sample(NamedTuple):
    time: float  # seconds
    position: int  # microsteps
    velocity: int  # pps


def record(drive: TMCM6212) -> list[Sample]:
    """A move over two revolutions, with a sample every 10 ms."""
    x = drive.axes[0]
    x.switch_parameters.raw = 3  # no limit switches are connected
    x.profile_velocity.raw = 80_000
    x.profile_acceleration.raw = 100_000
    x.profile_deceleration.raw = 200_000
    drive.configure_pdos(
        [
            Rpdo(x.controlword, x.target_position),
            Tpdo(x.statusword),
            Tpdo(x.position_actual_value, x.velocity_actual_value, on_sync=1),
        ]
    )
    x.enable()
    x.move_to(2, unit="revolutions", wait=False)
    samples = [Sample(0.0, x.position(), x.velocity())]
    while len(samples) < 3 or samples[-1].velocity:
        drive.pause(PERIOD)
        samples.append(Sample(len(samples) * PERIOD, x.position(), x.velocity()))
    x.disable()
    return samples


def fingerprint(samples: Sequence[Sample]) -> str:
    """The same for the same samples; a picture carries it, so that one can tell what it shows."""
    return sha256(repr([tuple(sample) for sample in samples]).encode()).hexdigest()


def draw(samples: Sequence[Sample], path: Path) -> None:
    """Position and velocity over time, as a PNG."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8, 4.5), layout="constrained")
    position, velocity = figure.subplots(2, 1, sharex=True)
    position.plot([sample.time for sample in samples], [sample.position for sample in samples])
    position.set_ylabel("position in microsteps")
    velocity.plot([sample.time for sample in samples], [sample.velocity for sample in samples])
    velocity.set_ylabel("velocity in pps")
    velocity.set_xlabel("time in s")
    figure.savefig(path, metadata={"Comment": fingerprint(samples)})


def main(drive: TMCM6212, path: Path = Path("move.png")) -> None:
    samples = record(drive)
    print(f"{len(samples)} samples, the last one: {samples[-1]}")
    try:
        draw(samples, path)
        print(f"{path} shows them")
    except ImportError:
        print("pip install matplotlib, and there will be a picture")


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
