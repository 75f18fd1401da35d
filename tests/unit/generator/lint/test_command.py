"""`odsmith lint` on data sheets: formats, exit status, and nothing to say about what we generate."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.cli import main
from odsmith.eds_file import parse, read
from odsmith.lint import lint
from odsmith.model import Device

Run = Callable[..., tuple[int, str, str]]

NOTE = ("HighLimit=3\r\nDefaultValue=-3", "HighLimit=0x3\r\nDefaultValue=-3")
WARNING = ("EDSVersion=4.0", "EDSVersion=3.0")
ERROR = ("DefaultValue=-3", "DefaultValue=0xFD")

# What SARIF 2.1.0 demands of the parts that we write (clauses 3.13, 3.14, 3.18, 3.19, 3.27 to 3.30, 3.49, 3.55).
TEXT = {
    "type": "object",
    "required": ["text"],
    "properties": {"text": {"type": "string"}},
    "additionalProperties": False,
}
NUMBER = {"type": "integer", "minimum": 1}
ARTIFACT = {
    "type": "object",
    "required": ["uri"],
    "properties": {"uri": {"type": "string", "format": "uri-reference"}},
    "additionalProperties": False,
}
REGION = {
    "type": "object",
    "required": ["startLine"],
    "properties": dict.fromkeys(("startLine", "startColumn", "endLine", "endColumn"), NUMBER),
    "additionalProperties": False,
}
LOCATION = {
    "type": "object",
    "required": ["physicalLocation"],
    "properties": {
        "id": {"type": "integer", "minimum": 0},
        "message": TEXT,
        "physicalLocation": {
            "type": "object",
            "required": ["artifactLocation"],
            "properties": {"artifactLocation": ARTIFACT, "region": REGION},
            "additionalProperties": False,
        },
        "logicalLocations": {
            "type": "array",
            "items": {"type": "object", "properties": {"fullyQualifiedName": {"type": "string"}}, "minProperties": 1},
        },
    },
    "additionalProperties": False,
}
REPLACEMENT = {
    "type": "object",
    "required": ["deletedRegion"],
    "properties": {"deletedRegion": REGION, "insertedContent": TEXT},
    "additionalProperties": False,
}
FIX = {
    "type": "object",
    "required": ["artifactChanges"],
    "properties": {
        "description": TEXT,
        "artifactChanges": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["artifactLocation", "replacements"],
                "properties": {
                    "artifactLocation": ARTIFACT,
                    "replacements": {"type": "array", "minItems": 1, "items": REPLACEMENT},
                },
                "additionalProperties": False,
            },
        },
    },
    "additionalProperties": False,
}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
RESULT = {
    "type": "object",
    "required": ["message", "ruleId", "ruleIndex", "level", "locations"],
    "properties": {
        "ruleId": {"type": "string"},
        "ruleIndex": {"type": "integer", "minimum": 0},
        "level": LEVEL,
        "message": TEXT,
        "locations": {"type": "array", "minItems": 1, "items": LOCATION},
        "relatedLocations": {"type": "array", "items": LOCATION},
        "fixes": {"type": "array", "items": FIX},
    },
    "additionalProperties": False,
}
RULE = {
    "type": "object",
    "required": ["id"],
    "properties": {
        "id": {"type": "string"},
        "name": {"type": "string", "pattern": "^[A-Za-z0-9]+$"},
        **dict.fromkeys(("shortDescription", "fullDescription", "help"), TEXT),
        "defaultConfiguration": {"type": "object", "properties": {"level": LEVEL}, "additionalProperties": False},
    },
    "additionalProperties": False,
}
DRIVER = {
    "type": "object",
    "required": ["name"],
    "properties": {
        "name": {"type": "string"},
        "version": {"type": "string"},
        "rules": {"type": "array", "uniqueItems": True, "items": RULE},
    },
    "additionalProperties": False,
}
SARIF = {
    "type": "object",
    "required": ["version", "runs"],
    "properties": {
        "$schema": {"type": "string", "format": "uri"},
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["tool", "results"],
                "properties": {
                    "tool": {"type": "object", "required": ["driver"], "properties": {"driver": DRIVER}},
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {"type": "array", "items": RESULT},
                },
                "additionalProperties": False,
            },
        },
    },
    "additionalProperties": False,
}


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`run("a.eds", ...)` gives status, stdout and stderr of the linter in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def lint_command(*arguments: str) -> tuple[int, str, str]:
        status = main(["lint", *arguments])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return lint_command


@pytest.fixture
def spoilt(tmcm3230: Device, tmp_path: Path) -> Callable[..., str]:
    """`spoilt(ERROR, ...)` writes a data sheet with faults and gives its name."""

    def write(*faults: tuple[str, str]) -> str:
        (output,) = EdsBackend().render(tmcm3230)
        text = output.content.decode("ascii")
        for old, new in faults:
            assert old in text
            text = text.replace(old, new, 1)
        path = tmp_path / Path(output.path).name
        path.write_bytes(text.encode("ascii"))
        return path.name

    return write


# ---- our own files -----------------------------------------------------------------------------------------------


def test_what_we_generate_gives_no_finding(root: Path) -> None:
    sheets = sorted((root / "generated").glob("*/eds/*.eds"))
    assert sheets
    for path in sheets:
        assert lint(read(path)) == (), path


@pytest.mark.parametrize("name", ["tmcm3230", "io_module"])
def test_what_we_would_generate_gives_no_finding(name: str, request: pytest.FixtureRequest) -> None:
    (output,) = EdsBackend().render(request.getfixturevalue(name))
    assert lint(parse(output.content, output.path)) == ()


# ---- exit status -------------------------------------------------------------------------------------------------


def test_a_good_sheet(spoilt: Callable[..., str], run: Run) -> None:
    assert run(spoilt(), "--fail-on", "note") == (0, "0 findings\n", "")


@pytest.mark.parametrize(
    ("fault", "statuses"),
    [
        (NOTE, {"note": 1, "warning": 0, "error": 0, "never": 0}),
        (WARNING, {"note": 1, "warning": 1, "error": 0, "never": 0}),
        (ERROR, {"note": 1, "warning": 1, "error": 1, "never": 0}),
    ],
)
def test_the_level_that_fails(
    fault: tuple[str, str], statuses: dict[str, int], spoilt: Callable[..., str], run: Run
) -> None:
    name = spoilt(fault)
    assert {level: run(name, "--fail-on", level)[0] for level in statuses} == statuses
    assert run(name)[0] == statuses["warning"]


def test_files_that_cannot_be_worked_on(tmp_path: Path, run: Run) -> None:
    (tmp_path / "folder.eds").mkdir()
    (tmp_path / "binary.eds").write_bytes(b"\0\1\2")
    (tmp_path / "other.dcf").write_text("format: 1\n")
    for name, rule in (("none.eds", "E101"), ("folder.eds", "E101"), ("binary.eds", "E103"), ("other.dcf", "L100")):
        for level in ("error", "never"):
            status, out, err = run(name, "--fail-on", level)
            assert (status, err) == (2, "")
            assert out.startswith(f"{name}: error[{rule}]: ")


def test_every_file_is_looked_at(spoilt: Callable[..., str], root: Path, run: Run) -> None:
    name = spoilt(WARNING)
    status, out, _ = run("none.eds", name, name, str(root / "tests" / "golden" / "toy.yaml"))
    assert status == 2
    assert out.splitlines()[0].startswith("none.eds: error[E101]")
    assert f"{name}:5:12: warning[L304]" in out
    assert out.endswith("\n2 findings\n")


def test_a_data_sheet_needs_no_project(spoilt: Callable[..., str], run: Run) -> None:
    assert run(spoilt())[0] == 0
    assert run()[0] == 2


# ---- formats -----------------------------------------------------------------------------------------------------


def test_text(spoilt: Callable[..., str], run: Run) -> None:
    status, out, err = run(spoilt(ERROR))
    lines = out.splitlines()
    assert (status, err) == (1, "")
    assert lines[0].endswith(": error[L421]: 0xFD is 253 to some readers and -3 to others, for INTEGER8")
    assert lines[1:6] == [
        "    DefaultValue=0xFD",
        "                 ^~~~",
        "object: 3230.axes.60C2:2",
        "hint: write signed types in decimal",
        "fix: DefaultValue=-3",
    ]


def test_json(spoilt: Callable[..., str], run: Run) -> None:
    name = spoilt(ERROR)
    status, out, _ = run(name, "--format", "json")
    finding = json.loads(out)[0]
    assert status == 1
    assert (finding["rule"], finding["severity"], finding["path"]) == ("L421", "error", name)
    assert (finding["object"], finding["column"]) == ("3230.axes.60C2:2", 14)
    assert finding["fix"] == {"first": finding["line"], "last": finding["line"], "lines": ["DefaultValue=-3"]}
    assert run(name, "--json")[1] == out
    assert json.loads(run("none.eds", "--format", "json")[1])[0]["rule"] == "E101"


@pytest.fixture
def log(spoilt: Callable[..., str], run: Run) -> dict[str, Any]:
    """The SARIF of a sheet with faults of each kind: a replacement, an insertion, a deletion, notes, no place."""
    unknown = ("PDOMapping=0", "PDOMapping=0\r\nUnit=none")
    missing = ("LSS_Supported=0\r\n", "")
    section = ("[DummyUsage]", "[Dummies]")
    status, out, _ = run(spoilt(ERROR, WARNING, NOTE, unknown, missing, section), "--format", "sarif")
    assert status == 1
    parsed: dict[str, Any] = json.loads(out)
    return parsed


def test_sarif_has_the_form_of_the_standard(log: dict[str, Any]) -> None:
    assert [str(error) for error in jsonschema_rs.validator_for(SARIF).iter_errors(log)] == []


def test_sarif_says_what_the_other_formats_say(log: dict[str, Any]) -> None:
    (this,) = log["runs"]
    rules = this["tool"]["driver"]["rules"]
    results = this["results"]
    assert [rule["id"] for rule in rules] == sorted({result["ruleId"] for result in results})
    for result in results:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        assert rules[result["ruleIndex"]]["defaultConfiguration"]["level"] == result["level"]
    (unsigned,) = [result for result in results if result["ruleId"] == "L421"]
    (location,) = unsigned["locations"]
    assert location["physicalLocation"]["artifactLocation"] == {"uri": "TMCM-3230.eds"}
    region = location["physicalLocation"]["region"]
    assert (region["startColumn"], region["endColumn"]) == (14, 18)
    assert location["logicalLocations"] == [{"fullyQualifiedName": "3230.axes.60C2:2"}]
    (replacement,) = unsigned["fixes"][0]["artifactChanges"][0]["replacements"]
    assert replacement["insertedContent"] == {"text": "DefaultValue=-3\r\n"}
    assert replacement["deletedRegion"] == {
        "startLine": region["startLine"],
        "startColumn": 1,
        "endLine": region["startLine"] + 1,
        "endColumn": 1,
    }


def test_sarif_of_insertions_deletions_and_whole_files(log: dict[str, Any]) -> None:
    by_rule = {result["ruleId"]: result for result in log["runs"][0]["results"]}
    (insertion,) = by_rule["L301"]["fixes"][0]["artifactChanges"][0]["replacements"]
    assert insertion["deletedRegion"]["startLine"] == insertion["deletedRegion"]["endLine"]
    assert insertion["insertedContent"] == {"text": "LSS_Supported=0\r\n"}
    (deletion,) = by_rule["L205"]["fixes"][0]["artifactChanges"][0]["replacements"]
    assert "insertedContent" not in deletion
    assert "region" not in by_rule["L203"]["locations"][0]["physicalLocation"]
    assert by_rule["L601"]["relatedLocations"]


def test_sarif_of_a_spec(root: Path, run: Run) -> None:
    status, out, _ = run(str(root / "tests" / "errors" / "default_outside_range.yaml"), "--format", "sarif")
    log = json.loads(out)
    assert status == 2
    assert jsonschema_rs.is_valid(SARIF, log)
    assert log["runs"][0]["results"][0]["level"] == "error"
