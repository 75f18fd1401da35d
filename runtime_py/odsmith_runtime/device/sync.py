"""The SYNC consumer (CiA 301, 7.2.5); the twin of `ods_sync.c`. The node never produces SYNC."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode

from . import can_id

if TYPE_CHECKING:
    from .node import Node


def is_sync(node: Node, identifier: int) -> bool:
    """Whether a frame with this CAN-ID is the SYNC of the node."""
    return "sync" in node.services and node.values.cob_id_sync & can_id.MASK == identifier


def check_cob_id(cob_id: int) -> int:
    """Whether 1005h may be so: 0 or an abort code."""
    if cob_id & (can_id.RESERVED | can_id.GENERATE) or can_id.is_restricted(cob_id & can_id.MASK):
        return AbortCode.INVALID_VALUE
    return 0
