"""The tables of a model as Python values, laid out by `python_source`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from odsmith import names
from odsmith.backends.python.names import MODE_WORDS, bits_class, has_mode_bits, mode_bits_class, values_class
from odsmith.backends.python.source import Call, Code, Hex
from odsmith.explain import source_text
from odsmith.model import Default, Device, Emergency, Entry, Mode, Object, Pdo, Step
from odsmith.vocabulary import Condition, Led, Named, Unit, Vocabulary

Table = dict[Any, Any]


# ---- the dictionary --------------------------------------------------------------------------------------------------


def areas(device: Device) -> tuple[tuple[Any, ...], ...]:
    """What repeats per axis."""
    return tuple(
        (Hex(area.first, 4), Hex(area.last, 4), Hex(area.stride, 2)) for area in device.areas if area.stride > 0
    )


def objects(device: Device) -> Table:
    return {
        Hex(obj.index, 4): (
            obj.name,
            obj.title,
            obj.parameter_name,
            obj.object_type.value,
            Hex(obj.stride, 2) if obj.stride else 0,
            obj.count,
            obj.pdo,
        )
        for obj in device.objects
    }


def entries(device: Device) -> Table:
    return {
        Hex(obj.index << 8 | entry.sub, 6, group=2): _entry(obj, entry)
        for obj in device.objects
        for entry in obj.entries
    }


def _entry(obj: Object, entry: Entry) -> tuple[Any, ...]:
    default = None if obj.pdo and entry.role else entry.default
    return (
        entry.type.value,
        entry.access.value,
        entry.mapping.value,
        _default(default),
        *((column, value) for column, value in _columns(obj, entry) if value),
    )


def _columns(obj: Object, entry: Entry) -> Iterable[tuple[str, Any]]:
    """The columns of an entry that are not what the runtime supposes where nothing is said."""
    yield "name", entry.name if entry.name != obj.name else ""
    yield "title", entry.title if entry.title != obj.title else ""
    yield "parameter_name", entry.parameter_name if entry.parameter_name != obj.parameter_name else ""
    yield "length", entry.length
    yield "allowed", entry.allowed.intervals if entry.allowed else ()
    yield "listed", entry.allowed.listed if entry.allowed else False
    yield "values_class", values_class(obj, entry) if entry.values else ""
    yield "bits_class", bits_class(obj, entry) if entry.bits else ""
    yield "unit_name", entry.unit.name if entry.unit else ""
    yield "signatures", tuple((signature.name, Hex(signature.value, 8)) for signature in entry.signatures)
    yield "writable_in", entry.writable_in
    yield "stored", entry.stored if entry.stored != "never" else ""
    yield "groups", entry.groups
    yield "effect", entry.effect
    yield "role", entry.role
    yield "hidden_default", entry.hidden_default
    yield "refuse_write_on_scan", entry.refuse_write_on_scan
    yield "repeat", entry.repeat
    yield "per_axis", entry.per_axis


def _default(default: Default | None) -> Any:
    if default is None:
        return None
    if default.text is not None:
        return default.text
    if default.node_id:
        return "$NODEID", Hex(default.number, 3)
    return Hex(default.number, 8) if default.number >= 1 << 24 else default.number


def pdos(device: Device) -> Table:
    return {(pdo.kind, pdo.number): _pdo(pdo) for pdo in device.pdos}


def _pdo(pdo: Pdo) -> tuple[Any, ...]:
    return (
        _default(pdo.cob_id),
        _default(pdo.other_axes_cob_id),
        pdo.transmission_type,
        pdo.inhibit_time,
        pdo.event_timer,
        tuple(Hex(mapped.value, 8, group=4) for mapped in pdo.map),
    )


def texts(device: Device) -> Table:
    """(object, sub-index or None) -> (description, source); entries that say the same as their object are left out."""
    table: Table = {}
    for obj in device.objects:
        own = obj.text, source_text(obj.source)
        table[obj.name, None] = own
        for entry in obj.entries:
            of_entry = entry.text, source_text(entry.source)
            if of_entry != own:
                table[obj.name, entry.sub] = of_entry
    return table


def units_of(device: Device) -> list[Unit]:
    """The units of the device's entries and those that may be chosen instead, in the order of the vocabulary."""
    used = {entry.unit.name for obj in device.objects for entry in obj.entries if entry.unit}
    used |= {name for unit in device.units.values() if unit.name in used for _, name in unit.options}
    return [unit for unit in device.units.values() if unit.name in used]


# ---- rows: a call of the runtime's class with the facts of one element -----------------------------------------------


def _row(function: str, element: Any, columns: str, **others: Any) -> Call:
    """The named columns of an element of the model; `mask:4` is written with four hexadecimal digits."""
    arguments: dict[str, Any] = {}
    for column in columns.split():
        name, _, digits = column.partition(":")
        if name in others:
            arguments[name] = others[name]
        elif name == "source":
            arguments[name] = source_text(element.source)
        else:
            value = getattr(element, name)
            arguments[name] = Hex(value, int(digits)) if digits else value
    return Call(function, arguments)


def identity(device: Device) -> Call:
    columns = (
        "name title vendor_id:8 product_code:8 revision_number:8 bit_rates "
        "digital_inputs digital_outputs analog_inputs analog_outputs axes"
    )
    bit_rates = tuple(sorted(device.identity.bit_rates))
    return _row("Identity", device.identity, columns, bit_rates=bit_rates, axes=device.axes)


