"""Findings as SARIF 2.1.0, which code hosts and editors show beside the lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import version
from typing import Any
from urllib.parse import quote

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, Fix, shown_path
from odsmith.rules import RULES, Rule

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def sarif(findings: Iterable[Diagnostic]) -> dict[str, Any]:
    """The log of one run. Columns count characters, from 1, and the end of a region lies outside it."""
    found = list(findings)
    used = sorted({finding.rule for finding in found})
    numbers = {rule: number for number, rule in enumerate(used)}
    return {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "odsmith",
                        "version": version("odsmith"),
                        "rules": [_rule(RULES[rule]) for rule in used],
                    }
                },
                "columnKind": "unicodeCodePoints",
                "results": [_result(finding, numbers) for finding in found],
            }
        ],
    }


def _rule(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.id,
        "name": "".join(word.capitalize() for word in rule.title.split()),
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": rule.explanation},
        "defaultConfiguration": {"level": rule.severity},
        **({"help": {"text": rule.hint}} if rule.hint else {}),
    }


def _result(finding: Diagnostic, numbers: Mapping[str, int]) -> dict[str, Any]:
    location = _location(finding.place, finding.length)
    if finding.subject:
        location["logicalLocations"] = [{"fullyQualifiedName": finding.subject}]
    result: dict[str, Any] = {
        "ruleId": finding.rule,
        "ruleIndex": numbers[finding.rule],
        "level": finding.severity,
        "message": {"text": finding.message},
        "locations": [location],
    }
    if finding.notes:
        result["relatedLocations"] = [
            {"id": number, **_location(place, 0), "message": {"text": text}}
            for number, (place, text) in enumerate(finding.notes, 1)
        ]
    if finding.fix:
        result["fixes"] = [_fix(finding.fix, finding.place)]
    return result


def _location(place: Place, length: int) -> dict[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": _artifact(place)}
    if place.line:
        region = {"startLine": place.line, "startColumn": max(place.column, 1)}
        if length:
            region["endColumn"] = region["startColumn"] + length
        physical["region"] = region
    return {"physicalLocation": physical}


def _artifact(place: Place) -> dict[str, str]:
    return {"uri": quote(shown_path(place.path).replace("\\", "/"))}


def _fix(fix: Fix, place: Place) -> dict[str, Any]:
    """Whole lines: from the first column of the first one to that of the line behind the last one."""
    region = {"startLine": fix.first, "startColumn": 1, "endLine": fix.last + 1, "endColumn": 1}
    replacement: dict[str, Any] = {"deletedRegion": region}
    if fix.lines:
        replacement["insertedContent"] = {"text": "".join(f"{line}\r\n" for line in fix.lines)}
    return {
        "description": {"text": str(fix)},
        "artifactChanges": [{"artifactLocation": _artifact(place), "replacements": [replacement]}],
    }
