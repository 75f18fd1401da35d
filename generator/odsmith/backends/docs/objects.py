"""What the reference says about each object: facts in words, with links."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import NamedTuple

from odsmith.backends.docs.links import OBJECT_PAGES, axis_indices, hexadecimal
from odsmith.backends.docs.text import Piece, Reader, Rich, code, joined, plain
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.model import Bit, Default, Device, Entry, Erratum, Mode, NamedValue, Object
from odsmith.vocabulary import Unit

EDS_AXES = "EDS names count axes from 1"
"""Said wherever the name of an axis's object in the EDS shows."""


class Fact(NamedTuple):
    """One property in words."""

    label: str
    text: Rich


class BitRow(NamedTuple):
    label: str
    name: str
    text: Rich


class ValueRow(NamedTuple):
    value: str
    name: str
    text: Rich


class ModeBits(NamedTuple):
    """The bits of a control- or statusword that mean something else in each mode."""

    mode: Rich
    bits: tuple[BitRow, ...]


class EntryRow(NamedTuple):
    """A sub-index in the overview of its object."""

    sub: str
    title: str
    type: str
    access: str
    mapping: str
    range: Rich
    default: Rich
    unit: Rich
    stored: Rich


class EntryPart(NamedTuple):
    """What is to be said about one sub-index, or about several in a row that are alike."""

    heading: str
    text: Rich
    facts: tuple[Fact, ...]
    bits: tuple[BitRow, ...]
    values: tuple[ValueRow, ...]
    mode_bits: tuple[ModeBits, ...]


class ObjectView(NamedTuple):
    """An object as its section shows it. `rows` is empty for a variable, whose facts are all in `facts`.

    `number`, `stride`, `length` let the page find it by any index: axis n has `number + n * stride` and the
    `length - 1` indices behind it.
    """

    id: str
    heading: str
    title: str
    name: str
    type: str
    access: str
    mapping: str
    number: int
    stride: int
    length: int
    link: str
    text: Rich
    facts: tuple[Fact, ...]
    rows: tuple[EntryRow, ...]
    parts: tuple[EntryPart, ...]


class ObjectPage(NamedTuple):
    file: str
    title: str
    objects: tuple[ObjectView, ...]


