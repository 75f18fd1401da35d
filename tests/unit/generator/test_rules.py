"""The registry of rules: complete, in order, and every diagnostic takes its severity and hint from it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import odsmith
from odsmith.backends.docs import DocsBackend
from odsmith.canopen_types import Place
from odsmith.rules import RULES, diagnose, rule
from odsmith.vocabulary import Vocabulary

HERE = Place("a.yaml", 1, 2)


def test_ids_are_unique_sorted_and_fit_their_severity() -> None:
    assert list(RULES) == sorted(RULES)
    for rule_id, found in RULES.items():
        assert found.id == rule_id
        assert re.fullmatch(r"E[1-47]\d\d|L[1-6]\d\d|W[57]\d\d", rule_id)
        if not rule_id.startswith(
            "L"
        ):  # a data sheet has no phases, so that its rules are ordered by what they are about
            assert (found.severity == "error") == rule_id.startswith("E")


def test_every_rule_explains_itself() -> None:
    for found in RULES.values():
        assert found.title
        assert found.title == found.title.strip(" .")
        assert found.explanation.endswith("."), found.id
        assert not found.hint.endswith("."), found.id


def test_an_id_is_given_once() -> None:
    with pytest.raises(ValueError, match="E101"):
        rule("E101", "error", "title", "Explanation.")
    assert RULES["E101"].title != "title"


def test_diagnose_uses_the_rule() -> None:
    found = diagnose("E210", HERE, "message")
    assert (found.rule, found.severity, found.place, found.length) == ("E210", "error", HERE, 0)
    assert found.hint == RULES["E210"].hint != ""
    assert diagnose("E210", HERE, "message", "better").hint == "better"
    assert diagnose("W501", HERE, "message").severity == "warning"


def test_every_rule_is_used_and_every_used_rule_exists() -> None:
    folder = Path(odsmith.__file__).parent
    sources = "".join(path.read_text("utf-8") for path in folder.rglob("*.py") if path.name != "rules.py")
    used = set(re.findall(r'"([ELW]\d{3})"', sources))
    assert used == set(RULES)


def test_every_rule_has_a_row_and_a_page_in_the_reference(vocabulary: Vocabulary) -> None:
    pages = {
        output.path.split("/docs/", 1)[1]: output.content.decode("utf-8") for output in DocsBackend().render(vocabulary)
    }
    rows = re.findall(r'^\| <a id="(\w+)"></a>\[\1\]\(rules/\1\.md\) \|', pages["rules.md"], re.MULTILINE)
    assert rows == list(RULES)
    for known in RULES.values():
        page = pages[f"rules/{known.id}.md"]
        assert f"\n# {known.id} " in page
        assert f"Severity: {known.severity}." in page
