"""CAN-IDs and COB-IDs (CiA 301, 7.3.3, 7.3.5); the twin of a part of `ods_core.h`."""

from __future__ import annotations

NMT = 0x000
SDO_ANSWER = 0x580
SDO_REQUEST = 0x600
ERROR_CONTROL = 0x700
MASK = 0x7FF
NODE_IDS = 127

INVALID = 0x80000000  # of a PDO or EMCY: it does not exist
NO_REMOTE = 0x40000000  # of a PDO
GENERATE = 0x40000000  # of SYNC
RESERVED = 0x3FFFF800  # 29 bit CAN-IDs, which no node here has

_RESTRICTED = (range(0x080), range(0x101, 0x181), range(0x581, 0x600), range(0x601, 0x680), range(0x6E0, 0x800))


def is_restricted(can_id: int) -> bool:
    """Whether no COB-ID may have this CAN-ID."""
    return any(can_id in ids for ids in _RESTRICTED)
