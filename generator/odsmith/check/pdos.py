"""Checks of the default PDOs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from odsmith.check.dictionary import label
from odsmith.check.places import Places
from odsmith.errors import Diagnostic
from odsmith.model import Device, Pdo
from odsmith.rules import diagnose

PDO_BITS = 64
"""A PDO carries 8 bytes (CiA 301, clause 7.5.2.36)."""


def check_pdos(device: Device, places: Places) -> Iterator[Diagnostic]:
    for pdo in device.pdos:
        yield from _mapping(device, pdo, places)
    active = Counter(pdo.cob_id for pdo in device.pdos if not pdo.cob_id.number & 0x80000000)
    for pdo in device.pdos:
        if active[pdo.cob_id] > 1:
            yield diagnose(
                "W501", places.of_pdo(pdo, "cob_id"), f"{_name(pdo)} shares its CAN-ID with another active PDO"
            )


def _name(pdo: Pdo) -> str:
    return f"{pdo.kind.upper()} {pdo.number}"


def _mapping(device: Device, pdo: Pdo, places: Places) -> Iterator[Diagnostic]:
    place = places.of_pdo(pdo, "map")
    bits = sum(item.entry.bit_length for item in pdo.map)
    if bits > PDO_BITS:
        listed = " + ".join(str(item.entry.bit_length) for item in pdo.map)
        yield diagnose(
            "E431", place, f"{_name(pdo)} maps {listed} = {bits} bits, a PDO holds {PDO_BITS}", "map fewer objects"
        )
    if len(pdo.map) > device.max_pdo_entries:
        yield diagnose(
            "E432",
            place,
            f"{_name(pdo)} maps {len(pdo.map)} entries, the device allows {device.max_pdo_entries}",
            "map fewer objects, or raise `pdos.max_entries`",
        )
    for item in pdo.map:
        mapping = item.entry.mapping
        if not (mapping.receivable if pdo.kind == "rpdo" else mapping.transmittable):
            needed = "rx" if pdo.kind == "rpdo" else "tx"
            yield diagnose(
                "E433",
                place,
                f"{_name(pdo)} maps {label(item.object, item.entry)}, which is not mappable there",
                f"add `mapping: {needed}` to the object, or map another one",
                notes=((item.entry.place, f"its mapping is `{mapping}`"),),
            )
