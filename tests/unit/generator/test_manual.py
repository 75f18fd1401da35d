"""What a manual contains, and how sources name its sections."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from odsmith.errors import Diagnostic
from odsmith.manual import section_key, section_numbers
from odsmith.model import Device

DEVICE = """
manuals:
  family:
    tables: 3
    sections: {"1": One, "1.1": One one, "1.2": One two, "1.10": One ten, "2": Two}
    restated:
      - {sections: ["1.1-1.2"], tables: [2], paths: [device]}
    without_facts:
      - {sections: ["2"], tables: [3], reason: Nothing.}
  toy:
    family: family
    cut_off: The rest.
    tables: 1
    sections: {"2.3": Our own}
    as_in_family:
      sections: {"1-2": "1-2", "2.1-2.2": "1.1-1.2", "2.4": "1.10"}
      tables: {"1": 2}
"""


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("4.2.6", ("4.2.6",)),
        ("11", ("11",)),
        ("3.1.18-3.1.20, 4.1", ("3.1.18", "3.1.19", "3.1.20", "4.1")),
        ("1 - 3", ("1", "2", "3")),
        ("title page, 1.1", ("1.1",)),
        ("", ()),
    ],
)
def test_sections_of_a_source(text: str, numbers: tuple[str, ...]) -> None:
    assert section_numbers(text) == numbers


@pytest.mark.parametrize("text", ["chapter 4", "4.", "0.1", "4.2-5.3", "4.3-4.2", "4-4.2", "4..2"])
def test_what_is_no_section(text: str) -> None:
    with pytest.raises(ValueError, match="is no"):
        section_numbers(text)


def test_sections_sort_as_numbers() -> None:
    assert sorted(["3.10", "3.9", "3", "10"], key=section_key) == ["3", "3.9", "3.10", "10"]


def test_titles_come_from_the_family(device_of: Callable[[str], Device]) -> None:
    device = device_of(DEVICE)
    manual = device.manual
    assert manual is device.manuals["toy"]
    assert dict(manual.sections) == {
        "1": "One", "2": "Two", "2.1": "One one", "2.2": "One two", "2.3": "Our own", "2.4": "One ten"
    }  # fmt: skip
    assert list(manual.sections) == ["1", "2", "2.1", "2.2", "2.3", "2.4"]
    assert manual.sections_there == {"1": "1", "2": "2", "2.1": "1.1", "2.2": "1.2", "2.4": "1.10"}
    assert manual.tables_there == {1: 2}
    family = device.manuals["family"]
    assert family.restated[0].sections == ("1.1", "1.2")
    assert (family.without_facts[0].sections, family.without_facts[0].reason) == (("2",), "Nothing.")


def test_without_manuals(device_of: Callable[[str], Device]) -> None:
    device = device_of("")
    assert device.manual is None
    assert device.manuals == {}


@pytest.mark.parametrize(
    ("old", "new", "rule", "message"),
    [
        ("family: family", "family: famly", "E302", "there is no manual `famly`"),
        ('"2.4": "1.10"', '"2.4": "1.11"', "E302", "there is no section of `family` `1.11`"),
        ('"2.1-2.2": "1.1-1.2"', '"2.1-2.2": "1.1"', "E301", "2 sections cannot be 1 in another manual"),
        ('["1.1-1.2"]', '["1.2-1.1"]', "E301", "`1.2-1.1` is no range of neighbouring sections"),
    ],
)
def test_what_leads_nowhere(
    old: str, new: str, rule: str, message: str, findings_of: Callable[[str], tuple[Diagnostic, ...]]
) -> None:
    assert (rule, message) in [(finding.rule, finding.message) for finding in findings_of(DEVICE.replace(old, new))]
