"""Resolve the object dictionary: objects, their entries, and the default PDOs."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.fields import FieldError, allowed_values, parse_bits, parse_default, parse_number, parse_range
from odsmith.model import (
    Allowed,
    AxisArea,
    Bit,
    Default,
    Entry,
    NamedValue,
    Object,
    Pdo,
    PdoKind,
    PdoMapEntry,
)
from odsmith.resolve.problems import Node, Problems, section, sources
from odsmith.vocabulary import Effect, Named, Role, Signature, Unit

N = TypeVar("N")

INHERITED = (
    "type",
    "length",
    "access",
    "mapping",
    "range",
    "unit",
    "signatures",
    "writable_in",
    "stored",
    "effect",
    "hidden_default",
    "refuse_write_on_scan",
)
"""What a sub-index takes from its object where it says nothing itself."""


@dataclass(frozen=True)
class Words:
    """What the entries of objects may refer to by name."""

    axes: int
    areas: tuple[AxisArea, ...]
    bases: Mapping[str, int]
    units: Mapping[str, Unit]
    signatures: Mapping[str, Signature]
    effects: Mapping[str, Effect]
    roles: Mapping[str, Role]
    pds_states: frozenset[str]
    nmt_states: frozenset[str]
    storage_groups: Mapping[str, Named]
    values: Mapping[str, tuple[NamedValue, ...]]
    """Enumerations that are sections of the spec: `modes`, `homing_methods`."""
    bits: Mapping[str, tuple[Bit, ...]]
    """Bit tables that are sections of the spec: `mode_codes`, `error_register`."""
    supported_modes: int
    """The value of $MODES: the bits of 6502h that the device's modes set."""


def resolve_objects(nodes: Iterable[Node], words: Words, problems: Problems) -> tuple[Object, ...]:
    """All folded objects, ascending by index."""
    return tuple(sorted((_object(node, words, problems) for node in nodes), key=lambda obj: obj.index))


def _object(node: Node, words: Words, problems: Problems) -> Object:
    index = _index(node, words, problems)
    object_type = ObjectType(node.get("object_type", "VAR"))
    stride = next((area.stride for area in words.areas if area.first <= index <= area.last), 0)
    parameter_name = node.get("parameter_name", node["title"])
    if object_type is ObjectType.VAR and "subs" in node:
        problems.report(
            "E310",
            node.key_place("subs"),
            f"`{node['name']}` is a VAR and has sub-indices",
            "make it `object_type: ARRAY` or `RECORD`, or drop `subs`",
        )
    if object_type is ObjectType.VAR:
        naming = {
            "name": node["name"],
            "title": node["title"],
            "parameter_name": parameter_name,
            "text": node["text"],
        }
        entries: tuple[Entry, ...] = (_EntryReader(node, node, words, problems).read(0, naming),)
    else:
        entries = _sub_entries(node, words, problems)
    return Object(
        index,
        node["name"],
        node["title"],
        parameter_name,
        object_type,
        entries,
        node["text"],
        sources(node),
        stride,
        1,
        node.get("pdo", ""),
        node.where,
    )


def _index(node: Node, words: Words, problems: Problems) -> int:
    value = node["index"]
    if isinstance(value, int):
        return value
    base, _, offset = value.partition("+")
    found = problems.look_up(words.bases, base.strip(), node.place("index"), "base index")
    return (found or 0) + int(offset.strip() or "0", 0)


def _sub_entries(node: Node, words: Words, problems: Problems) -> tuple[Entry, ...]:
    entries: list[Entry] = []
    elements: dict[str, int] = {}  # how many elements of an array role are taken
    subs = node["subs"]
    numbers = {key: problems.read(parse_number, subs.key_place(key), key, otherwise=0) for key in subs}
    for key, sub in sorted(numbers.items(), key=lambda item: item[1]):
        sub_node = subs[key]
        reader = _EntryReader(sub_node, node, words, problems)
        for ordinal, naming in enumerate(_namings(sub_node, words, problems)):
            role = sub_node.get("role", "")
            element = elements.get(role, 0)
            elements[role] = element + 1
            entries.append(reader.read(sub + ordinal, naming, element if role else ordinal))
    entries.sort(key=lambda entry: entry.sub)
    for first, second in itertools.pairwise(entries):
        if first.sub == second.sub:
            problems.report(
                "E303",
                second.place,
                f"sub-index {second.sub} of `{node['name']}` is described twice",
                "a repeated sub-index takes the ones that follow it; renumber one of them",
                ((first.place, "first described here"),),
            )
    if not entries or entries[0].sub != 0:
        entries.insert(0, _highest_sub_index(entries[-1].sub if entries else 0, node))
    return tuple(entries)


def _namings(node: Node, words: Words, problems: Problems) -> list[dict[str, str]]:
    """The names and the text of an entry, once for each time that it is repeated."""
    names = {
        "name": node["name"],
        "title": node.get("title", node["name"].replace("_", " ").capitalize()),
        "text": node.get("text", ""),
    }
    names["parameter_name"] = node.get("parameter_name", names["title"])
    repeat = node.get("repeat")
    if repeat is None:
        return [names]
    if repeat == "axes" and not words.axes:
        problems.report("E304", node.place("repeat"), "the device has no axes to repeat for", "give it `axes:`")
    count = words.axes if repeat == "axes" else repeat
    return [{key: _numbered(text, i) for key, text in names.items()} for i in range(count)]