def units(used: Iterable[Unit]) -> Table:
    columns = "name symbol quantity base numerator denominator text selected_by options"
    return {unit.name: _row("Unit", unit, columns) for unit in used}


def named(words: Iterable[Named]) -> Table:
    return {word.name: _row("Named", word, "name title text") for word in words}


def conditions(used: Iterable[Condition]) -> Table:
    return {item.name: _row("ConditionInfo", item, "name scope text") for item in used}


def roles(vocabulary: Vocabulary) -> Table:
    columns = "name scope type count length text"
    return {role.name: _row("Role", role, columns, type=role.type.value) for role in vocabulary.roles.values()}


def states(vocabulary: Vocabulary) -> Table:
    columns = "name title mask:4 value:4 power text source"
    return {state.name: _row("PdsStateInfo", state, columns) for state in vocabulary.pds_states}


def commands(vocabulary: Vocabulary) -> Table:
    columns = "name title mask:4 value:4 edge:4 text source"
    return {command.name: _row("PdsCommandInfo", command, columns) for command in vocabulary.pds_commands}


def transitions(vocabulary: Vocabulary) -> tuple[Call, ...]:
    return tuple(_row("Transition", item, "number start end by text source") for item in vocabulary.transitions)


def nmt_states(vocabulary: Vocabulary) -> Table:
    columns = "name code title services text source"
    return {state.code: _row("NmtStateInfo", state, columns) for state in vocabulary.nmt_states}


def nmt_commands(vocabulary: Vocabulary) -> Table:
    columns = "name code to title text source"
    return {command.code: _row("NmtCommandInfo", command, columns) for command in vocabulary.nmt_commands}


def leds(vocabulary: Vocabulary) -> Table:
    return {
        led.name: _row("Led", led, "name title colour patterns source", patterns=_patterns(led))
        for led in vocabulary.leds
    }


def _patterns(led: Led) -> tuple[Call, ...]:
    return tuple(_row("LedPattern", item, "name title steady phases when priority text") for item in led.patterns)


def abort_codes(device: Device) -> Table:
    columns = "name code:8 title used why source"
    return {Hex(item.code, 8): _row("AbortCodeInfo", item, columns) for item in device.abort_codes}


def emergencies(device: Device) -> tuple[Call, ...]:
    columns = (
        "name code:4 title bytes register register_mask condition reaction momentary driver_flag cause remedy source"
    )
    return tuple(
        _row("Emergency", row, columns, register_mask=_register_mask(device, row)) for row in device.emergencies
    )


def _register_mask(device: Device, row: Emergency) -> Hex:
    return Hex(sum(1 << device.register_bits[name].bit for name in set(row.register)), 2)


def modes(device: Device) -> Table:
    columns = "name code short title bit controlword statusword objects slow_down_ramp text source"
    return {
        mode.code: _row("ModeInfo", mode, columns, **{word: _word(device, mode, word) for word in MODE_WORDS})
        for mode in device.modes
    }


def has_words(device: Device, mode: Mode) -> bool:
    """True where a mode has a bit table of its own."""
    return any(has_mode_bits(device, mode, word) for word in MODE_WORDS)


def _word(device: Device, mode: Mode, word: str) -> Code | None:
    """The bits of controlword or statusword in a mode, where the device has the word and names bits of it."""
    return Code(f"flags.{mode_bits_class(mode, word)}") if has_mode_bits(device, mode, word) else None


def homing_methods(device: Device) -> Table:
    columns = "name method title switch direction edge reverse_at index_pulse needs_power text source"
    return {method.method: _row("HomingMethodInfo", method, columns) for method in device.homing_methods}


def ramp(device: Device) -> Table:
    return {item.name: _row("RampParameter", item, "name symbol object text source") for item in device.ramp}


def recipes(device: Device) -> Table:
    columns = "name mode title steps text source"
    return {
        (mode.name, recipe.name): _row(
            "Recipe", recipe, columns, mode=mode.name, steps=tuple(_step(step) for step in recipe.steps)
        )
        for mode in device.modes
        for recipe in mode.recipes
    }


def step_classes(device: Device) -> list[str]:
    """The classes that recipes are made of."""
    kinds = {step.kind for mode in device.modes for recipe in mode.recipes for step in recipe.steps}
    return sorted(["Recipe", *(names.class_name(kind) for kind in kinds)])


def _step(step: Step) -> Call:
    pairs = step.arguments
    columns: dict[str, Any] = {}
    match step.kind:
        case "write":
            columns["values"] = pairs
        case "command":
            columns["name"] = pairs[0][1]
        case "expect":
            columns["state"] = "".join(str(value) for name, value in pairs if name == "state")
            columns["status_bits"] = tuple(value for name, value in pairs if name == "status_bit")
            columns["values"] = tuple(pair for pair in pairs if pair[0] not in ("state", "status_bit"))
        case "wait":
            columns["milliseconds"] = pairs[0][1]
        case "input":
            columns["levels"] = pairs
    columns |= {"text": step.text, "added": step.added}
    return Call(names.class_name(step.kind), {name: value for name, value in columns.items() if value not in ("", ())})
