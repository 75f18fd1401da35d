"""C for firmware: the vocabulary as headers, a device as constant tables that all of its axes share.

`storage` decides where values live, `dictionary` packs the tables, `drive` makes the rows of the other tables,
`constants` and `vocabulary` name things; here they become what the templates see.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from odsmith import escape, names
from odsmith.backends.c import constants as c_constants
from odsmith.backends.c import drive as c_drive
from odsmith.backends.c import vocabulary as c_vocabulary
from odsmith.backends.c.dictionary import (
    MAP_UNIT,
    PAGE,
    Default,
    Dictionary,
    Interval,
    NodeId,
    PackedEntry,
    Rule,
    Text,
    pack,
)
from odsmith.backends.c.drive import C_TYPE_CODES, flags
from odsmith.backends.c.storage import Storage, struct_of
from odsmith.backends.c.text import beside, comment, distinct, hexadecimal, number, rows, signed, unsigned
from odsmith.canopen_types import DataType
from odsmith.model import SCOPES, Device, PdoKind, Scope
from odsmith.render import MARK, Backend
from odsmith.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class EntryRow:
    """A row of the entry table; `heading` begins a new object."""

    heading: str
    at: str
    kind: str
    rule: int
    comment: str


@dataclass(frozen=True, slots=True)
class RuleRow:
    first: int
    intervals: int
    flags: str
    states: str
    group: str
    effect: str
    comment: str


@dataclass(frozen=True, slots=True)
class TextRow:
    octets: str
    at: str
    length: int


@dataclass(frozen=True, slots=True)
class Member:
    """An array in the memory of a node; without a declaration where the device needs none."""

    name: str
    declaration: str


class CBackend(Backend):
    """Writes `<device>/c/<device>_od.{h,c}`, `<device>_device.{h,c}` and `<device>.{h,c}`, and `cia/c/ods/*.h` for the
    vocabulary."""

    name = "c"
    filters: Mapping[str, Callable[..., Any]] = {
        "beside": beside,
        "comment": comment,
        "c_comment": escape.c_comment,
        "string": escape.c_string,
    }

    def vocabulary_context(self, vocabulary: Vocabulary) -> Mapping[str, object]:
        groups = c_vocabulary.groups(vocabulary)
        distinct(groups)
        return {
            "mark": f"{MARK} from the vocabulary `{vocabulary.identifier}`: do not edit.",
            "vocabulary": vocabulary,
            "groups": [group for group in groups if group.constants],
            "structs": c_vocabulary.structs(vocabulary),
        }

    def device_context(self, device: Device) -> Mapping[str, object]:
        storage = Storage(device)
        dictionary = pack(device)
        objects = list(c_constants.object_groups(device))
        others = [c_drive.storage_groups(device), *c_drive.mode_bits(device), c_drive.emergency_codes(device)]
        distinct([*objects, *others])
        groups, *device_groups = others
        return {
            "mark": f"{MARK} from the specification `{device.identity.identifier}`: do not edit.",
            "device": device,
            "identity": device.identity,
            "prefix": device.identity.identifier,
            "PREFIX": names.constant(device.identity.identifier),
            **_values(storage, dictionary),
            **_dictionary(device, dictionary),
            "memory": _memory(device, dictionary),
            "objects": objects,
            "storage_groups": groups,
            "device_groups": [group for group in device_groups if group.constants],
            **_tables(storage),
        }


def _values(storage: Storage, dictionary: Dictionary) -> dict[str, object]:
    counts = dict(zip(SCOPES, dictionary.instances, strict=True))
    return {
        "structs": {struct: storage.own_fields(struct) for struct in storage.structs},
        "counts": counts,
        "strides": {area.name: hexadecimal(area.stride) for area in storage.device.areas if area.stride},
    }


def _memory(device: Device, dictionary: Dictionary) -> list[Member]:
    """The members of `ods_memory_t` behind the values; C has no arrays without elements."""
    prefix = names.constant(device.identity.identifier)
    counts = dict(zip(SCOPES, dictionary.instances, strict=True))
    pdos = counts["rpdo"] + counts["tpdo"]
    arrays = (
        ("axes", "ods_axis_t", device.axes, f"{prefix}_AXES"),
        ("rpdos", "ods_rpdo_t", counts["rpdo"], f"{prefix}_RPDOS"),
        ("tpdos", "ods_tpdo_t", counts["tpdo"], f"{prefix}_TPDOS"),
        ("mapped", "ods_pdo_ref_t", pdos, f"({prefix}_RPDOS + {prefix}_TPDOS) * {prefix}_MAX_MAPPED"),
        ("buffer", "uint8_t", dictionary.buffer_size, f"{prefix}_BUFFER_SIZE"),
    )
    return [Member(name, f"{type_} {name}[{size}]" if count else "") for name, type_, count, size in arrays]


def _dictionary(device: Device, dictionary: Dictionary) -> dict[str, object]:
    prefix = device.identity.identifier
    counts = dict(zip(SCOPES, dictionary.instances, strict=True))
    entries = [_entry(row) for row in dictionary.entries]
    return {
        "owners": _pages(dictionary.owners),
        "map_of": _pages(dictionary.map_of),
        "maps": _maps(dictionary.maps),
        "chunks": [
            (chunk.entry, ", ".join(map(str, chunk.first)), f"{chunk.index:04X}h" if number else "no object")
            for number, chunk in enumerate(dictionary.chunks)
        ],
        "entries": entries,
        "bases": [base for scope in SCOPES for base in _instances(scope, counts[scope])],
        "rules": [_rule(device, rule, users) for rule, users in zip(dictionary.rules, dictionary.users, strict=True)],
        "intervals": [_interval(item) for item in dictionary.intervals],
        "words": [hexadecimal(word, 8) for word in dictionary.words],
        "texts": [_text(text) for text in dictionary.texts],
        "folds": dictionary.folds,
        "scope_entries": ", ".join(map(str, dictionary.scope_entries)),
        "scope_instances": ", ".join(str(sum(dictionary.instances[:n])) for n in range(len(SCOPES) + 1)),
        "scope_sizes": [
            f"(uint16_t)sizeof({prefix}_{struct_of(scope)}_values_t)" if counts[scope] else "0" for scope in SCOPES
        ],
        "communication_entries": dictionary.communication_entries,
        "defaults": {
            struct: [_default(item) for item in dictionary.defaults if item.scope == struct]
            for struct in ("device", "axis")
        },
        "pdo_defaults": {kind: _pdos(device, dictionary, kind) for kind in _PDO_KINDS if counts[kind]},
        "other_cob_ids": [
            (hexadecimal(pdo.other_axes_cob_id.number, 8), f"{pdo.kind.upper()} {pdo.number}")
            for kind in _PDO_KINDS
            if counts[kind]
            for pdo in device.pdos_of(kind)
        ],
        "node_ids": [_node_id(item) for item in dictionary.node_ids],
        "areas": _mappable_areas(device),
        "buffer_size": dictionary.buffer_size,
        "layout": hexadecimal(dictionary.layout, 8),
    }


_PDO_KINDS: tuple[PdoKind, ...] = ("rpdo", "tpdo")


def _mappable_areas(device: Device) -> list[tuple[str, str, str]]:
    """First and last index and stride of the areas whose objects the PDOs of an axis may have in their mapping."""
    indices = [obj.index for obj in device.objects if obj.per_axis and not obj.pdo]
    return [
        (hexadecimal(area.first, 4), hexadecimal(area.last, 4), hexadecimal(area.stride, 4))
        for area in device.areas
        if area.stride and any(area.first <= index <= area.last for index in indices)
    ]


def _pages(numbers: tuple[int, ...]) -> list[tuple[str, str]]:
    """Sixteen pages to a line, with the index at which they begin."""
    per_line = 16
    lines = rows((str(item) for item in numbers), per_line)
    return [(line, f"{number * per_line * PAGE:04X}h") for number, line in enumerate(lines)]


def _maps(cells: tuple[int, ...]) -> list[tuple[str, int]]:
    """Sixteen cells to a line, with their place as the table `map_of` says it."""
    per_line = 16
    return [(line, n * per_line // MAP_UNIT) for n, line in enumerate(rows(map(str, cells), per_line))]


def _instances(scope: Scope, count: int) -> list[str]:
    if scope == "device":
        return ["AT_BLOCK(device)"]
    return [f"AT_BLOCK({scope}[{number}])" for number in range(count)]


def _entry(row: PackedEntry) -> EntryRow:
    obj, entry = row.object, row.entry
    heading = f"{obj.index:04X}h {obj.title.replace('{number}', 'n')}" if row.sub == 0 else ""
    if entry is None:
        return EntryRow(heading, "0", "0", 0, f":{row.sub:02X} is not there")
    kind = flags(
        C_TYPE_CODES[entry.type],
        "ODS_READ" if entry.access.readable else "",
        "ODS_RX" if entry.mapping.receivable else "",
        "ODS_TX" if entry.mapping.transmittable else "",
        "" if row.location else "ODS_CONST",
    )
    if row.location and entry.type.bits:
        at = f"AT_{row.location.struct.upper()}({row.location.designator})"
    else:
        at = str(row.at)
    return EntryRow(heading, at, kind, row.rule, f":{row.sub:02X} {entry.name}" if len(obj.entries) > 1 else "")


def _rule(device: Device, rule: Rule, users: tuple[PackedEntry, ...]) -> RuleRow:
    states = flags(*(f"1u << {names.constant('ODS_PDS_STATE', state)}" for state in rule.states))
    return RuleRow(
        rule.first,
        rule.intervals,
        flags(
            "ODS_OD_SIGNATURE" if rule.signature else "",
            "ODS_OD_LISTED" if rule.listed else "",
            "ODS_OD_RANGE" if rule.ranged else "",
            "ODS_OD_GUARDED" if rule.guarded else "",
        ),
        states,
        c_drive.group_name(device, rule.group) if rule.group else "0",
        names.constant("ODS_EFFECT", rule.effect) if rule.effect else "0",
        _users(users) if rule.effect else "cannot be written",
    )


def _users(users: tuple[PackedEntry, ...]) -> str:
    """The first few entries that share a rule."""
    shown = [f"{row.object.index:04X}h:{row.sub:02X}" for row in users[:3]]
    more = len(users) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


def _interval(item: Interval) -> tuple[str, str]:
    if item.biased:
        return f"ODS_OD_BIAS({signed(item.low)})", f"ODS_OD_BIAS({signed(item.high)})"
    return unsigned(item.low), unsigned(item.high)


def _text(text: Text) -> TextRow:
    if text.location is None:
        return TextRow(escape.c_string(text.octets.decode("utf-8")), "0", text.length)
    return TextRow("NULL", f"AT_{text.location.struct.upper()}({text.location.designator})", text.length)


def _pdos(device: Device, dictionary: Dictionary, kind: PdoKind) -> list[tuple[str, list[tuple[str, str]]]]:
    """For each PDO of an axis its title and the members that are not 0 at power-on."""
    return [
        (
            f"{kind.upper()} {pdo.number}",
            [_default(item) for item in dictionary.defaults if (item.scope, item.ordinal) == (kind, ordinal)],
        )
        for ordinal, pdo in enumerate(device.pdos_of(kind))
    ]


def _default(item: Default) -> tuple[str, str]:
    """Designator and value of a member that does not power on as 0."""
    if not item.type.bits:
        return item.location.designator, "{ " + ", ".join(str(octet) for octet in item.octets) + " }"
    if item.location.struct == "pdo" and item.type is DataType.UNSIGNED32:  # COB-IDs and mappings are read by digits
        return item.location.designator, hexadecimal(item.number, 8)
    return item.location.designator, number(item.number, item.type)


def _node_id(item: NodeId) -> tuple[str, str]:
    member = item.scope if item.scope == "device" else f"{item.scope}[{item.instance}]"
    return f"AT_BLOCK({member}.{item.location.designator})", C_TYPE_CODES[item.type]


def _tables(storage: Storage) -> dict[str, object]:
    device = storage.device
    leds, phases = c_drive.leds(device)
    used = [code for code in device.abort_codes if code.used]
    return {
        "bit_rates": ", ".join(map(str, device.identity.bit_rates)),
        "nmt_states": c_drive.nmt_services(device),
        "nmt_commands": [
            (names.constant("ODS_NMT_COMMAND", item.name), names.constant("ODS_NMT_STATE", item.to))
            for item in device.nmt_commands
        ],
        "error_behaviours": [
            (value, names.constant("ODS_NMT_STATE", state.name)) for value, state in device.error_behaviour.items()
        ],
        "leds": leds,
        "led_phases": ", ".join(map(str, phases)),
        "emergencies": c_drive.emergencies(device),
        "stores": c_drive.stores(device),
        "modes": c_drive.modes(storage),
        "pds_states": c_drive.pds_states(device),
        "pds_commands": c_drive.pds_commands(device),
        "pds_transitions": c_drive.pds_transitions(device),
        "homing_methods": c_drive.homing_methods(device),
        "ramp": c_drive.ramp(storage),
        "motor_parameters": c_drive.motor_parameters(storage),
        "abort_codes": [(names.constant("ODS_ABORT", code.name), code.why) for code in used],
    }