class ObjectWriter:
    """Describes the objects of one device."""

    def __init__(self, device: Device, elements: dict[str, str], read: Reader) -> None:
        self.device = device
        self.elements = elements
        self.read = read
        self.errata = errata_by_path(device)
        self.users = _users(device)
        self.carriers = _carriers(device)
        self.state_titles = {state.name: state.title for state in device.pds_states}

    def pages(self) -> tuple[ObjectPage, ...]:
        """The objects, a page per area of the dictionary."""
        views = [self.object(obj) for obj in self.device.objects]
        return tuple(
            ObjectPage(file, title, tuple(view for view in views if view.link.startswith(file)))
            for _, _, file, title in OBJECT_PAGES
        )

    def object(self, obj: Object) -> ObjectView:
        title = numbered_title(obj)
        variable = obj.object_type is ObjectType.VAR
        first = obj.entries[0]
        shared = self._shared(obj)
        return ObjectView(
            id=hexadecimal(obj.index),
            heading=f"{hexadecimal(obj.index)} {title}",
            title=title,
            name=obj.name,
            type=first.type.value if variable else obj.object_type.value,
            access=_span(entry.access.value for entry in obj.entries if variable or entry.sub),
            mapping=_span(_MAPPING[entry.mapping] for entry in obj.entries if variable or entry.sub),
            number=obj.index,
            stride=obj.stride,
            length=obj.count,
            link=self.elements[f"objects.{obj.name}"],
            text=self.read(obj.text),
            facts=(*self._facts(obj, first if variable else None), *shared, *self._origin(obj)),
            rows=() if variable else tuple(self._row(obj, entry) for entry in obj.entries),
            parts=tuple(self._parts(obj, shared)),
        )

    # ---- facts of the object -----------------------------------------------------------------------------------------

    def _facts(self, obj: Object, variable: Entry | None) -> Iterator[Fact]:
        yield Fact("Index", self._indices(obj))
        yield Fact("EDS name", self._eds_names(obj))
        yield Fact("Name in code", code(obj.name))
        if variable:
            yield Fact("Type", plain(_type(variable)))
            yield Fact("Access", plain(_ACCESS[variable.access] + (", a constant" if variable.constant else "")))
            yield Fact("PDO mapping", plain(_MAPPING[variable.mapping]))
            if variable.access.writable or variable.allowed:
                yield Fact("Range", self._range(variable))
            if variable.access.writable or variable.default:
                yield Fact("Default", self._default(obj, variable))
            if variable.unit:
                yield Fact("Unit", self._unit(variable.unit))
            if variable.access.writable:
                yield Fact("Stored", self._stored(variable))
            yield from self._entry_facts(variable)
        else:
            yield Fact("Object type", plain(f"{obj.object_type.value} of {len(obj.entries)} sub-indices"))
        if obj.name in self.carriers:
            yield Fact("In default PDOs", joined(self.carriers[obj.name]))
        if obj.name in self.users:
            yield Fact("Used in modes", joined(self._mode(mode) for mode in self.users[obj.name]))

    def _origin(self, obj: Object) -> Iterator[Fact]:
        yield Fact("Source", self.read(sources(obj.source)))
        errata = self.errata.get(f"objects.{obj.name}")
        if errata:
            yield Fact("Errata", erratum_links(errata))

    def _indices(self, obj: Object) -> Rich:
        ranges = []
        for axis, index in enumerate(axis_indices(obj, self.device.axes)):
            shown = hexadecimal(index)
            where = f" axis {axis}" if obj.per_axis else ""
            if obj.count > 1:
                shown += f"..{hexadecimal(index + obj.count - 1)}"
            if obj.pdo:
                first = (index & 0x1FF) + 1
                where += f" ({obj.pdo[:4].upper()} {first}" + (f"..{first + obj.count - 1})" if obj.count > 1 else ")")
            ranges.append((*code(shown), Piece(where)))
        return joined(ranges, " · ")

    def _eds_names(self, obj: Object) -> Rich:
        if obj.pdo:
            return (*code(obj.parameter_name.replace("{number}", "n")), Piece(", n being the number of the PDO"))
        if not obj.per_axis:
            return code(obj.parameter_name)
        axes = self.device.axes
        names = joined(code(f"{obj.parameter_name} {axis + 1}") for axis in range(axes))
        return (*names, Piece(f" for {numbered('axis', 'axes', range(axes))} ({EDS_AXES})"))

    def _mode(self, mode: Mode) -> Rich:
        return (Piece(mode.title, self.elements[f"modes.{mode.name}"]),)

    # ---- facts of an entry -------------------------------------------------------------------------------------------

    def _row(self, obj: Object, entry: Entry) -> EntryRow:
        return EntryRow(
            sub=f"{entry.sub:02X}h",
            title=entry.title,
            type=_type(entry),
            access=entry.access.value,
            mapping=_MAPPING[entry.mapping],
            range=self._range(entry) if entry.access.writable or entry.allowed else plain(""),
            default=self._default(obj, entry),
            unit=plain(entry.unit.symbol if entry.unit else ""),
            stored=self._stored(entry) if entry.access.writable else plain(""),
        )

    def _parts(self, obj: Object, shared: tuple[Fact, ...]) -> Iterator[EntryPart]:
        """Sub-indices with something to say beyond the overview; those in a row that say the same come once."""
        variable = obj.object_type is ObjectType.VAR
        parts = []
        for entry in obj.entries:
            facts = () if variable else tuple(f for f in self._sub_facts(obj, entry) if f not in shared)
            text = () if variable else self.read(entry.text)
            bits = tuple(bit_row(bit, self.read) for bit in entry.bits)
            values = tuple(_value(entry, value, self.read) for value in entry.values)
            mode_bits = tuple(self._mode_bits(entry))
            if (facts or text or bits or values or mode_bits) and (variable or not _is_made(entry)):
                parts.append((entry, EntryPart("", text, facts, bits, values, mode_bits)))
        effects: dict[Fact, Entry] = {}  # what writing does, and the sub-index that says it first
        for part, alike in groupby(parts, key=lambda item: item[1]):
            entries = [entry for entry, _ in alike]
            facts = tuple(_said_before(fact, effects.setdefault(fact, entries[0]), entries[0]) for fact in part.facts)
            yield part._replace(heading="" if variable else _sub_heading(entries), facts=facts)

    def _shared(self, obj: Object) -> tuple[Fact, ...]:
        """What is true of every sub-index that anything is to be said about."""
        facts = [list(self._sub_facts(obj, entry)) for entry in obj.entries if not _is_made(entry)]
        if obj.object_type is ObjectType.VAR or len(facts) < 2:
            return ()
        return tuple(fact for fact in facts[0] if all(fact in others for others in facts))

    def _sub_facts(self, obj: Object, entry: Entry) -> Iterator[Fact]:
        if entry.unit and (entry.unit.selected_by or _scale(entry.unit)):
            yield Fact("Unit", self._unit(entry.unit))
        yield from self._entry_facts(entry)
        if entry.source and entry.source != obj.source:
            yield Fact("Source", self.read(sources(entry.source)))

    def _entry_facts(self, entry: Entry) -> Iterator[Fact]:
        if entry.hidden_default:
            yield Fact("Not in the EDS", self.read(f"The EDS prints no default: {entry.hidden_default}"))
        if entry.refuse_write_on_scan:
            yield Fact(
                "Scan", plain("A tool that writes every object in turn leaves this one out (ObjFlags in the EDS).")
            )
        if entry.signatures:
            words = (
                (*code(s.ascii), Piece(f" ({hexadecimal(s.value, 8)}): "), *self.read(s.text)) for s in entry.signatures
            )
            yield Fact("Signatures", joined(words, " · "))
        if entry.groups:
            groups = ((Piece(group, self.elements[f"storage_groups.{group}"]),) for group in entry.groups)
            yield Fact("Acts on", (*joined(groups), Piece(" (storage groups)")))
        if entry.writable_in:
            states = (
                (Piece(self.state_titles.get(name, name), self.elements.get(f"pds.states.{name}", "")),)
                for name in entry.writable_in
            )
            yield Fact("Writable in", joined(states, " or "))
        if entry.effect:
            effect = self.device.effects[entry.effect]
            yield Fact("Writing it", self.read(effect.text))

    def _range(self, entry: Entry) -> Rich:
        if entry.signatures:
            return joined(code(signature.ascii) for signature in entry.signatures)
        if not entry.type.integer:
            some = "up to" if entry.type is DataType.VISIBLE_STRING else "exactly"
            return plain(f"{some} {entry.length} octets" if entry.length else "any")
        if entry.allowed is None:
            return plain("any value of the type")
        return plain(
            ", ".join(
                number(entry, low) if low == high else f"{number(entry, low)}..{number(entry, high)}"
                for low, high in entry.allowed.intervals
            )
        )

    def _default(self, obj: Object, entry: Entry) -> Rich:
        if obj.pdo and entry.role:
            return (Piece("as in the table of PDOs", "pdos.md"),)
        if entry.default is None:
            return plain("none stated, starts as 0") if entry.access.writable else plain("")
        shown = default_text(entry, entry.default)
        if entry.default.text is not None:
            return code(shown) if shown else plain("empty")
        named = next((item for item in entry.values if item.value == entry.default.number), None)
        return (Piece(f"{shown} ("), *code(named.name), Piece(")")) if named else plain(shown)

    def _stored(self, entry: Entry) -> Rich:
        if entry.stored == "never":
            return plain("never")
        return (Piece(entry.stored, self.elements[f"storage_groups.{entry.stored}"]),)

    def _unit(self, unit: Unit) -> Rich:
        pieces = [Piece(unit.symbol)]
        if _scale(unit):
            pieces.append(Piece(f", {_scale(unit)}"))
        if unit.selected_by:
            link = self.elements.get(f"objects.{unit.selected_by}", "")
            options = ", ".join(f"{value} is {self.device.units[name].symbol}" for value, name in unit.options)
            pieces += [Piece("; chosen by "), *code(unit.selected_by, link), Piece(f": {options}")]
        return tuple(pieces)

    def _mode_bits(self, entry: Entry) -> Iterator[ModeBits]:
        for mode in self.device.modes:
            bits = {"controlword": mode.control_bits, "statusword": mode.status_bits}.get(entry.role, ())
            if bits:
                yield ModeBits(self._mode(mode), tuple(bit_row(bit, self.read) for bit in bits))


