"""Turn at a velocity and stop: the worked example of the manual for profile velocity mode (section 7.2)."""

from __future__ import annotations

from tmcm6212 import TMCM6212

from connection import arguments


def main(drive: TMCM6212) -> None:
    x = drive.axes[0]
    x.switch_parameters.raw = 3  # no limit switches are connected
    x.profile_acceleration.raw = 100_000
    x.enable()
    x.run(100_000)
    print(f"axis 0 turns at {x.velocity()} pps, {float(x.velocity_in('rev/s')):.3f} revolutions per second")
    x.run(-1, unit="rev/s")
    print(f"axis 0 turns at {x.velocity()} pps")
    x.stop()
    x.disable()


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
