"""Stored values (1010h, 1011h): one record, two banks of non-volatile memory; the twin of `ods_store.c`.

A record is written to the bank that is not in force. Its header comes last, so that at any loss of power one whole
record remains. All numbers are little-endian:

    header   layout hash of the dictionary (32 bits), sequence number (16), octets of the payload (16), CRC-32 of these
             8 octets and the payload
    payload  storage groups that hold values: 16 bits for the device, then for each axis, bit 1 << (group - 1)
             the values, instance by instance, in each by index and sub-index; those of other groups are 0
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.codes import AbortCode

from .port import MemoryFailure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..entries import Entry
    from .node import Node
    from .od import Cell, Instance

_HEADER = 12
_BANKS = 2


class _Record(NamedTuple):
    bank: int
    sequence: int


class Store:
    def __init__(self, node: Node, layout: int, groups: Sequence[str]) -> None:
        self._node = node
        self._layout = layout
        self._groups = {name: 1 << n for n, name in enumerate(groups)}
        self._cells = [
            cell for instance in node.od.instances for cell in instance.cells if cell.entry.stored != "never"
        ]
        self._owners = 1 + len(node.od.axes)
        self._payload = 2 * self._owners + sum(cell.size for cell in self._cells)
        self._record: _Record | None = None

    @property
    def size(self) -> int:
        """Octets of non-volatile memory that the device uses."""
        return _BANKS * (_HEADER + self._payload)

    # ---- reading ---------------------------------------------------------------------------------------------------

    def load(self, *, communication_only: bool) -> None:
        """Find the record in force and take its values over: all of them, or those of 1000h to 1FFFh."""
        with suppress(MemoryFailure):  # what cannot be read is not in force
            self._find_record()
        payload = self._read_payload()
        at = 2 * self._owners
        for cell in self._cells:
            octets = payload[at : at + cell.size]
            at += cell.size
            wanted = not communication_only or 0x1000 <= cell.entry.index < 0x2000
            if wanted and self._is_stored(payload, cell) and self._in_range(cell, octets):
                cell.write(octets)

    def _find_record(self) -> None:
        """The newest valid record is in force; sequence numbers are compared as they wrap.

        Raises MemoryFailure, but not before the banks that can be read have been looked at.
        """
        self._record = None
        failure: MemoryFailure | None = None
        for bank in range(_BANKS):
            try:
                sequence = self._valid_sequence(bank)
            except MemoryFailure as error:
                failure = error
                continue
            newest: _Record | None = self._record
            if sequence is not None and (newest is None or 0 < (sequence - newest.sequence & 0xFFFF) < 0x8000):
                self._record = _Record(bank, sequence)
        if failure:
            raise failure

    def _valid_sequence(self, bank: int) -> int | None:
        header = self._read(self._address(bank), _HEADER)
        if self._number(header, 0, 4) != self._layout or self._number(header, 6, 2) != self._payload:
            return None
        payload = self._read(self._address(bank) + _HEADER, self._payload)
        if zlib.crc32(header[:8] + payload) != self._number(header, 8, 4):
            return None
        return self._number(header, 4, 2)

    def _read_payload(self) -> bytes:
        """That of the record in force; without one, that of a record that holds nothing."""
        if self._record is None:
            return bytes(self._payload)
        return self._read(self._address(self._record.bank) + _HEADER, self._payload)

    def _is_stored(self, payload: bytes, cell: Cell) -> bool:
        return bool(self._number(payload, 2 * _owner_of(cell.instance), 2) & self._groups[cell.entry.stored])

    @staticmethod
    def _in_range(cell: Cell, octets: bytes) -> bool:
        """A value that is no longer in its range keeps its default."""
        return not cell.is_number or cell.check(cell.number(octets)) == 0

    # ---- writing ---------------------------------------------------------------------------------------------------

    def save(self, command: Entry[object]) -> int:
        """What writing the signature to 1010h does: 0, or the abort code of a memory that fails."""
        return self._change(command, save=True)

    def restore(self, command: Entry[object]) -> int:
        """What writing the signature to 1011h does: 0, or the abort code of a memory that fails."""
        return self._change(command, save=False)

    def _change(self, command: Entry[object], *, save: bool) -> int:
        if not command.groups:
            return 0
        try:
            if self._record is None:
                self._find_record()  # perhaps it could not be read before
            if save or self._record is not None:  # without a record the defaults are in force already
                self._write_record(command, save)
        except MemoryFailure:
            return AbortCode.HARDWARE
        return 0

    def _write_record(self, command: Entry[object], save: bool) -> None:
        old = self._read_payload()
        wanted = sum(self._groups[name] for name in command.groups)
        only_owner = 1 + command.repeat if command.per_axis else None

        def concerned(owner: int) -> int:
            return wanted if only_owner in (None, owner) else 0

        payload = b"".join(
            self._new_groups(old, owner, concerned(owner), save).to_bytes(2, "little") for owner in range(self._owners)
        )
        for cell in self._cells:
            kept = old[len(payload) : len(payload) + cell.size]
            if concerned(_owner_of(cell.instance)) & self._groups[cell.entry.stored]:
                kept = cell.octets.ljust(cell.size, b"\0") if save else bytes(cell.size)
            elif not self._is_stored(old, cell):
                kept = bytes(cell.size)
            payload += kept
        bank = 1 if self._record and self._record.bank == 0 else 0
        sequence = (self._record.sequence if self._record else 0) + 1 & 0xFFFF
        header = (
            self._layout.to_bytes(4, "little") + sequence.to_bytes(2, "little") + self._payload.to_bytes(2, "little")
        )
        header += zlib.crc32(header + payload).to_bytes(4, "little")
        self._write(self._address(bank) + _HEADER, payload)
        self._write(self._address(bank), header)
        self._record = _Record(bank, sequence)

    def _new_groups(self, old: bytes, owner: int, concerned: int, save: bool) -> int:
        """The groups of an owner that the new record holds: none that it has no values of."""
        owned = 0
        for cell in self._cells:
            if _owner_of(cell.instance) == owner:
                owned |= self._groups[cell.entry.stored]
        stored = self._number(old, 2 * owner, 2)
        return stored | concerned & owned if save else stored & ~(concerned & owned)

    # ---- memory ----------------------------------------------------------------------------------------------------

    def _address(self, bank: int) -> int:
        return bank * (_HEADER + self._payload)

    def _read(self, address: int, length: int) -> bytes:
        return bytes(self._node.port.nvm_read(address + n) for n in range(length))

    def _write(self, address: int, octets: bytes) -> None:
        for n, octet in enumerate(octets):
            self._node.port.nvm_write(address + n, octet)

    @staticmethod
    def _number(octets: bytes, at: int, length: int) -> int:
        return int.from_bytes(octets[at : at + length], "little")


def _owner_of(instance: Instance) -> int:
    """Whose groups decide about the values of an instance: 0 the device, to which PDOs belong; 1 + n axis n."""
    return 0 if instance.axis is None else 1 + instance.axis