def _is_made(entry: Entry) -> bool:
    """The usual sub-index 0, which says how many there are and nothing else."""
    return entry.sub == 0 and not entry.access.writable and not entry.bits and not entry.values


def _said_before(fact: Fact, first: Entry, entry: Entry) -> Fact:
    """A long text is not said twice in one object."""
    if first is entry or fact.label != "Writing it":
        return fact
    return Fact(fact.label, plain(f"as for sub-index {first.sub:02X}h"))


# ---- words -----------------------------------------------------------------------------------------------------------

_ACCESS = {
    Access.RO: "ro, read only",
    Access.RW: "rw, read and write",
    Access.WO: "wo, write only",
    Access.CONST: "const, never changes",
}
_MAPPING = {
    PdoDirection.NO: "no",
    PdoDirection.RX: "RPDO",
    PdoDirection.TX: "TPDO",
    PdoDirection.BOTH: "RPDO, TPDO",
}
_AUTHORITIES = {
    "vendor_eds": "the vendor's EDS",
    "cia301": "CiA 301",
    "cia303": "CiA 303",
    "cia306": "CiA 306",
    "cia401": "CiA 401",
    "cia402": "CiA 402",
}


def sources(found: Iterable[Source]) -> str:
    """`manual 4.2.6, tables 66, 67; inferred: ...`."""
    return "; ".join(filter(None, map(_source, found)))


