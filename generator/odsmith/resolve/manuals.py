"""Resolve what manuals contain."""

from __future__ import annotations

from collections.abc import Iterator

from odsmith.canopen_types import Place
from odsmith.manual import Manual, Restated, WithoutFacts, section_key, section_numbers
from odsmith.resolve.problems import Node, Problems, section


def resolve_manuals(spec: Node, problems: Problems) -> dict[str, Manual]:
    """The manuals by name. Sections that one shares with the manual of its family take their titles from there."""
    nodes = section(spec, "manuals")
    return {name: _manual(name, node, nodes, problems) for name, node in nodes.items()}


def _manual(name: str, node: Node, nodes: Node, problems: Problems) -> Manual:
    family = node.get("family", "")
    there = problems.look_up(nodes, family, node.place("family"), "manual") if family else None
    titles = dict(node["sections"])
    shared = dict(_shared_sections(section(node, "as_in_family", "sections"), problems))
    for number, (other, place) in shared.items():
        title = problems.look_up(there["sections"], other, place, f"section of `{family}`") if there else None
        titles.setdefault(number, title or other)
    tables = section(node, "as_in_family", "tables")
    return Manual(
        name=name,
        sections={number: titles[number] for number in sorted(titles, key=section_key)},
        tables=node["tables"],
        family=family,
        sections_there={number: other for number, (other, _) in shared.items()},
        tables_there={int(number, 0): other for number, other in tables.items()},
        restated=tuple(
            Restated(_sections(item, problems), tuple(item.get("tables", ())), tuple(item["paths"]), item.where)
            for item in node.get("restated", ())
        ),
        without_facts=tuple(
            WithoutFacts(_sections(item, problems), tuple(item.get("tables", ())), item["reason"], item.where)
            for item in node.get("without_facts", ())
        ),
        cut_off=node.get("cut_off", ""),
        place=node.where,
    )


def _shared_sections(node: Node, problems: Problems) -> Iterator[tuple[str, tuple[str, Place]]]:
    """Each section here with the one that it is in the family's manual."""
    for here, there in node.items():
        numbers, others = _numbers(here, node.key_place(here), problems), _numbers(there, node.place(here), problems)
        if len(numbers) != len(others):
            problems.report(
                "E301",
                node.place(here),
                f"{len(numbers)} sections cannot be {len(others)} in another manual",
                "name as many there as here",
            )
        yield from zip(numbers, ((other, node.place(here)) for other in others), strict=False)


def _sections(node: Node, problems: Problems) -> tuple[str, ...]:
    items = node.get("sections", ())
    return tuple(number for i, text in enumerate(items) for number in _numbers(text, items.place(i), problems))


def _numbers(text: str, place: Place, problems: Problems) -> tuple[str, ...]:
    try:
        return section_numbers(text)
    except ValueError as error:
        problems.report("E301", place, str(error), "write it as 4.2.6, or as 4.2.6-4.2.9")
        return ()
