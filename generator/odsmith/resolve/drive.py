"""Resolve what a drive does: modes with their recipes, homing methods, the ramp, emergencies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from odsmith.model import (
    Bit,
    Emergency,
    HomingMethod,
    Mode,
    NamedValue,
    Object,
    RampParameter,
    Recipe,
    Step,
)
from odsmith.resolve.objects import read_bits
from odsmith.resolve.problems import Node, Problems, section, sources
from odsmith.vocabulary import ModeCode

_DIRECTIONS = {"negative": -1, "none": 0, "positive": 1}


def mode_numbers(spec: Node, codes: Iterable[ModeCode], problems: Problems) -> dict[str, ModeCode]:
    """Code, bit and names of each mode of the device, its own or those of CiA 402."""
    known = {code.name: code for code in codes}
    found = {}
    for name, node in section(spec, "modes").items():
        base = known.get(name)
        code = node.get("code", base.code if base else None)
        if code is None:
            problems.report(
                "E308",
                section(spec, "modes").key_place(name),
                f"mode `{name}` has no code",
                "give it `code:` and `bit:`, or call it as `mode_codes` does",
            )
            continue
        found[name] = ModeCode(
            name,
            code,
            node.get("bit", base.bit if base else None),
            node.get("short", base.short if base else name),
            node.get("title", base.title if base else name.replace("_", " ").capitalize()),
            node.where,
        )
    return found


def mode_values(numbers: Mapping[str, ModeCode]) -> tuple[NamedValue, ...]:
    """The enumeration of 6060h and 6061h."""
    values = (
        NamedValue(item.code, item.name, f"{item.title} ({item.short}).", place=item.place) for item in numbers.values()
    )
    return tuple(sorted(values, key=lambda value: value.value))


def mode_bits(codes: Iterable[ModeCode]) -> tuple[Bit, ...]:
    """The bit table of 6502h: every mode of CiA 402, whether the device has it or not."""
    bits = (Bit(c.bit, c.bit, c.name, f"{c.title} ({c.short}).", True, c.place) for c in codes if c.bit is not None)
    return tuple(sorted(bits, key=lambda bit: bit.low))


def homing_values(spec: Node) -> tuple[NamedValue, ...]:
    """The enumeration of 6098h."""
    nodes = section(spec, "homing_methods")
    values = (NamedValue(node["method"], name, node["title"] + ".", place=node.where) for name, node in nodes.items())
    return tuple(sorted(values, key=lambda value: value.value))


def resolve_modes(
    spec: Node,
    numbers: Mapping[str, ModeCode],
    objects: Mapping[str, Object],
    pds_states: frozenset[str],
    pds_commands: frozenset[str],
    problems: Problems,
) -> tuple[Mode, ...]:
    """The modes of operation, ascending by code."""
    errata = frozenset(node["id"] for node in spec.get("errata") or ())
    found = []
    for name, number in numbers.items():
        node = section(spec, "modes")[name]
        for position, object_name in enumerate(node.get("objects", ())):
            problems.look_up(objects, object_name, node["objects"].place(position), "object")
        ramp = node.get("slow_down_ramp", "")
        if ramp:
            problems.look_up(objects, ramp, node.place("slow_down_ramp"), "object")
        status_bits = read_bits(section(node, "statusword"), problems)
        status_names = _bit_names(status_bits, objects)
        reader = _Recipes(objects, pds_states, pds_commands, status_names, errata, problems)
        found.append(
            Mode(
                name=name,
                code=number.code,
                short=number.short,
                title=number.title,
                bit=number.bit,
                text=node["text"],
                control_bits=read_bits(section(node, "controlword"), problems),
                status_bits=status_bits,
                objects=tuple(node.get("objects", ())),
                slow_down_ramp=ramp,
                recipes=tuple(reader.recipe(key, item) for key, item in section(node, "recipes").items()),
                source=sources(node),
                place=node.where,
            )
        )
    return tuple(sorted(found, key=lambda mode: mode.code))


def _bit_names(status_bits: tuple[Bit, ...], objects: Mapping[str, Object]) -> frozenset[str]:
    """The statusword bits that a recipe of this mode may wait for: the general ones and those of the mode."""
    general = objects["statusword"].entries[0].bits if "statusword" in objects else ()
    return frozenset(bit.name for bit in (*general, *status_bits))


class _Recipes:
    """Reads recipes against the names that their steps may use."""

    def __init__(
        self,
        objects: Mapping[str, Object],
        pds_states: frozenset[str],
        pds_commands: frozenset[str],
        status_bits: frozenset[str],
        errata: frozenset[str],
        problems: Problems,
    ) -> None:
        self.objects = objects
        self.pds_states = pds_states
        self.pds_commands = pds_commands
        self.status_bits = status_bits
        self.errata = errata
        self.problems = problems

    def recipe(self, name: str, node: Node) -> Recipe:
        steps = tuple(self.step(item) for item in node["steps"])
        return Recipe(name, node["title"], node["text"], steps, sources(node), node.where)

    def step(self, node: Node) -> Step:
        arguments: list[tuple[str, int | str]] = []
        text, added = node.get("text", ""), node.get("added", "")
        if added and added not in self.errata:
            self.problems.unknown(added, self.errata, node.place("added"), "erratum")
        if "write" in node:
            for name, value in node["write"].items():
                arguments.append((name, self.value(name, value, node["write"])))
            return Step("write", tuple(arguments), text, added, node.where)
        if "expect" in node:
            for name, value in node["expect"].items():
                arguments.append((name, self.expected(name, value, node["expect"])))
            return Step("expect", tuple(arguments), text, added, node.where)
        if "input" in node:
            return Step("input", tuple(node["input"].items()), text, added, node.where)
        if "command" in node:
            if node["command"] not in self.pds_commands:
                self.problems.unknown(node["command"], self.pds_commands, node.place("command"), "PDS command")
            return Step("command", (("command", node["command"]),), text, added, node.where)
        return Step("wait", (("milliseconds", node["wait"]),), text, added, node.where)

    def expected(self, name: str, value: Any, node: Node) -> int | str:
        if name == "state":
            if value not in self.pds_states:
                self.problems.unknown(value, self.pds_states, node.place(name), "PDS state")
            return str(value)
        if name == "status_bit":
            if value not in self.status_bits:
                self.problems.unknown(value, self.status_bits, node.place(name), "statusword bit")
            return str(value)
        return self.value(name, value, node)

    def value(self, name: str, value: Any, node: Node) -> int | str:
        """The number that a step writes or waits for; the name of a value of the object counts as that value."""
        object_name, _, sub_name = name.partition(".")
        obj = self.problems.look_up(self.objects, object_name, node.key_place(name), "object")
        if obj is None:
            return 0
        entries = {entry.name: entry for entry in obj.entries}
        entry = entries.get(sub_name or obj.name)
        if entry is None:
            self.problems.unknown(sub_name, entries, node.key_place(name), f"sub-index of `{object_name}` called")
            return 0
        if isinstance(value, int):
            return value
        named = {item.name: item.value for item in entry.values}
        return self.problems.look_up(named, value, node.place(name), f"value of `{name}` called") or 0


def resolve_homing(spec: Node) -> tuple[HomingMethod, ...]:
    """The homing methods, ascending by number."""
    methods = (
        HomingMethod(
            name=name,
            method=node["method"],
            title=node["title"],
            text=node["text"],
            switch=node["switch"],
            direction=_DIRECTIONS[node["direction"]],
            edge=_DIRECTIONS[node["edge"]],
            index_pulse=node["index_pulse"],
            reverse_at=node["reverse_at"],
            needs_power=node["needs_power"],
            source=sources(node),
            place=node.where,
        )
        for name, node in section(spec, "homing_methods").items()
    )
    return tuple(sorted(methods, key=lambda method: method.method))


def resolve_ramp(spec: Node, objects: Mapping[str, Object], problems: Problems) -> tuple[RampParameter, ...]:
    """The parameters of the ramp generator in the order in which they are written."""
    found = []
    for name, node in section(spec, "ramp").items():
        problems.look_up(objects, node["object"], node.place("object"), "object")
        found.append(RampParameter(name, node["symbol"], node["object"], node["text"], sources(node), node.where))
    return tuple(found)


def resolve_emergencies(
    spec: Node, vocabulary: Mapping[str, Any], objects: Iterable[Object], problems: Problems
) -> tuple[Emergency, ...]:
    """The emergency rows in the order of the table."""
    found = []
    entries = (entry for obj in objects for entry in obj.entries if entry.role == "driver_error_flags")
    flags = {bit.name: bit.mask for entry in entries for bit in entry.bits}
    for node in spec.get("emergencies") or ():
        for position, bit in enumerate(node["register"]):
            problems.look_up(vocabulary["register_bits"], bit, node["register"].place(position), "error register bit")
        problems.look_up(vocabulary["conditions"], node["condition"], node.place("condition"), "condition")
        problems.look_up(vocabulary["reactions"], node["reaction"], node.place("reaction"), "reaction")
        if "driver_flag" in node:
            problems.look_up(flags, node["driver_flag"], node.place("driver_flag"), "driver error flag")
        found.append(
            Emergency(
                name=node["name"],
                code=node["code"],
                title=node["title"],
                bytes=tuple(node["bytes"]),
                register=tuple(node["register"]),
                condition=node["condition"],
                reaction=node["reaction"],
                momentary=node.get("momentary", False),
                driver_flag=flags.get(node.get("driver_flag", ""), 0),
                cause=node["cause"],
                remedy=node["remedy"],
                source=sources(node),
                place=node.where,
            )
        )
    return tuple(found)
