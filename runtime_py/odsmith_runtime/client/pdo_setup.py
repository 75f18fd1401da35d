"""Writing PDO parameters in the order that CiA 301, clause 7.5.2.36, asks for: off, empty, filled, on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .pdo_plan import EVENT_DRIVEN

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from ..pdos import Pdo
    from .access import Access
    from .pdo_plan import Place

OFF = 1 << 31
NO_RTR = 1 << 30
_COUNT = 0
_COB_ID, _TYPE, _INHIBIT, _TIMER = 1, 2, 3, 5


async def switch_off(access: Access, record: Pdo) -> None:
    """Take a PDO out of use, if it is in use."""
    cob_id = record.communication[_COB_ID]
    value = int(await access.read(cob_id))
    if not value & OFF:
        await access.write(cob_id, value | OFF)


async def set_up(access: Access, each: Place) -> None:
    """Make a PDO what the plan says."""
    mapped = each.mapped
    communication = {_COB_ID: each.can_id | NO_RTR, _TYPE: mapped.on_sync or EVENT_DRIVEN}
    if mapped.kind == "tpdo":
        communication[_INHIBIT] = round(mapped.inhibit_time * 10_000)
        communication[_TIMER] = round(mapped.event_timer * 1000)
    entries = (entry.index << 16 | entry.sub << 8 | entry.bit_length for entry in mapped.entries)
    await write_record(access, each.record, communication, tuple(entries))


async def write_record(access: Access, record: Pdo, communication: Mapping[int, int], mapped: Iterable[int]) -> None:
    """Write a whole PDO: communication parameters by sub-index, and what it maps."""
    cob_id = record.communication[_COB_ID]
    await access.write(cob_id, communication[_COB_ID] | OFF)
    await access.write(record.mapping[_COUNT], 0)
    count = 0
    for count, entry in enumerate(mapped, start=1):
        await access.write(record.mapping[count], entry)
    await access.write(record.mapping[_COUNT], count)
    for sub in (_TYPE, _INHIBIT, _TIMER):
        if sub in communication:
            await access.write(record.communication[sub], communication[sub])
    if not communication[_COB_ID] & OFF:
        await access.write(cob_id, communication[_COB_ID])
