"""Two axes draw a square: both start together, the next side begins when both have arrived."""

from __future__ import annotations

from tmcm6212 import TMCM6212

from connection import arguments

CORNERS = ((20_000, 0), (20_000, 20_000), (0, 20_000), (0, 0))


def main(drive: TMCM6212) -> None:
    x, y = drive.axes[:2]
    for axis in (x, y):
        axis.switch_parameters.raw = 3  # no limit switches are connected
        axis.profile_velocity.raw = 100_000
        axis.profile_acceleration.raw = 400_000
        axis.profile_deceleration.raw = 400_000
        axis.enable()
    for across, up in CORNERS:
        x.move_to(across, wait=False)
        y.move_to(up, wait=False)
        drive.wait(0, 1, timeout=10)
        print(f"({x.position()}, {y.position()})")
    x.disable()
    y.disable()


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
