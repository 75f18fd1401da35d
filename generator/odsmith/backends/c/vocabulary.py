"""The vocabulary in C: the words that the runtime and the tables of all devices share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from odsmith import names
from odsmith.backends.c.storage import Field, by_size, role_field, sized_by_device
from odsmith.backends.c.text import Constant, Group, hexadecimal, signed
from odsmith.vocabulary import Condition, Effect, Named, PdsState, Vocabulary


@dataclass(frozen=True, slots=True)
class Struct:
    """A struct of values; without fields it has one that nobody uses, as C knows no empty struct."""

    type: str
    text: str
    fields: tuple[Field, ...]


def structs(vocabulary: Vocabulary) -> list[Struct]:
    """What the runtime knows of the values of the device, an axis and a PDO."""
    texts = {
        "device": "Values of the device.",
        "axis": "Values of one axis.",
        "pdo": "Parameters of one PDO. Its mapping stands behind them: see ods_pdo_mapping().",
    }
    return [
        Struct(
            f"ods_{scope}_values_t",
            text,
            by_size(
                role_field(role)
                for role in vocabulary.roles.values()
                if role.scope == scope and not sized_by_device(role)
            )
            or (Field("uint8_t", "unused", 0, 1, "No role of this scope."),),
        )
        for scope, text in texts.items()
    ]


def groups(vocabulary: Vocabulary) -> list[Group]:
    """All constants, in the order of the header."""
    return [
        Group("SDO abort codes.", _abort_codes(vocabulary)),
        Group("Bits of the error register 1001h.", _error_bits(vocabulary)),
        Group("Signatures: what has to be written to a command before it acts.", _signatures(vocabulary)),
        Group("Services that run or rest in an NMT state.", _services(vocabulary)),
        _enumeration("NMT states, as the heartbeat carries them.", "ods_nmt_state", _nmt_states(vocabulary)),
        _enumeration("NMT commands, as the frame carries them.", "ods_nmt_command", _nmt_commands(vocabulary)),
        _enumeration("Modes of operation, as 6060h carries them.", "ods_mode", _modes(vocabulary)),
        _counted("States of a drive (PDS).", "ods_pds_state", "ODS_PDS_STATE", vocabulary.pds_states),
        _triggers(vocabulary),
        *_conditions(vocabulary),
        _counted("What an emergency does to the axes.", "ods_reaction", "ODS_REACTION", vocabulary.reactions.values()),
        _counted("What writing an entry does.", "ods_effect", "ODS_EFFECT", vocabulary.effects.values()),
        _counted("LEDs.", "ods_led", "ODS_LED", (Named(led.name, led.title) for led in vocabulary.leds)),
        _counted("Reasons to show an LED pattern.", "ods_led_when", "ODS_LED_WHEN", _whens(vocabulary)),
        *_units(vocabulary),
    ]


def _abort_codes(vocabulary: Vocabulary) -> tuple[Constant, ...]:
    return tuple(
        Constant(names.constant("ODS_ABORT", code.name), hexadecimal(code.code, 8), code.title, code.place)
        for code in vocabulary.abort_codes
    )


def _error_bits(vocabulary: Vocabulary) -> tuple[Constant, ...]:
    return tuple(
        Constant(names.constant("ODS_ERROR", bit.name), hexadecimal(1 << bit.bit, 2), bit.text, bit.place)
        for bit in vocabulary.register_bits.values()
    )


def _signatures(vocabulary: Vocabulary) -> tuple[Constant, ...]:
    return tuple(
        Constant(
            names.constant("ODS_SIGNATURE", item.name),
            hexadecimal(item.value, 8),
            f"`{item.ascii}` on the bus. {item.text}",
            item.place,
        )
        for item in vocabulary.signatures.values()
    )


def _services(vocabulary: Vocabulary) -> tuple[Constant, ...]:
    services = dict.fromkeys(service for state in vocabulary.nmt_states for service in state.services)
    return tuple(
        Constant(names.constant("ODS_SERVICE", service), hexadecimal(1 << bit, 2))
        for bit, service in enumerate(services)
    )


def _nmt_states(vocabulary: Vocabulary) -> Iterator[Constant]:
    for state in vocabulary.nmt_states:
        yield Constant(names.constant("ODS_NMT_STATE", state.name), str(state.code), state.text, state.place)


def _nmt_commands(vocabulary: Vocabulary) -> Iterator[Constant]:
    for command in vocabulary.nmt_commands:
        yield Constant(names.constant("ODS_NMT_COMMAND", command.name), str(command.code), command.text, command.place)


def _modes(vocabulary: Vocabulary) -> Iterator[Constant]:
    for mode in vocabulary.mode_codes:
        yield Constant(names.constant("ODS_MODE", mode.name), str(mode.code), mode.title, mode.place)


def _triggers(vocabulary: Vocabulary) -> Group:
    """Commands and events in one enumeration: a transition does not care which of them takes it."""
    commands = [
        Constant(names.constant("ODS_PDS_COMMAND", item.name), "", item.text, item.place)
        for item in vocabulary.pds_commands
    ]
    events = [
        Constant(names.constant("ODS_PDS_EVENT", item.name), "", item.text, item.place)
        for item in vocabulary.pds_events
    ]
    return _enumeration(
        "What takes a transition of the PDS: commands of the controlword, and events.",
        "ods_pds_trigger",
        [*commands, *events, Constant("ODS_PDS_TRIGGERS", "")],
    )


def _conditions(vocabulary: Vocabulary) -> Iterator[Group]:
    """Those of an axis come first, so that bit sets of both scopes are short."""
    per_axis = [item for item in vocabulary.conditions.values() if item.scope == "axis"]
    once: list[Condition] = [item for item in vocabulary.conditions.values() if item.scope != "axis"]
    yield _counted("What raises an emergency.", "ods_condition", "ODS_CONDITION", [*per_axis, *once])
    count = Constant("ODS_AXIS_CONDITIONS", f"{len(per_axis)}u")
    yield Group("The first so many conditions are those of an axis.", (count,))


def _whens(vocabulary: Vocabulary) -> Iterator[Named]:
    seen = set()
    for led in vocabulary.leds:
        for pattern in led.patterns:
            for when in pattern.when:
                if when not in seen:
                    seen.add(when)
                    yield Named(when, "")


def _units(vocabulary: Vocabulary) -> Iterator[Group]:
    """Units between which an object chooses, for a runtime has to reckon in each of them."""
    for chosen in vocabulary.units.values():
        constants = []
        for code, name in chosen.options:
            unit = vocabulary.units[name]
            numbers = (("CODE", code), ("NUMERATOR", unit.numerator), ("DENOMINATOR", unit.denominator))
            constants += [
                Constant(names.constant("ODS", name, what), signed(number), place=unit.place)
                for what, number in numbers
            ]
        yield Group(
            f"Units of `{chosen.name}`: their codes in `{chosen.selected_by}`, and how much {chosen.base} a count is.",
            tuple(constants),
        )


def _counted(text: str, name: str, prefix: str, items: Iterable[Named | Effect | Condition | PdsState]) -> Group:
    """An enumeration that counts from 0 and ends with the number of its members, so that it is never empty."""
    members = [Constant(names.constant(prefix, item.name), "", item.text, item.place) for item in items]
    return _enumeration(text, name, [*members, Constant(f"{prefix}S", "")])


def _enumeration(text: str, name: str, constants: Iterable[Constant]) -> Group:
    return Group(text, tuple(constants), enumeration=True, type=f"{name}_t")