def _numbered(text: str, ordinal: int) -> str:
    return text.replace("{i}", str(ordinal)).replace("{n}", str(ordinal + 1))


def _highest_sub_index(highest: int, node: Node) -> Entry:
    """Sub-index 0 of an array or record (CiA 301, clause 7.4.5.3)."""
    return Entry(
        sub=0,
        name="highest_sub_index",
        title="Highest sub-index supported",
        parameter_name="Highest sub-index supported",
        type=DataType.UNSIGNED8,
        access=Access.RO,
        mapping=PdoDirection.NO,
        default=Default(highest),
        text="Number of the last sub-index of this object.",
        source=(Source("cia301", clause="7.4.5.3"),),
        place=node.where,
    )


class _EntryReader:
    """Reads the fields of one entry from its node, and from its object's where it leaves them out."""

    def __init__(self, node: Node, parent: Node, words: Words, problems: Problems) -> None:
        self.node = node
        self.parent = parent
        self.words = words
        self.problems = problems

    def get(self, key: str) -> tuple[Any, Node]:
        """A field and the node that has it; (None, this node) where nobody has it."""
        if key in self.node:
            return self.node[key], self.node
        if key in INHERITED and key in self.parent:
            return self.parent[key], self.parent
        return None, self.node

    def read(self, sub: int, naming: dict[str, str], ordinal: int = 0) -> Entry:
        data_type = DataType(self.stated("type", "type: UNSIGNED32", "UNSIGNED32"))
        values = self.values()
        default = self.default(data_type)
        length, _ = self.get("length")
        if length is None:
            length = len(default.text.encode()) if default and default.text else 0
        access = Access(self.stated("access", "access: ro", "ro"))
        return Entry(
            sub=sub,
            type=data_type,
            access=access,
            mapping=PdoDirection(self.get("mapping")[0] or "no"),
            default=default,
            length=length,
            allowed=self.allowed(values),
            values=values,
            bits=self.bits(),
            signatures=self.named_list("signatures", self.words.signatures, "signature"),
            writable_in=self.states(),
            stored=self.stored(access),
            groups=tuple(group.name for group in self.named_list("groups", self.words.storage_groups, "storage group")),
            effect=self.reference("effect", self.words.effects) if access.writable else "",
            role=self.reference("role", self.words.roles),
            unit=self.unit(),
            hidden_default=self.get("hidden_default")[0] or "",
            refuse_write_on_scan=bool(self.get("refuse_write_on_scan")[0]),
            repeat=ordinal,
            per_axis=self.node.get("repeat") == "axes",
            source=sources(self.node) or sources(self.parent),
            place=self.node.where,
            **naming,
        )

    def stated(self, key: str, example: str, otherwise: str) -> str:
        """A field that the entry or its object must have."""
        value, _ = self.get(key)
        if value is None:
            self.problems.report(
                "E305",
                self.node.where,
                f"`{self.node.get('name', '')}` has no `{key}`",
                f"add `{example}`, here or at its object",
            )
        return value or otherwise

    def values(self) -> tuple[NamedValue, ...]:
        value = self.node.get("values")
        if value is None:
            return ()
        if isinstance(value, str):
            return self.problems.look_up(self.words.values, value, self.node.place("values"), "enumeration") or ()
        found = []
        for key, item in value.items():
            number = self.problems.read(parse_number, value.key_place(key), key, otherwise=0)
            found.append(NamedValue(number, item["name"], item["text"], self.nmt_state(item), place=item.where))
        return tuple(sorted(found, key=lambda item: item.value))

    def nmt_state(self, item: Node) -> str:
        state: str = item.get("nmt_state", "")
        if state and state not in self.words.nmt_states:
            self.problems.unknown(state, self.words.nmt_states, item.place("nmt_state"), "NMT state")
        return state

    def bits(self) -> tuple[Bit, ...]:
        value = self.node.get("bits")
        if value is None:
            return ()
        if isinstance(value, str):
            return self.problems.look_up(self.words.bits, value, self.node.place("bits"), "bit table") or ()
        return read_bits(value, self.problems)

    def allowed(self, values: tuple[NamedValue, ...]) -> Allowed | None:
        value, owner = self.get("range")
        if value is not None:
            return self.problems.read(parse_range, owner.place("range"), value, otherwise=None)
        return allowed_values([item.value for item in values]) if values else None

    def default(self, data_type: DataType) -> Default | None:
        value = self.node.get("default")
        if value is None:
            return None
        if value == "$MODES" and data_type.integer:
            return Default(self.words.supported_modes)
        return self.problems.read(parse_default, self.node.place("default"), value, data_type, otherwise=None)

    def unit(self) -> Unit | None:
        value, owner = self.get("unit")
        if value is None:
            return None
        return self.problems.look_up(self.words.units, value, owner.place("unit"), "unit")

    def states(self) -> tuple[str, ...]:
        value, owner = self.get("writable_in")
        for position, state in enumerate(value or ()):
            if state not in self.words.pds_states:
                self.problems.unknown(state, self.words.pds_states, owner["writable_in"].place(position), "PDS state")
        return tuple(value or ())

    def stored(self, access: Access) -> str:
        value, owner = self.get("stored")
        if value is None and access is Access.RW:
            self.stated("stored", "stored: never", "never")
        if value is None or not access.writable:
            return "never"
        if value != "never" and value not in self.words.storage_groups:
            self.problems.unknown(value, [*self.words.storage_groups, "never"], owner.place("stored"), "storage group")
        return str(value)

    def named_list(self, key: str, table: Mapping[str, N], what: str) -> tuple[N, ...]:
        value, owner = self.get(key)
        found = []
        for position, name in enumerate(value or ()):
            element = self.problems.look_up(table, name, owner[key].place(position), what)
            if element is not None:
                found.append(element)
        return tuple(found)

    def reference(self, key: str, table: Mapping[str, Any]) -> str:
        value, owner = self.get(key)
        if value is not None and value not in table:
            self.problems.unknown(value, table, owner.place(key), key)
        return value or ""


