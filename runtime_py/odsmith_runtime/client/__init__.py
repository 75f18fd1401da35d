"""The client: drives on a bus by the names of their objects, on top of python-canopen.

    from tmcm6212 import TMCM6212

    with TMCM6212.connect(interface="socketcan", channel="can0", node_id=1) as drive:
        x = drive.axes[0]
        x.enable()
        x.move_to(500_000, timeout=20)

A generated package brings the classes of its device, `TMCM6212` and `AsyncTMCM6212`. Everything is written once, as
coroutines (`async_drive`, `async_axis`, ...); the blocking face runs them by a waiter that never suspends (`waiting`,
`blocking`).
"""

from __future__ import annotations

from .async_axis import AsyncAxis
from .async_drive import AsyncDrive
from .async_values import AsyncValue
from .axis import Axis
from .diagnosis import Seen
from .drive import Drive
from .errors import (
    ClientError,
    EmergencyError,
    MissingPackageError,
    MotionError,
    MotionTimeoutError,
    NoAnswerError,
    PlanError,
    SdoAborted,
    StateError,
    StateTimeoutError,
)
from .pdo_plan import BusLoad, Rpdo, Tpdo
from .scale import Scale
from .values import BitView, Value

__all__ = [
    "AsyncAxis",
    "AsyncDrive",
    "AsyncValue",
    "Axis",
    "BitView",
    "BusLoad",
    "ClientError",
    "Drive",
    "EmergencyError",
    "MissingPackageError",
    "MotionError",
    "MotionTimeoutError",
    "NoAnswerError",
    "PlanError",
    "Rpdo",
    "Scale",
    "SdoAborted",
    "Seen",
    "StateError",
    "StateTimeoutError",
    "Tpdo",
    "Value",
]
