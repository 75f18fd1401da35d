"""An axis fails, the other one goes on, the first one is repaired and goes on too.

With a virtual drive the trouble is yours to make, in another terminal: `odsmith inject axis1 overtemperature on`, and
the same with `off` to end it.
"""

from __future__ import annotations

from collections.abc import Callable

from tmcm6212 import TMCM6212

from connection import arguments
from odsmith_runtime.client import EmergencyError, StateError

SWINGS = 100


def main(drive: TMCM6212, trouble: Callable[[int], None], repair: Callable[[], None]) -> None:
    """`trouble` is called before each swing with its number, `repair` once the axis has failed."""
    x, y = drive.axes[:2]
    for axis in (x, y):
        axis.switch_parameters.raw = 3  # no limit switches are connected
        axis.profile_velocity.raw = 100_000
        axis.profile_acceleration.raw = 400_000
        axis.profile_deceleration.raw = 400_000
        axis.enable()
    try:
        for swing in range(SWINGS):
            trouble(swing)
            for axis in (x, y):
                axis.move_by(10_000 if swing % 2 == 0 else -10_000, wait=False)
            y.wait()
            x.wait()
    except (EmergencyError, StateError) as error:
        print(f"Stopped: {error}")
    else:
        print("Nothing happened.")
        return
    x.wait()
    print(f"axis 0 arrived all the same and is {x.state()}, axis 1 is in {y.state()}")
    try:
        y.enable()
    except StateError as error:
        print(f"Not yet: {error}")
    repair()
    y.reset_fault()
    y.enable()
    y.move_to(0)
    print(f"axis 1 is back, at {y.position()}")
    drive.disable()


def say(swing: int) -> None:
    if swing == 0:
        print("Now make axis 1 fail: odsmith inject axis1 overtemperature on")


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive, say, lambda: print(input("End its cause, then press Enter: ")))
