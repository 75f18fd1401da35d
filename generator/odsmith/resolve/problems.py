"""What goes wrong while a model is resolved, collected so that one run shows all of it."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from odsmith.canopen_types import Place, Source
from odsmith.errors import Diagnostic, SpecError
from odsmith.fields import FieldError
from odsmith.load import Map
from odsmith.rules import diagnose

Node = Any
"""A `load.Map`. The schema has proven its shape, so it is read without asking for types again."""

NOTHING = Map("<none>", 0, 0)

T = TypeVar("T")
V = TypeVar("V")


class Problems:
    """A list of diagnostics with the ways to add to it."""

    def __init__(self) -> None:
        self.found: list[Diagnostic] = []

    def report(
        self, rule: str, place: Place, message: str, hint: str = "", notes: tuple[tuple[Place, str], ...] = ()
    ) -> None:
        self.found.append(diagnose(rule, place, message, hint, notes=notes))

    def stop_if_any(self) -> None:
        """Raise SpecError with everything found so far, if anything was."""
        if self.found:
            raise SpecError(self.found)

    def read(self, parse: Callable[..., T], place: Place, *arguments: Any, otherwise: T) -> T:
        """Call a parser of `odsmith.fields`; a FieldError becomes a diagnostic and `otherwise` the result."""
        try:
            return parse(*arguments)
        except FieldError as error:
            self.report("E301", place, str(error), error.hint)
            return otherwise

    def look_up(self, table: Mapping[str, V], name: str, place: Place, what: str) -> V | None:
        """The element called `name`; None after a diagnostic where there is none."""
        if name in table:
            return table[name]
        self.unknown(name, table, place, what)
        return None

    def unknown(self, name: str, known: Iterable[str], place: Place, what: str) -> None:
        """Report a reference to something that the spec does not define."""
        names = sorted(known)
        close = difflib.get_close_matches(name, names, 1)
        if close:
            hint = f"did you mean `{close[0]}`?"
        elif names and len(names) <= 12:
            hint = f"known: {', '.join(names)}"
        else:
            hint = "define it, or include the file that does"
        self.report("E302", place, f"there is no {what} `{name}`", hint)


def sources(node: Node) -> tuple[Source, ...]:
    """The sources of an element; a mapping that combines authorities gives one Source for each."""
    value = node.get("source")
    if value is None:
        return ()
    found: list[Source] = []
    for item in value if isinstance(value, list) else [value]:
        if {"section", "tables", "figures"} & item.keys():
            found.append(
                Source(
                    "manual",
                    section=str(item.get("section", "")),
                    tables=tuple(item.get("tables", ())),
                    figures=tuple(item.get("figures", ())),
                )
            )
        if "own_section" in item:
            found.append(Source("own_manual", section=str(item["own_section"])))
        found += [
            Source(kind, clause=str(item[kind]))
            for kind in ("vendor_eds", "cia301", "cia303", "cia306", "cia401", "cia402")
            if kind in item
        ]
        if "inferred" in item:
            found.append(Source("inferred", note=item["inferred"]))
    return tuple(found)


def words(value: Any) -> tuple[str, ...]:
    """One word or a list of them, as a tuple; nothing for None."""
    if value is None:
        return ()
    return tuple(value) if isinstance(value, list) else (value,)


def section(node: Node, *keys: str) -> Node:
    """A nested section, or an empty one where the spec has none."""
    current: Any = node
    for key in keys:
        current = current.get(key)
        if current is None:
            return NOTHING
    return current
