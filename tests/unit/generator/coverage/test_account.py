"""The account: each section and table of a manual is modelled, listed with a reason, or open."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from odsmith.canopen_types import Source
from odsmith.coverage.account import Account, Line, Status, account, share
from odsmith.coverage.account import covered as count
from odsmith.coverage.elements import elements
from odsmith.manual import Manual, Restated, WithoutFacts
from odsmith.model import Device

Change = Callable[[Manual], Manual]


def held(device: Device) -> Account:
    assert device.manual
    return account(device, device.manual)


def with_manual(device: Device, change: Change) -> Device:
    assert device.manual
    return replace(device, manuals={device.identifier: change(device.manual)})


def line(lines: tuple[Line, ...], number: str) -> Line:
    return next(item for item in lines if item.number == number)


def findings(found: Account) -> list[tuple[str, str]]:
    return [(finding.rule, finding.message) for finding in found.findings]


def test_everything_is_accounted_for(covered: Device) -> None:
    found = held(covered)
    assert findings(found) == []
    assert found.unsourced == ()
    assert share(found.sections) == ("15 of 15 accounted for (100 %): 12 modelled, 1 without facts, 2 in its sections")
    assert share(found.tables) == "28 of 28 accounted for (100 %): 26 modelled, 2 without facts"


def test_who_models_a_section(covered: Device) -> None:
    found = held(covered)
    switches = line(found.sections, "2.1")
    assert (switches.title, switches.status) == ("Switches", Status.MODELLED)
    assert [item.path for item in switches.elements] == ["objects.store", "objects.switches"]
    assert [item.name for item in switches.errata] == ["E1"]
    assert line(found.sections, "2").status is Status.BELOW
    assert [item.path for item in line(found.tables, "20").elements] == [
        "homing_methods.none_at_all",
        "homing_methods.left",
    ]


def test_lists_of_the_manual(covered: Device) -> None:
    found = held(covered)
    abbreviations = line(found.tables, "1")
    assert abbreviations.status is Status.WITHOUT_FACTS
    assert abbreviations.listed
    assert abbreviations.listed.reason == "Abbreviations."
    assert {item.kind for item in line(found.tables, "22").elements} == {"abort_codes"}
    assert [item.path for item in line(found.tables, "23").elements] == ["device.firmware"]


def test_a_table_that_nobody_cites_is_an_error(covered: Device) -> None:
    found = held(with_manual(covered, lambda manual: replace(manual, without_facts=manual.without_facts[:1])))
    assert findings(found) == [("E701", "table 24 is neither modelled nor listed as without facts")]
    assert count(found.tables) == 27
    assert share(found.tables) == "27 of 28 accounted for (96 %): 26 modelled, 1 without facts, 1 open"


def test_an_erratum_alone_models_nothing(covered: Device) -> None:
    """It says what a table does not; what the table does say must stand in an element."""
    objects = tuple(
        replace(obj, source=(Source("cia301"),)) if obj.name == "switches" else obj for obj in covered.objects
    )
    found = held(replace(covered, objects=objects))
    assert line(found.tables, "5").errata
    assert [finding.message.split(" is ")[0] for finding in found.findings] == ["table 4", "table 5", "table 6"]


def test_a_section_that_nobody_cites_is_a_warning(covered: Device) -> None:
    sections = {"8": "More", "8.1": "And more"}
    found = held(with_manual(covered, lambda manual: replace(manual, sections={**manual.sections, **sections})))
    assert [(finding.rule, finding.severity) for finding in found.findings] == [("W702", "warning")] * 2


def test_listed_and_modelled_is_a_warning(covered: Device) -> None:
    listed = WithoutFacts((), (5,), "Nothing.")
    found = held(with_manual(covered, lambda manual: replace(manual, without_facts=(*manual.without_facts, listed))))
    assert findings(found) == [("W701", "table 5 is listed as without facts, and `objects.switches` comes from it")]
    assert line(found.tables, "5").status is Status.MODELLED


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (Source("manual", "9.9", (5,)), "`objects.switches` cites section 9.9, which the manual does not have"),
        (Source("manual", "2.1", (4, 5, 6, 99)), "`objects.switches` cites table 99, which the manual does not have"),
        (Source("manual", "see above"), "`objects.switches` cites a section of the manual: `see above` is no section"),
        (
            Source("manual", "2.1-3.4"),
            "`objects.switches` cites a section of the manual: `2.1-3.4` is no range of neighbouring sections",
        ),
    ],
)
def test_a_source_that_leads_nowhere(source: Source, message: str, covered: Device) -> None:
    objects = tuple(replace(obj, source=(source,)) if obj.name == "switches" else obj for obj in covered.objects)
    assert ("E702", message) in findings(held(replace(covered, objects=objects)))


def test_a_list_that_leads_nowhere(covered: Device) -> None:
    restated = Restated(("3",), (), ("nothing.of_the_kind",))
    found = held(with_manual(covered, lambda manual: replace(manual, restated=(*manual.restated, restated))))
    assert findings(found) == [("E702", "`nothing.of_the_kind` restates the manual, and there is no such element")]


def test_an_element_without_a_source_is_said(covered: Device) -> None:
    ramp = tuple(replace(parameter, source=()) for parameter in covered.ramp)
    found = held(replace(covered, ramp=ramp))
    assert [item.path for item in found.unsourced] == ["ramp.v_max"]
    assert ("W703", "`ramp.v_max` does not say where it comes from") in findings(found)


# ---- the manual of a sister device -----------------------------------------------------------------------------------


@pytest.fixture
def sister(covered: Device) -> Device:
    """The same device, whose own manual has a chapter more in front and one section that the family lacks."""
    assert covered.manual
    family = replace(covered.manual, name="family")
    own = Manual(
        name="toy",
        sections={"1": "New", "2": "Objects", "2.1": "Switches", "2.2": "Encoder"},
        tables=2,
        family="family",
        sections_there={"2": "2", "2.1": "2.1"},
        tables_there={1: 1, 2: 5},
        without_facts=(WithoutFacts(("1",), (), "Praise."),),
        cut_off="All after section 2.2.",
    )
    return replace(covered, manuals={"family": family, "toy": own})


def test_what_the_family_s_manual_says_counts_for_its_sister(sister: Device) -> None:
    found = held(sister)
    assert [(item.number, item.status.value) for item in found.sections] == [
        ("1", "without facts"), ("2", "open"), ("2.1", "modelled"), ("2.2", "open")
    ]  # fmt: skip
    assert [item.path for item in line(found.sections, "2.1").elements] == ["objects.store", "objects.switches"]
    assert [(item.number, item.status.value) for item in found.tables] == [("1", "without facts"), ("2", "modelled")]


def test_the_own_manual_is_cited_by_its_own_numbers(sister: Device) -> None:
    source = (Source("own_manual", "2.2"), Source("own_manual", "title page"))
    objects = tuple(replace(obj, source=source) if obj.name == "direction" else obj for obj in sister.objects)
    found = held(replace(sister, objects=objects))
    assert [item.path for item in line(found.sections, "2.2").elements] == ["objects.direction"]
    assert line(found.sections, "2").status is Status.BELOW
    assert not any(rule == "E702" for rule, _ in findings(found))


# ---- elements --------------------------------------------------------------------------------------------------------


def test_elements_are_what_errata_call_them(drive: Device) -> None:
    paths = [item.path for item in elements(drive)]
    assert len(paths) == len(set(paths))
    assert {
        "objects.controlword",
        "objects.history.subs.2",
        "pdos.rpdo.1",
        "modes.profile_position.recipes.move",
        "pds.transitions.16",
        "emergencies.overrun",
        "errata.E10",
        "axes.areas.profile",
        "device",
    } <= set(paths)
    assert "objects.history.subs.1" not in paths  # its source is that of the object