def read_bits(node: Node, problems: Problems) -> tuple[Bit, ...]:
    """A bit table: keys `5` or `16..23`, ascending."""
    found = []
    for key, item in node.items():
        try:
            low, high = parse_bits(key)
        except FieldError as error:
            problems.report("E301", node.key_place(key), str(error), error.hint)
            continue
        found.append(Bit(low, high, item["name"], item["text"], item.get("supported", True), item.where))
    return tuple(sorted(found, key=lambda bit: bit.low))


def look_up_selectors(objects: Mapping[str, Object], problems: Problems) -> None:
    """Report units in use whose choice is made by an object that the device does not have."""
    units = {entry.unit.name: entry.unit for obj in objects.values() for entry in obj.entries if entry.unit}
    for unit in units.values():
        if unit.selected_by:
            problems.look_up(objects, unit.selected_by, unit.place, "object")


def resolve_pdos(spec: Node, objects: Mapping[str, Object], problems: Problems) -> tuple[Pdo, ...]:
    """The default PDOs of axis 0: RPDOs, then TPDOs, each ascending."""
    node = section(spec, "pdos")
    found: list[Pdo] = []
    kinds: tuple[PdoKind, ...] = ("rpdo", "tpdo")
    for kind in kinds:
        items = section(node, kind)
        numbers = sorted(items, key=int)
        for expected, number in enumerate(numbers, 1):
            if int(number) != expected:
                problems.report(
                    "E306",
                    items.key_place(number),
                    f"{kind.upper()} {number} leaves a gap: the PDOs of an axis count from 1 without holes",
                    f"call it {expected}",
                )
            found.append(_pdo(kind, int(number), items[number], node, objects, problems))
    return tuple(found)


def _pdo(
    kind: PdoKind, number: int, node: Node, parent: Node, objects: Mapping[str, Object], problems: Problems
) -> Pdo:
    def cob_id(owner: Node, key: str) -> Default:
        otherwise = Default(0x80000000)
        if key not in owner:
            return otherwise
        return problems.read(parse_default, owner.place(key), owner[key], DataType.UNSIGNED32, otherwise=otherwise)

    mapped = (_mapped(text, node["map"], i, objects, problems) for i, text in enumerate(node["map"]))
    return Pdo(
        kind,
        number,
        cob_id(node, "cob_id"),
        cob_id(parent, "other_axes_cob_id"),
        node["transmission_type"],
        tuple(item for item in mapped if item),
        node.get("inhibit_time", 0),
        node.get("event_timer", 0),
        sources(node),
        node.where,
    )


def _mapped(
    text: str, node: Any, position: int, objects: Mapping[str, Object], problems: Problems
) -> PdoMapEntry | None:
    name, _, sub_name = text.partition(".")
    place = node.place(position)
    obj = problems.look_up(objects, name, place, "object")
    if obj is None:
        return None
    entries = {entry.name: entry for entry in obj.entries}
    if not sub_name and obj.object_type is ObjectType.VAR:
        return PdoMapEntry(obj, obj.entries[0])
    if not sub_name:
        problems.report(
            "E307", place, f"`{name}` has sub-indices", f"say which one is mapped: {name}.{obj.entries[-1].name}"
        )
        return None
    entry = problems.look_up(entries, sub_name, place, f"sub-index of `{name}` called")
    return PdoMapEntry(obj, entry) if entry else None


def pdo_objects(objects: tuple[Object, ...], pdos: tuple[Pdo, ...]) -> tuple[Object, ...]:
    """Give the PDO parameter objects their number of consecutive indices."""
    counts = {kind: sum(pdo.kind == kind for pdo in pdos) for kind in ("rpdo", "tpdo")}
    return tuple(
        replace(obj, count=counts[obj.pdo[:4]]) if obj.pdo else obj
        for obj in objects
        if not obj.pdo or counts[obj.pdo[:4]]
    )