def _source(source: Source) -> str:
    if source.kind == "inferred":
        return f"inferred: {source.note}"
    if source.kind == "manual":
        words = [f"manual {source.section}".strip()]
        if source.tables:
            words.append(numbered("table", "tables", source.tables))
        if source.figures:
            words.append(numbered("figure", "figures", source.figures))
    elif source.kind == "own_manual":
        words = [f"own manual {source.section}"]
    else:
        words = [_AUTHORITIES[source.kind]]
        if source.clause:
            words.append(source.clause)
    return ", ".join(words) + (f" ({source.note})" if source.note else "")


def numbered(one: str, many: str, numbers: Iterable[int]) -> str:
    """`table 5`, `tables 5, 6`."""
    shown = [str(item) for item in numbers]
    return f"{one if len(shown) == 1 else many} {', '.join(shown)}"


def numbered_title(obj: Object) -> str:
    return obj.title.replace("{number}", "n")


def bit_row(bit: Bit, read: Reader) -> BitRow:
    text = read(bit.text)
    return BitRow(bit.label, bit.name, text if bit.supported else (Piece("Not supported. "), *text))


def _value(entry: Entry, value: NamedValue, read: Reader) -> ValueRow:
    return ValueRow(number(entry, value.value), value.name, read(value.text))


def number(entry: Entry, value: int) -> str:
    """A value of an entry: words made of bits in hexadecimal, quantities in decimal. All bits set is mostly a word
    of its own among quantities (`no limit`), so that is written both ways."""
    digits = entry.type.bits // 4 or 1
    if not entry.type.signed and not entry.unit and (entry.bits or value > 0xFFFF):
        return hexadecimal(value, digits)
    if value == 0xFFFFFFFF:
        return f"{value} ({hexadecimal(value, digits)})"
    return str(value)


def default_text(entry: Entry, default: Default) -> str:
    """A default as text; an identifier made with the node-ID as a sum."""
    if default.text is not None:
        return default.text
    if not default.node_id:
        return number(entry, default.number)
    return f"{hexadecimal(default.number, entry.type.bits // 4)} + node-ID" if default.number else "node-ID"


def erratum_links(errata: Iterable[Erratum]) -> Rich:
    """Each erratum by its id and title."""
    return joined(((Piece(e.id, f"errata.md#{e.id}"), Piece(f" {e.title}")) for e in errata), "; ")


def _type(entry: Entry) -> str:
    return f"{entry.type.value}({entry.length})" if entry.type.string and entry.length else entry.type.value


def _scale(unit: Unit) -> str:
    """`1 count is 1/1000 s`; empty where the symbol says it all."""
    if unit.numerator == unit.denominator:
        return "" if unit.symbol == unit.base else f"1 count is 1 {unit.base}"
    scale = f"{unit.numerator}/{unit.denominator}" if unit.denominator != 1 else str(unit.numerator)
    return f"1 count is {scale} {unit.base}"


def _span(words: Iterable[str]) -> str:
    """What the sub-indices have, each word once."""
    return ", ".join(dict.fromkeys(words)) or "ro"


def _sub_heading(entries: list[Entry]) -> str:
    first, last = entries[0], entries[-1]
    if first is last:
        return f"Sub-index {first.sub:02X}h {first.title}"
    return f"Sub-indices {first.sub:02X}h to {last.sub:02X}h {first.title} to {last.title}"


# ---- who uses what ---------------------------------------------------------------------------------------------------


def _users(device: Device) -> dict[str, list[Mode]]:
    users: dict[str, list[Mode]] = defaultdict(list)
    for mode in device.modes:
        for name in mode.objects:
            users[name].append(mode)
    return users


def _carriers(device: Device) -> dict[str, list[Rich]]:
    """The default PDOs of axis 0 that carry each object."""
    carriers: dict[str, list[Rich]] = defaultdict(list)
    for pdo in device.pdos:
        for name in dict.fromkeys(mapped.object.name for mapped in pdo.map):
            carriers[name].append((Piece(f"{pdo.kind.upper()} {pdo.number}", f"pdos.md#{pdo.kind}-{pdo.number}"),))
    return carriers


def errata_by_path(device: Device) -> dict[str, list[Erratum]]:
    """The errata of each path and of everything above it, as `Device.errata_of` finds them one by one."""
    found: dict[str, list[Erratum]] = defaultdict(list)
    for erratum in device.errata:
        parts = (path.split(".") for path in erratum.paths)
        above = {".".join(names[: depth + 1]) for names in parts for depth in range(len(names))}
        for path in sorted(above):
            found[path].append(erratum)
    return found
