"""`odsmith explain`: what a number or a name stands for, on which axis, and where that is written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from odsmith.canopen_types import Source
from odsmith.model import Device, Emergency, Entry, ExpandedObject
from odsmith.rules import RULES

Row = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Explanation:
    """One answer: what the term is, then rows of (property, value) in reading order, then tables of the same."""

    kind: str
    title: str
    device: str
    rows: tuple[Row, ...]
    tables: tuple[tuple[str, tuple[Row, ...]], ...] = field(default=())

    def to_json(self) -> dict[str, object]:
        return {
            "kind": self.kind,
            "title": self.title,
            "device": self.device,
            "properties": dict(self.rows),
            "tables": {title: dict(rows) for title, rows in self.tables},
        }


def explain(device: Device, term: str) -> list[Explanation]:
    """Everything in a device that `term` may mean, the likeliest first; empty where it means nothing.

    A term is an index of any axis (`6840`, `0x6840`, `6840h`, `607D:1`), a name in any spelling (`TargetPosition`,
    `Controlword 2`), `EMCY 8611`, an SDO abort code, a mode, a PDS state, a homing method or an erratum.
    """
    found: list[Explanation] = []
    for search in (_objects, _emergencies, _abort_codes, _modes, _states, _homing_methods, _errata):
        found += search(device, term.strip())
    return found


def explain_rule(term: str) -> list[Explanation]:
    """The rule that a finding names, such as `E409` or `L421`; empty where there is none."""
    rule = RULES.get(term.strip().upper())
    if rule is None:
        return []
    rows = (("Severity", rule.severity), ("Why", rule.explanation), *((("Remedy", rule.hint),) if rule.hint else ()))
    return [Explanation("rule", f"{rule.id} {rule.title}", "", rows)]


def known_names(device: Device) -> list[str]:
    """Names that `explain` understands, for suggestions."""
    return [
        *(obj.name for obj in device.objects),
        *(mode.name for mode in device.modes),
        *(state.name for state in device.pds_states),
        *(row.name for row in device.emergencies),
        *(code.name for code in device.abort_codes),
    ]


def _folded(text: str) -> str:
    """Compare names without case, blanks and punctuation."""
    return re.sub(r"[^a-z0-9]", "", text.lower())


def _number(term: str, digits: str = "{1,8}") -> int | None:
    match = re.fullmatch(rf"(?:0x)?([0-9a-f]{digits})h?", term, re.IGNORECASE)
    return int(match[1], 16) if match else None


def source_text(sources: tuple[Source, ...]) -> str:
    """`manual, section 6.1.1, tables 207, 208; CiA 402, 8.4`."""
    parts = []
    for source in sources:
        if source.kind == "manual":
            section = f"section {source.section}" if source.section else ""
            places = (section, _numbered("table", source.tables), _numbered("figure", source.figures))
            parts.append(", ".join(["manual", *filter(None, places)]))
        elif source.kind == "own_manual":
            parts.append(f"own manual, section {source.section}")
        elif source.kind == "inferred":
            parts.append(f"inferred: {source.note}")
        elif source.kind == "vendor_eds":
            parts.append(f"the vendor's EDS, {source.clause}")
        else:
            parts.append(f"CiA {source.kind.removeprefix('cia')}, {source.clause}")
    return "; ".join(parts)


def _numbered(word: str, numbers: tuple[int, ...]) -> str:
    return f"{word}{'s' * (len(numbers) > 1)} {', '.join(map(str, numbers))}" if numbers else ""


def _objects(device: Device, term: str) -> Iterator[Explanation]:
    address, _, sub_text = re.sub(r"sub", ":", term, flags=re.IGNORECASE).partition(":")
    index = _number(address, "{4}")
    sub = _number(sub_text, "{1,2}") if sub_text else None
    if sub_text and sub is None:
        index = None
    wanted = _folded(term)
    for item in device.expanded:
        if index == item.index:
            if sub is None or item.object.entry(sub):
                yield _object(device, item, sub)
        elif wanted in _names(item):
            yield _object(device, item, None)


def _names(item: ExpandedObject) -> set[str]:
    """What an object answers to; a name that does not say which axis or PDO means the first one."""
    obj = item.object
    spellings = [item.parameter_name]
    if item.number:
        spellings.append(item.title)
    if not item.axis and item.number <= 1:
        spellings += [obj.name, obj.title, obj.parameter_name]
    return {_folded(spelling) for spelling in spellings}


def _object(device: Device, item: ExpandedObject, sub: int | None) -> Explanation:
    obj = item.object
    rows: list[Row] = [("Object", f"{item.index:04X}h"), ("Name", obj.name), ("EDS name", item.parameter_name)]
    if item.axis is not None:
        rows.append(("Axis", f"{item.axis} of 0..{device.axes - 1} (the EDS name counts from 1)"))
        others = (f"{obj.index + axis * obj.stride:04X}h" for axis in range(device.axes))
        if not obj.pdo:
            rows.append(("On the axes", ", ".join(others)))
    rows.append(("Object type", obj.object_type))
    tables: list[tuple[str, tuple[Row, ...]]] = []
    single = len(obj.entries) == 1
    for expanded in item.entries:
        entry = expanded.entry
        if sub not in (None, entry.sub):
            continue
        of_sub = "" if single else f" of sub-index {entry.sub:02X}h"
        default = "none stated" if expanded.default is None else _default(expanded.default.value(0), entry)
        if expanded.default is not None and expanded.default.node_id:
            default += " + node-ID"
        facts = [*_entry_rows(entry), ("Default", default)]
        if entry.effect:
            facts.append(("Writing it", device.effects[entry.effect].text))
        if single:
            rows += facts
        else:
            meaning = [("Meaning", entry.text)] if entry.text else []
            tables.append((f"Sub-index {entry.sub:02X}h: {entry.title}", (*facts, *meaning)))
        if entry.values:
            values = tuple((str(value.value), f"{value.name}: {value.text}") for value in entry.values)
            tables.append((f"Values{of_sub}", values))
        if entry.bits:
            bits = tuple((f"bit {bit.label}", f"{bit.name}: {bit.text}") for bit in entry.bits)
            tables.append((f"Bits{of_sub}", bits))
    modes = [mode.short for mode in device.modes if obj.name in mode.objects]
    if modes:
        rows.append(("Modes", ", ".join(modes)))
    rows.append(("Meaning", obj.text))
    rows.append(("Source", source_text(obj.source)))
    errata = device.errata_of(f"objects.{obj.name}")
    if errata:
        rows.append(("Errata", "; ".join(f"{erratum.id} {erratum.title}" for erratum in errata)))
    return Explanation(
        "object", obj.title.replace("{number}", str(item.number)), device.identity.name, tuple(rows), tuple(tables)
    )


def _entry_rows(entry: Entry) -> list[Row]:
    rows: list[Row] = [("Type", entry.type), ("Access", entry.eds_access)]
    rows.append(("PDO mapping", {"no": "no", "rx": "RPDO", "tx": "TPDO", "both": "RPDO and TPDO"}[entry.mapping]))
    if entry.allowed:
        rows.append(("Allowed", str(entry.allowed)))
    if entry.signatures:
        rows.append(("Signature", ", ".join(f"{s.value:08X}h '{s.ascii}' ({s.name})" for s in entry.signatures)))
    if entry.unit:
        scale = (
            f"{entry.unit.numerator}/{entry.unit.denominator}" if entry.unit.denominator > 1 else entry.unit.numerator
        )
        rows.append(("Unit", f"{entry.unit.symbol} (1 = {scale} {entry.unit.base})"))
    if entry.writable_in:
        rows.append(("Writable in", ", ".join(entry.writable_in)))
    if entry.access.writable:
        rows.append(("Stored", entry.stored))
    return rows


def _default(value: int | str, entry: Entry) -> str:
    if isinstance(value, str):
        return repr(value)
    return f"{value} ({value:0{max(2, entry.type.bits // 4)}X}h)" if not entry.type.signed else str(value)


def _emergencies(device: Device, term: str) -> Iterator[Explanation]:
    match = re.fullmatch(r"emcy\s+(.*)", term, re.IGNORECASE)
    wanted = match[1] if match else term
    code = _number(wanted, "{4}")
    for row in device.emergencies:
        if row.code == code or _folded(wanted) in (_folded(row.name), _folded(row.title)):
            yield _emergency(device, row)


def _emergency(device: Device, row: Emergency) -> Explanation:
    data = " ".join("axis" if byte == "axis" else f"{byte:02X}" for byte in row.bytes)
    condition = device.conditions[row.condition]
    rows = (
        ("Error code", f"{row.code:04X}h"),
        ("Data bytes 3..7", data),
        ("Affects", "the axis in data byte 4, counted from 0" if row.per_axis else "the whole device"),
        ("Error register", ", ".join(row.register) or "none"),
        ("Raised by", condition.text),
        ("Reaction", device.reactions[row.reaction].text),
        ("Cause", row.cause),
        ("Remedy", row.remedy),
        ("Source", source_text(row.source)),
    )
    return Explanation("emergency", row.title, device.identity.name, rows)


def _abort_codes(device: Device, term: str) -> Iterator[Explanation]:
    code = _number(term, "{8}")
    for item in device.abort_codes:
        if item.code == code or _folded(term) in (_folded(item.name), _folded(item.title)):
            rows = (
                ("Abort code", f"{item.code:08X}h"),
                ("Name", item.name),
                ("Used by this device", "yes" if item.used else "no"),
                ("Why", item.why),
                ("Source", source_text(item.source)),
            )
            yield Explanation("abort code", item.title, device.identity.name, rows)


def _modes(device: Device, term: str) -> Iterator[Explanation]:
    for mode in device.modes:
        if _folded(term) in (_folded(mode.name), _folded(mode.title), mode.short):
            rows = (
                ("Code in 6060h", str(mode.code)),
                ("Bit in 6502h", "none" if mode.bit is None else str(mode.bit)),
                ("Meaning", mode.text),
                ("Objects", ", ".join(mode.objects)),
                ("Source", source_text(mode.source)),
            )
            tables = tuple(
                (title, tuple((f"bit {bit.label}", f"{bit.name}: {bit.text}") for bit in bits))
                for title, bits in (("Controlword", mode.control_bits), ("Statusword", mode.status_bits))
                if bits
            )
            yield Explanation("mode of operation", mode.title, device.identity.name, rows, tables)


def _states(device: Device, term: str) -> Iterator[Explanation]:
    for state in device.pds_states:
        if _folded(term) not in (_folded(state.name), _folded(state.title)):
            continue
        rows = (
            ("Statusword", f"& {state.mask:04X}h = {state.value:04X}h"),
            ("Power", "on" if state.power else "off"),
            ("Meaning", state.text),
            ("Source", source_text(state.source)),
        )
        leaving = tuple(
            (f"transition {t.number}", f"to {t.end} by {' or '.join(t.by)}")
            for t in device.transitions
            if state.name in t.start
        )
        yield Explanation("PDS state", state.title, device.identity.name, rows, (("Ways out", leaving),))


def _homing_methods(device: Device, term: str) -> Iterator[Explanation]:
    match = re.fullmatch(r"(?:homing\s+)?method\s+(\d+)", term, re.IGNORECASE)
    for method in device.homing_methods:
        if (match and int(match[1]) == method.method) or _folded(term) in (_folded(method.name), _folded(method.title)):
            rows = (
                ("Method", str(method.method)),
                ("Meaning", method.text),
                ("Source", source_text(method.source)),
            )
            yield Explanation("homing method", method.title, device.identity.name, rows)


def _errata(device: Device, term: str) -> Iterator[Explanation]:
    for erratum in device.errata:
        if erratum.id.lower() == term.lower():
            rows = (
                ("Printed", erratum.printed),
                ("Modelled", erratum.modelled),
                ("Why", erratum.why),
                ("Evidence", erratum.evidence),
                *((f"The vendor's EDS, {fact}", said) for fact, said in erratum.vendor if device.identity.vendor_eds),
                ("Decides", ", ".join(erratum.paths)),
                ("Source", source_text(erratum.source)),
            )
            yield Explanation(
                f"erratum of class {erratum.severity}", f"{erratum.id} {erratum.title}", device.identity.name, rows
            )
