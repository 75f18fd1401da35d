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

from .async_axis import AsyncAxis as AsyncAxis
from .async_drive import AsyncDrive as AsyncDrive
from .async_values import AsyncValue as AsyncValue
from .axis import Axis as Axis
from .drive import Drive as Drive
from .errors import ClientError as ClientError
from .errors import EmergencyError as EmergencyError
from .errors import MissingPackageError as MissingPackageError
from .errors import MotionError as MotionError
from .errors import MotionTimeoutError as MotionTimeoutError
from .errors import NoAnswerError as NoAnswerError
from .errors import PlanError as PlanError
from .errors import SdoAborted as SdoAborted
from .errors import StateError as StateError
from .pdo_plan import BusLoad as BusLoad
from .pdo_plan import Rpdo as Rpdo
from .pdo_plan import Tpdo as Tpdo
from .scale import Scale as Scale
from .values import Value as Value
