"""What the end of a turn has to look at; the twin of a part of `ods/node.h`."""

from __future__ import annotations

from enum import IntFlag


class Work(IntFlag):
    EMCY = 1  # an emergency is queued, or may leave now
    HEARTBEAT = 2
    TPDO = 4  # a TPDO is due, or a value that one may carry has changed
    OUTPUT = 8  # an LED or an output may have changed
    ERROR_BEHAVIOUR = 16  # 1029h: the NMT state follows an error
