"""What writing an entry does: from its effect to the module that obeys it; the twin of `ods_effect.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode, Signature
from odsmith_cia.words import Effect

from . import emcy, sync
from .work import Work

if TYPE_CHECKING:
    from .node import Node
    from .od import Cell


def check_state(node: Node, cell: Cell) -> int:
    """Whether the present state of the device forbids the write: 0 or an abort code."""
    match cell.entry.effect:
        case Effect.PDO_MAPPED_COUNT:
            return node.pdo.check_count_state(cell.instance)
        case Effect.PDO_MAPPING:
            return node.pdo.check_mapping_state(cell.instance)
        case Effect.OS_COMMAND:
            return 0 if node.values.tmcl_mode else AbortCode.DEVICE_STATE
    return 0


def check(node: Node, cell: Cell, number: int) -> tuple[int, int]:
    """Whether the effect refuses a number that is in range: 0 or an abort code; and what will be read back.

    A command is carried out here, since it may fail.
    """
    instance, sub = cell.instance, cell.entry.sub
    match cell.entry.effect:
        case Effect.COB_ID_SYNC:
            return sync.check_cob_id(number), number
        case Effect.COB_ID_EMCY:
            return emcy.check_cob_id(number), number
        case Effect.CONSUMER_HEARTBEAT:
            return node.heartbeat.check_consumer(sub, number), number
        case Effect.PDO_COB_ID:
            return node.pdo.check_cob_id(instance, number), number
        case Effect.PDO_MAPPED_COUNT:
            return node.pdo.check_count(instance, number), number
        case Effect.PDO_MAPPING:
            return node.pdo.check_mapping(instance, sub, number), number
        case Effect.STORE:
            return node.store.save(cell.entry), number
        case Effect.RESTORE:
            return node.store.restore(cell.entry), number
        case Effect.TMCL_MODE | Effect.MANUFACTURER_MODE:
            return 0, int(number == Signature.MAKE)
    return 0, number


def apply(node: Node, cell: Cell) -> None:
    """The value is in place."""
    axis = cell.instance.axis
    if axis is not None:
        node.axes[axis].written(cell)
        return
    match cell.entry.effect:
        case Effect.GUARD_TIME:
            node.heartbeat.guard_written()
        case Effect.COB_ID_EMCY:
            node.work |= Work.EMCY
        case Effect.CONSUMER_HEARTBEAT:
            node.heartbeat.consumer_written(cell.entry.sub)
        case Effect.PRODUCER_HEARTBEAT:
            node.heartbeat.producer_written()
        case Effect.PDO_COB_ID:
            node.pdo.cob_id_written(cell.instance)
        case Effect.PDO_MAPPED_COUNT | Effect.PDO_MAPPING:
            node.pdo.mapping_written(cell.instance, cell.entry.sub)
        case Effect.PDO_PARAMETER:
            node.pdo.parameter_written(cell.instance, cell.entry.sub)
        case Effect.OS_COMMAND:
            node.os_command.run()
        case Effect.TMCL_MODE:
            node.update_axes()
        case Effect.DIGITAL_OUTPUTS | Effect.OUTPUT_MASK | Effect.ANALOG_OUTPUTS:
            node.work |= Work.OUTPUT
