"""Home on the home switch: the worked example of the manual for homing mode (section 8.3).

A virtual drive wants its switch to be somewhere: `odsmith inject axis0 home_from 20000`, then `home_to 30000`.
"""

from __future__ import annotations

from tmcm6212 import TMCM6212, HomingMethod

from connection import arguments
from odsmith_runtime.client import MotionError


def main(drive: TMCM6212) -> None:
    x = drive.axes[0]
    x.switch_parameters.raw = 3  # limit switches are not used, the home switch is
    x.homing_speeds.fast.raw = 50_000
    x.homing_speeds.slow.raw = 10_000
    x.homing_acceleration.raw = 512_000
    x.enable()
    try:
        x.home(HomingMethod.POSITIVE_HOME_SWITCH, timeout=20)
        print(f"axis 0 found its home and is at {x.position()}")
    except MotionError as error:
        print(error)
    x.stop()
    x.disable()


if __name__ == "__main__":
    with TMCM6212.connect(**arguments()) as drive:
        main(drive)
