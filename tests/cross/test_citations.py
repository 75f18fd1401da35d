"""Each scenario says where the answers come from that it expects, in the forms of PROTOCOL.md, and that is there."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.cross.scenario import all_scenarios

from odsmith.model import Device

Known = Callable[[str], bool]

SOURCE = re.compile(r"M (?=\d)|CiA 301, |CiA 303-3|CiA 40[12], |CONTRACT: |PROTOCOL: |effect |erratum |vendor's EDS, ")
"""What a part of a citation begins with; the places behind it are separated by commas."""

CLAUSE = re.compile(r"7(\.[1-9]\d*){1,5}|table [1-9]\d*")
"""Of CiA 301, whose contents are in no list here."""


def _header(path: Path) -> str:
    """The comment at the beginning of a scenario, as one line."""
    lines = path.read_text().splitlines()
    end = next(number for number, line in enumerate(lines) if not line.startswith("#"))
    return " ".join(line.removeprefix("#").strip() for line in lines[:end])


def _citations(header: str) -> list[tuple[str, tuple[str, ...]]]:
    """Sources with the places in them, of all brackets that begin with a source. Raises ValueError for other parts."""
    found: list[tuple[str, tuple[str, ...]]] = []
    for group in re.findall(r"\(([^()]*)\)", header):
        if not SOURCE.match(group):
            continue
        for part in group.split("; "):
            if not (source := SOURCE.match(part)):
                raise ValueError(f"{part!r} is no citation")
            places = part[source.end() :]
            found.append((source[0].strip(" :,"), tuple(places.split(", ")) if places else ()))
    return found


def _headings(page: Path) -> set[str]:
    """Those of a page, and the bold lines that stand for some."""
    return set(re.findall(r"^(?:#+ |\*\*)(.+?)(?:\*\*)?$", page.read_text(), re.M))


@pytest.fixture(scope="module")
def known(tmcm3230: Device, tmcm6212: Device, root: Path) -> dict[str, Known]:
    """For each source, whether it has such a place."""
    manual = tmcm3230.manual
    assert manual is not None
    inside = {*manual.sections, *(f"table {number}" for number in range(1, manual.tables + 1))}
    contract, protocol = _headings(root / "CONTRACT.md"), _headings(Path(__file__).with_name("PROTOCOL.md"))
    errata = {erratum.id for device in (tmcm3230, tmcm6212) for erratum in device.errata}
    indices = {f"{obj.index:04X}h" for obj in tmcm6212.expanded}
    return {
        "M": lambda place: place in inside or re.fullmatch(r"figure ([1-9]|1[0-5])", place) is not None,
        "CiA 301": lambda place: CLAUSE.fullmatch(place) is not None,
        "CiA 303-3": lambda place: False,
        "CiA 401": lambda place: re.fullmatch(r"(objects? )?6[0-9A-F]{3}h", place) is not None,
        "CiA 402": lambda place: re.fullmatch(r"[\w ]+", place) is not None,
        "CONTRACT": lambda place: place in contract,
        "PROTOCOL": lambda place: place in protocol,
        "effect": lambda place: place in tmcm3230.effects,
        "erratum": lambda place: place in errata,
        "vendor's EDS": lambda place: place in indices,
    }


def _complaints(header: str, known: dict[str, Known]) -> list[str]:
    """What is wrong with the citations of a header."""
    try:
        citations = _citations(header)
    except ValueError as error:
        return [str(error)]
    if not citations:
        return ["cites nothing"]
    return [
        f"{source} has no {place!r}" for source, places in citations for place in places if not known[source](place)
    ]


def test_each_scenario_cites_where_it_comes_from(known: dict[str, Known]) -> None:
    headers = {scenario.name: _header(scenario.path) for scenario in all_scenarios()}
    wrong = [f"{name}: {complaint}" for name, header in headers.items() for complaint in _complaints(header, known)]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("header", "complaints"),
    [
        ("Method 3 (CiA 402, method 3; M 8.1.3; CONTRACT: Homing).", []),
        ("Table and figure (M 11, table 345, figure 8) of a page (PROTOCOL: Power).", []),
        ("Nothing (see the manual).", ["cites nothing"]),
        ("A form of its own (M 2.2; manual, 2.3).", ["'manual, 2.3' is no citation"]),
        ("No section (M 4.2.61, 2.2).", ["M has no '4.2.61'"]),
        ("No table (M 11, table 349).", ["M has no 'table 349'"]),
        ("No heading (CONTRACT: Axes, Axis).", ["CONTRACT has no 'Axis'"]),
        ("No clause (CiA 301, 1.2).", ["CiA 301 has no '1.2'"]),
        ("Unknown names (effect magic; erratum E999).", ["effect has no 'magic'", "erratum has no 'E999'"]),
        ("No such object (vendor's EDS, 1580h).", ["vendor's EDS has no '1580h'"]),
    ],
)
def test_what_is_no_citation_is_found(header: str, complaints: list[str], known: dict[str, Known]) -> None:
    assert _complaints(header, known) == complaints
