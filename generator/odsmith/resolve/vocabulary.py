"""Resolve the vocabulary: the words that the standards and the runtimes give to every device."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from odsmith.canopen_types import DataType
from odsmith.fields import parse_pattern, parse_scale
from odsmith.resolve.problems import Node, Problems, section, sources, words
from odsmith.vocabulary import (
    AbortCode,
    Condition,
    Effect,
    Led,
    LedPattern,
    ModeCode,
    Named,
    NmtCommand,
    NmtState,
    PdsCommand,
    PdsState,
    RegisterBit,
    Role,
    Signature,
    Transition,
    Unit,
)


def resolve_vocabulary(spec: Node, problems: Problems) -> dict[str, Any]:
    """The fields of `Vocabulary`, but for the digest."""
    effects = {
        name: Effect(name, node["text"], node.get("title", ""), node.get("to_driver", False), sources(node), node.where)
        for name, node in section(spec, "effects").items()
    }
    fields: dict[str, Any] = {
        "roles": {name: _role(name, node, effects, problems) for name, node in section(spec, "roles").items()},
        "effects": effects,
        "conditions": {
            name: Condition(name, node["scope"], node["text"], node.where)
            for name, node in section(spec, "conditions").items()
        },
        "reactions": named(section(spec, "reactions")),
        "register_bits": {
            name: RegisterBit(name, node["bit"], node["text"], node.where)
            for name, node in section(spec, "error_register").items()
        },
        "signatures": {
            name: Signature(name, node["value"], node["text"], node.where)
            for name, node in section(spec, "signatures").items()
        },
        "abort_codes": tuple(
            AbortCode(
                name,
                node["code"],
                node["title"],
                node.get("used", False),
                node.get("why", ""),
                sources(node),
                node.where,
            )
            for name, node in sorted(section(spec, "abort_codes").items(), key=lambda item: item[1]["code"])
        ),
        "mode_codes": tuple(
            ModeCode(name, node["code"], node.get("bit"), node["short"], node["title"], node.where)
            for name, node in section(spec, "mode_codes").items()
        ),
        "units": _units(section(spec, "units"), problems),
        "leds": tuple(_led(name, node) for name, node in section(spec, "leds").items()),
    }
    fields.update(_nmt(section(spec, "nmt"), problems))
    fields.update(_pds(section(spec, "pds"), problems))
    return fields


def named(nodes: Node) -> dict[str, Named]:
    """A section whose elements have no more than a text, a title and a source."""
    return {
        name: Named(name, node["text"], node.get("title", ""), sources(node), node.where)
        for name, node in nodes.items()
    }


def _role(name: str, node: Node, effects: Mapping[str, Effect], problems: Problems) -> Role:
    effect = node.get("effect", "")
    if effect:
        problems.look_up(effects, effect, node.place("effect"), "effect")
    return Role(
        name,
        node["scope"],
        DataType(node["type"]),
        node["text"],
        node.get("count", 1),
        node.get("length", 0),
        effect,
        node.where,
    )


def _units(nodes: Node, problems: Problems) -> dict[str, Unit]:
    units = {name: _unit(name, node, problems) for name, node in nodes.items()}
    for name in units:
        options = section(nodes[name], "options")
        for value, option in options.items():
            problems.look_up(units, option, options.place(value), "unit")
    return units


def _unit(name: str, node: Node, problems: Problems) -> Unit:
    numerator, denominator = problems.read(parse_scale, node.place("scale"), node["scale"], otherwise=(1, 1))
    options = tuple((int(value, 0), unit) for value, unit in node.get("options", {}).items())
    return Unit(
        name,
        node["symbol"],
        node["quantity"],
        node["base"],
        numerator,
        denominator,
        node["text"],
        node.get("selected_by", ""),
        options,
        node.where,
    )


def _led(name: str, node: Node) -> Led:
    patterns = tuple(
        LedPattern(
            key,
            item["title"],
            item.get("steady", ""),
            tuple(item.get("phases", ())),
            words(item["when"]),
            item["priority"],
            item["text"],
            item.where,
        )
        for key, item in node["patterns"].items()
    )
    return Led(name, node["title"], node["colour"], patterns, sources(node), node.where)


def _nmt(node: Node, problems: Problems) -> dict[str, Any]:
    states = {
        name: NmtState(
            name, item["code"], item["title"], tuple(item["services"]), item["text"], sources(item), item.where
        )
        for name, item in section(node, "states").items()
    }
    commands = []
    for name, item in section(node, "commands").items():
        problems.look_up(states, item["to"], item.place("to"), "NMT state")
        commands.append(
            NmtCommand(name, item["code"], item["to"], item["title"], item["text"], sources(item), item.where)
        )
    return {"nmt_states": tuple(states.values()), "nmt_commands": tuple(commands)}


def _pds(node: Node, problems: Problems) -> dict[str, Any]:
    states = {name: _pds_state(name, item, problems) for name, item in section(node, "states").items()}
    commands = {name: _pds_command(name, item, problems) for name, item in section(node, "commands").items()}
    events = named(section(node, "events"))
    triggers = {**commands, **events}
    transitions = []
    for item in node.get("transitions") or ():
        starts, triggered_by = words(item.get("from")), words(item["by"])
        for state in starts:
            problems.look_up(states, state, item.place("from"), "PDS state")
        problems.look_up(states, item["to"], item.place("to"), "PDS state")
        for name in triggered_by:
            problems.look_up(triggers, name, item.place("by"), "PDS command or event")
        transitions.append(
            Transition(
                item["number"], starts, item["to"], triggered_by, item.get("text", ""), sources(item), item.where
            )
        )
    return {
        "pds_states": tuple(states.values()),
        "pds_commands": tuple(commands.values()),
        "pds_events": tuple(events.values()),
        "transitions": tuple(sorted(transitions, key=lambda item: item.number)),
    }


def _pds_state(name: str, node: Node, problems: Problems) -> PdsState:
    mask, value, _ = problems.read(parse_pattern, node.place("status"), node["status"], otherwise=(0, 0, 0))
    return PdsState(name, node["title"], mask, value, node["power"], node["text"], sources(node), node.where)


def _pds_command(name: str, node: Node, problems: Problems) -> PdsCommand:
    mask, value, edge = problems.read(parse_pattern, node.place("control"), node["control"], otherwise=(0, 0, 0))
    return PdsCommand(name, node["title"], mask, value, edge, node["text"], sources(node), node.where)
