"""PDOs: their parameters, and data on its way in and out (CiA 301, 7.2.2, 7.5.2.35 to 7.5.2.38).

The twin of `ods_pdo.c`. A PDO is known by its ordinal, counted from 0 over all axes. Mappings are resolved once, when
they come into force.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.codes import AbortCode
from odsmith_cia.words import Condition

from .. import codec
from . import access, can_id
from .od import Cell
from .port import Frame
from .timing import MASK, US_PER_100US, US_PER_MS, before
from .work import Work

if TYPE_CHECKING:
    from odsmith_cia.values import PdoValues

    from .node import Node
    from .od import Instance

_MAX_BITS = 64
_SYNCHRONOUS = range(1, 241)  # transmission types

# Sub-indices of a communication parameter record.
_TRANSMISSION_TYPE = 2
_INHIBIT_TIME = 3

_LONG_AGO_US = 0x10000000
"""A transmission that is longer ago no longer inhibits, and its instant would soon be ambiguous."""


class _Pdo:
    def __init__(self, instance: Instance) -> None:
        self.instance = instance
        self.values: PdoValues = instance.values
        self.mapped: list[Cell] = []  # entries in force; none while the PDO is inactive
        self.length = 0  # octets of its frame
        self.syncs = 0  # SYNCs since the last application or transmission

    @property
    def is_active(self) -> bool:
        return not self.values.pdo_cob_id & can_id.INVALID

    @property
    def is_synchronous(self) -> bool:
        return self.values.pdo_transmission_type in _SYNCHRONOUS

    @property
    def can_id(self) -> int:
        return self.values.pdo_cob_id & can_id.MASK

    def counts_sync(self) -> bool:
        """Whether this SYNC is the one that the PDO waits for."""
        if not self.mapped or not self.is_synchronous:
            return False
        self.syncs += 1
        if self.syncs < self.values.pdo_transmission_type:
            return False
        self.syncs = 0
        return True


class _Rpdo(_Pdo):
    def __init__(self, instance: Instance) -> None:
        super().__init__(instance)
        self.held: bytes | None = None  # the newest frame, until its SYNC comes

    def start(self) -> None:
        self.held = None
        self.syncs = 0


class _Tpdo(_Pdo):
    def __init__(self, instance: Instance) -> None:
        super().__init__(instance)
        self.watched: set[Instance] = set()  # instances that it carries values of
        self.event_at: int | None = None  # its event timer runs out
        self.sent_at: int | None = None  # its last transmission, unless that is long ago
        self.image = b""  # as last sent
        self.due = False  # has to be sent, changed or not
        self.pending = False  # waits for the end of its inhibit time

    def inhibited_until(self, now: int) -> int | None:
        """Until when it has to wait; None if it need not."""
        if self.sent_at is None:
            return None
        until = self.sent_at + self.values.pdo_inhibit_time * US_PER_100US & MASK
        return until if before(now, until) else None


class Pdos:
    def __init__(self, node: Node, max_mapped: int) -> None:
        self._node = node
        self._max_mapped = max_mapped
        instances = node.od.instances
        self._rpdos = [_Rpdo(instance) for instance in instances if instance.kind == "rpdo"]
        self._tpdos = [_Tpdo(instance) for instance in instances if instance.kind == "tpdo"]

    # ---- parameters: 0 or an abort code ------------------------------------------------------------------------------

    def check_count_state(self, instance: Instance) -> int:
        if self._node.values.manufacturer_mode or not self._pdo(instance).is_active:
            return 0
        return AbortCode.DEVICE_STATE

    def check_mapping_state(self, instance: Instance) -> int:
        if not self._node.values.manufacturer_mode and self._pdo(instance).values.pdo_mapped_count:
            return AbortCode.DEVICE_STATE
        return self.check_count_state(instance)

    def check_cob_id(self, instance: Instance, cob_id: int) -> int:
        pdo = self._pdo(instance)
        if cob_id & can_id.RESERVED:
            return AbortCode.INVALID_VALUE
        if cob_id & can_id.INVALID:
            return 0
        if not cob_id & can_id.NO_REMOTE and not self._node.values.manufacturer_mode:
            return AbortCode.INVALID_VALUE
        if can_id.is_restricted(cob_id & can_id.MASK):
            return AbortCode.INVALID_VALUE
        moves = cob_id & can_id.MASK != pdo.can_id
        return AbortCode.INVALID_VALUE if pdo.is_active and moves else 0

    def check_count(self, instance: Instance, count: int) -> int:
        if count > self._max_mapped:
            return AbortCode.PDO_LENGTH
        return self._check_entries(instance, self._pdo(instance).values.pdo_mapping[:count])

    def check_mapping(self, instance: Instance, sub: int, mapping: int) -> int:
        values = self._pdo(instance).values
        if sub <= values.pdo_mapped_count:  # in force, which manufacturer mode allows
            entries = values.pdo_mapping[: values.pdo_mapped_count]
            entries[sub - 1] = mapping
            return self._check_entries(instance, entries)
        found = self._resolve(instance, mapping) if mapping else 0
        return found if isinstance(found, int) else 0

    def _check_entries(self, instance: Instance, entries: list[int]) -> int:
        """Whether entries can be in force together."""
        for entry in entries:
            found = self._resolve(instance, entry)
            if isinstance(found, int):
                return found
        return AbortCode.PDO_LENGTH if sum(entry & 0xFF for entry in entries) > _MAX_BITS else 0

    def _resolve(self, instance: Instance, mapping: int) -> Cell | int:
        """What a mapping entry names, if a PDO of this direction may carry it; else an abort code."""
        cell = self._node.od.find(mapping >> 16, mapping >> 8 & 0xFF)
        if not isinstance(cell, Cell):
            return cell
        fits = cell.entry.transmittable if instance.kind == "tpdo" else cell.entry.receivable
        if not fits or not cell.is_number or codec.bits(cell.entry.type) != mapping & 0xFF:
            return AbortCode.NOT_MAPPABLE
        return cell

    # ---- coming into force -------------------------------------------------------------------------------------------

    def reset(self) -> None:
        """All parameters are new: after a reset."""
        for tpdo in self._tpdos:
            tpdo.sent_at = None
        for pdo in (*self._rpdos, *self._tpdos):
            self._activate(pdo)

    def start(self) -> None:
        """OPERATIONAL begins."""
        for rpdo in self._rpdos:
            rpdo.start()
        for tpdo in self._tpdos:
            self._start_tpdo(tpdo)

    def cob_id_written(self, instance: Instance) -> None:
        """The COB-ID of a PDO was written: it starts, stops or goes on."""
        pdo = self._pdo(instance)
        if not pdo.mapped or not pdo.is_active:
            self._activate(pdo)  # else nothing but bit 30 can have changed: it goes on

    def mapping_written(self, instance: Instance, sub: int) -> None:
        """A mapping entry or (sub-index 0) their number was written. What is in force now starts afresh."""
        pdo = self._pdo(instance)
        if sub <= pdo.values.pdo_mapped_count:
            self._activate(pdo)  # else it stands behind the entries in force

    def parameter_written(self, instance: Instance, sub: int) -> None:
        """A parameter was written that is in force at any time."""
        pdo = self._pdo(instance)
        if isinstance(pdo, _Rpdo):
            pdo.start()
        elif isinstance(pdo, _Tpdo):
            if sub == _TRANSMISSION_TYPE:
                pdo.syncs = 0
            if sub != _INHIBIT_TIME:
                self._start_event_timer(pdo)
            pdo.pending = True  # have another look
            self._node.work |= Work.TPDO

    def _activate(self, pdo: _Pdo) -> None:
        """COB-ID or mapping of a PDO changed: it starts afresh, if it is active."""
        pdo.mapped = self._mapped_cells(pdo)
        pdo.length = (sum(codec.bits(cell.entry.type) for cell in pdo.mapped) + 7) // 8
        if isinstance(pdo, _Tpdo):
            pdo.watched = {cell.instance for cell in pdo.mapped}
            self._start_tpdo(pdo)
        elif isinstance(pdo, _Rpdo):
            pdo.start()

    def _mapped_cells(self, pdo: _Pdo) -> list[Cell]:
        """Stored parameters are no exception: what does not resolve is not in force."""
        count = pdo.values.pdo_mapped_count
        entries = pdo.values.pdo_mapping[:count]
        if not pdo.is_active or count > self._max_mapped or self._check_entries(pdo.instance, entries):
            return []
        found = (self._resolve(pdo.instance, entry) for entry in entries)
        return [cell for cell in found if isinstance(cell, Cell)]

    def _start_tpdo(self, tpdo: _Tpdo) -> None:
        """A TPDO begins its work: it is sent once, whatever it carries."""
        tpdo.syncs = 0
        tpdo.due, tpdo.pending = True, False  # the inhibit time goes on
        self._start_event_timer(tpdo)
        self._node.work |= Work.TPDO

    def _start_event_timer(self, tpdo: _Tpdo) -> None:
        tpdo.event_at = None
        if tpdo.values.pdo_event_timer and not tpdo.is_synchronous and self._is_operational:
            tpdo.event_at = self._node.timers.now + tpdo.values.pdo_event_timer * US_PER_MS & MASK

    # ---- data in -----------------------------------------------------------------------------------------------------

    def receive(self, frame: Frame) -> None:
        """A frame that may be one or several RPDOs."""
        for rpdo in self._rpdos:
            if not rpdo.mapped or rpdo.can_id != frame.id:
                continue
            if len(frame.data) != rpdo.length:
                short = len(frame.data) < rpdo.length
                self._node.emcy.raise_(Condition.PDO_TOO_SHORT if short else Condition.PDO_TOO_LONG)
            elif rpdo.is_synchronous:
                rpdo.held = frame.data
            else:
                self._apply(rpdo, frame.data)

    def _apply(self, rpdo: _Rpdo, data: bytes) -> None:
        """Write what a frame carries, entry by entry; the first one that is refused ends it."""
        bits = int.from_bytes(data, "little")
        for cell in rpdo.mapped:
            length = codec.bits(cell.entry.type)
            octets = (bits & (1 << length) - 1).to_bytes(cell.size, "little")
            bits >>= length
            if access.write(self._node, cell, octets):
                self._node.emcy.raise_(Condition.PARAMETER_REFUSED)
                return

    # ---- data out ----------------------------------------------------------------------------------------------------

    def sync(self) -> None:
        """A SYNC came."""
        if not self._is_operational:
            return
        for tpdo in self._tpdos:
            if tpdo.counts_sync():
                self._send(tpdo, self._sample(tpdo))
        for rpdo in self._rpdos:
            if rpdo.counts_sync() and rpdo.held is not None:
                held, rpdo.held = rpdo.held, None
                self._apply(rpdo, held)

    def earliest(self, at: int) -> int:
        """The earliest instant at which a TPDO becomes due, or `at` if that is earlier."""
        if not self._is_operational:
            return at
        now = self._node.timers.now
        for tpdo in self._tpdos:
            if not tpdo.mapped:
                continue
            if tpdo.event_at is not None and before(tpdo.event_at, at):
                at = tpdo.event_at
            if (tpdo.due or tpdo.pending) and not tpdo.is_synchronous:
                until = tpdo.inhibited_until(now)
                if until is not None and before(until, at):
                    at = until
        return at

    def expire(self) -> None:
        """Event timers and inhibit times that end now."""
        now = self._node.timers.now
        for tpdo in self._tpdos:
            if tpdo.event_at is not None and not before(now, tpdo.event_at):
                tpdo.event_at = None
                tpdo.due = True
            if tpdo.sent_at is not None and now - tpdo.sent_at & MASK >= _LONG_AGO_US:
                tpdo.sent_at = None
            if tpdo.due or tpdo.pending:
                self._node.work |= Work.TPDO

    def transmit(self) -> None:
        """Send what is due, in ascending order."""
        node = self._node
        if not self._is_operational or node.can.is_off:
            return
        for tpdo in self._tpdos:
            concerned = tpdo.due or tpdo.pending or not tpdo.watched.isdisjoint(node.changed)
            if not tpdo.mapped or tpdo.is_synchronous or not concerned:
                continue
            image = self._sample(tpdo)
            is_new = tpdo.due or image != tpdo.image
            if tpdo.inhibited_until(node.timers.now) is not None:
                tpdo.pending |= is_new
            elif is_new:
                self._send(tpdo, image)
            else:
                tpdo.pending = False
        node.changed.clear()

    def _sample(self, tpdo: _Tpdo) -> bytes:
        """The present values of what a TPDO carries."""
        bits = shift = 0
        for cell in tpdo.mapped:
            length = codec.bits(cell.entry.type)
            bits |= (int.from_bytes(cell.octets, "little") & (1 << length) - 1) << shift
            shift += length
        return bits.to_bytes(tpdo.length, "little")

    def _send(self, tpdo: _Tpdo, image: bytes) -> None:
        tpdo.image = image
        tpdo.due = tpdo.pending = False
        tpdo.sent_at = self._node.timers.now
        self._start_event_timer(tpdo)
        self._node.send(Frame(tpdo.can_id, image))

    def _pdo(self, instance: Instance) -> _Pdo:
        pdos: list[_Rpdo] | list[_Tpdo] = self._tpdos if instance.kind == "tpdo" else self._rpdos
        return pdos[instance.ordinal]

    @property
    def _is_operational(self) -> bool:
        return "pdo" in self._node.services
