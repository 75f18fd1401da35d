"""Small data sheets, and findings in them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from odsmith.eds_file import parse
from odsmith.errors import Diagnostic
from odsmith.lint import lint

Found = Callable[..., tuple[Diagnostic, ...]]


@pytest.fixture
def found() -> Found:
    """`found(text, "L421")` gives the findings of some rules, or of all, in a text that need not be a whole file."""

    def look(text: str, *rules: str, name: str = "a.eds") -> tuple[Diagnostic, ...]:
        findings = lint(parse(text.replace("\n", "\r\n").encode("utf-8"), name))
        return tuple(finding for finding in findings if finding.rule in rules or not rules)

    return look
