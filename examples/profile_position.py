"""Move to a position: the worked example of the manual for profile position mode (section 6.2)."""

from __future__ import annotations

from tmcm6212 import TMCM6212

from connection import arguments


def main(drive: TMCM6212) -> None:
    x = drive.axes[0]
    x.switch_parameters.raw = 3  # no limit switches are connected
    x.profile_velocity.raw = 51_200  # pps: one revolution per second at 256 microsteps
    x.profile_acceleration.raw = 51_200
    x.profile_deceleration.raw = 51_200
    x.enable()
    x.move_to(25_600)
    print(f"axis 0 is at {x.position()} microsteps, {float(x.position_in('revolutions'))} revolutions")
    x.disable()


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
