"""The page that says what became of the manual: every section and table, linked to the elements that model it."""

from __future__ import annotations

import re
from dataclasses import replace

from odsmith.backends.docs import DocsBackend
from odsmith.model import Device


def pages(device: Device) -> dict[str, str]:
    return {output.path.rsplit("/", 1)[-1]: output.content.decode() for output in DocsBackend().render(device)}


def rows(text: str, heading: str) -> list[list[str]]:
    """The rows of the table below a heading."""
    _, _, below = text.partition(f"## {heading}\n")
    lines = (line for line in below.split("\n## ")[0].splitlines() if line.startswith("| "))
    return [line.strip("| ").split(" | ") for line in list(lines)[1:]]


def test_each_section_and_table_has_a_row(tmcm3230: Device) -> None:
    assert tmcm3230.manual
    text = pages(tmcm3230)["coverage.md"]
    assert [row[0] for row in rows(text, "Sections")] == list(tmcm3230.manual.sections)
    tables: list[int] = []
    for row in rows(text, "Tables"):
        first, _, last = row[0].partition(" to ")
        tables += range(int(first), int(last or first) + 1)
    assert tables == list(range(1, tmcm3230.manual.tables + 1))
    assert "| Tables | 348 of 348 accounted for (100 %): 343 modelled, 5 without facts |" in text


def test_rows_lead_to_elements_and_errata(tmcm3230: Device) -> None:
    found = {row[0]: row for row in rows(pages(tmcm3230)["coverage.md"], "Sections")}
    assert found["4.2.5"][2] == "[`objects.standby_current`](objects-manufacturer.md#2004h)"
    assert "[E02](errata.md#E02)" in found["4.2.5"][3]
    assert "[`emergencies`](emergencies.md) (26)" in found["11"][2]
    assert found["1.3"][2].startswith("no facts: ")
    assert found["3"][2] == "see its sections"


def test_the_html_page_has_it_too(tmcm3230: Device) -> None:
    assert tmcm3230.manual
    html = pages(tmcm3230)["index.html"]
    section = html[html.index('<section id="coverage"') :]
    section = section[: section.index("</section>")]
    assert '<a href="#2004h"><code>objects.standby_current</code></a>' in section
    assert len(re.findall("<tr>", section)) > len(tmcm3230.manual.sections)
    assert '<a href="#coverage">Coverage</a>' in html


def test_what_is_not_at_hand_is_said(tmcm3230: Device) -> None:
    assert tmcm3230.manual
    manual = replace(tmcm3230.manual, cut_off="All after <b>chapter</b> 3.", sections={"1": "A | B"}, without_facts=())
    found = pages(replace(tmcm3230, manuals={"tmcm3230": manual}))
    for text in (found["coverage.md"], found["index.html"]):
        assert "Not at hand" in text
        assert "<b>chapter" not in text
    assert rows(found["coverage.md"], "Sections")[0][0] == "1"


def test_without_contents_of_the_manual_there_is_no_page(tmcm3230: Device) -> None:
    found = pages(replace(tmcm3230, manuals={}))
    assert "coverage.md" not in found
    assert "coverage.md" not in found["README.md"]
    assert 'id="coverage"' not in found["index.html"]
