"""What the model says of the entries of a dictionary, as bytes on the bus."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.canopen_types import DataType
from odsmith.model import Device, Entry, ExpandedEntry


def entries(device: Device) -> Iterator[ExpandedEntry]:
    for obj in device.expanded:
        yield from obj.entries


def writable(device: Device) -> Iterator[ExpandedEntry]:
    return (item for item in entries(device) if item.entry.access.writable)


def places(device: Device, effect: str) -> list[tuple[int, int]]:
    """Index and sub-index of all entries with an effect."""
    return [(item.index, item.entry.sub) for item in entries(device) if item.entry.effect == effect]


def role(device: Device, name: str) -> tuple[int, int]:
    """Where the value is that the runtimes know under this name."""
    return next((item.index, item.entry.sub) for item in entries(device) if item.entry.role == name)


def code(device: Device, name: str) -> int:
    return next(abort.code for abort in device.abort_codes if abort.name == name)


def size(entry: Entry) -> int:
    """Octets on the bus; for strings the most."""
    return (entry.bit_length + 7) // 8


def encode(entry: Entry, value: int) -> bytes:
    return value.to_bytes(size(entry), "little", signed=value < 0)


def power_on_value(item: ExpandedEntry, node_id: int, serial: int = 0) -> bytes:
    """What an entry reads as after power-on with an erased memory; some values are the runtime's to know."""
    known = {
        "serial_number": serial,
        "node_id_load": node_id,
        "node_id": node_id,
        "can_bit_rate_load": 1000,
        "statusword": 0x0250,  # switch on disabled, supply and enable input are there, not TMCL mode
    }
    entry = item.entry
    if entry.type is DataType.VISIBLE_STRING:
        assert item.default
        assert item.default.text is not None
        return item.default.text.encode()
    if not entry.type.integer:
        return bytes(entry.length)
    value = item.default.value(node_id) if item.default else 0
    assert isinstance(value, int)
    return encode(entry, known.get(entry.role, value))
