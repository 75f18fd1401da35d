"""`odsmith coverage`: what it prints, what it says to machines, and its exit status."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from odsmith.cli import main

HERE = Path(__file__).parent


class Result(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Result]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """`run(...)` runs `odsmith coverage` in this process."""

    def call(*arguments: str | Path) -> Result:
        status = main(["coverage", *map(str, arguments)])
        return Result(status, *capsys.readouterr())

    return call


@pytest.fixture
def spec(copies: Path) -> Path:
    """A copy of the made-up device that may be changed, with its manual beside."""
    folder = copies / "coverage"
    folder.mkdir()
    for name in ("covered.yaml", "manual.txt"):
        shutil.copy(HERE / name, folder)
    return folder / "covered.yaml"


def test_text(run: Run) -> None:
    status, out, err = run(HERE / "covered.yaml")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == "TOY-2: TOY-2 Operating Manual, V1.1"
    assert lines[2].split() == ["section", "title", "status", "errata", "modelled", "by"]
    switches = next(line for line in lines if line.startswith("2.1 "))
    assert switches.split() == ["2.1", "Switches", "modelled", "E1", "objects.store,", "objects.switches"]
    assert "22     modelled       E4      abort_codes (31)" in lines
    assert "1      without facts          Abbreviations." in lines
    assert lines[-3:] == [
        "sections      15 of 15 accounted for (100 %): 12 modelled, 1 without facts, 2 in its sections",
        "tables        28 of 28 accounted for (100 %): 26 modelled, 2 without facts",
        "elements      165, 165 of them say where they come from",
    ]


def test_text_with_the_manual(run: Run) -> None:
    status, out, _ = run(HERE / "covered.yaml", "--manual", HERE / "manual.txt")
    assert status == 0
    lines = (HERE / "manual.txt").read_text(encoding="utf-8").split("\n")
    place = lines.index("2001 _h\tCurrent\tVariable\tUNSIGNED16") + 1
    row = next(line for line in out.splitlines() if line.startswith("E1 "))
    assert f"manual.txt:{place} " in row
    assert row.split()[2:] == ["5", "name", "Current", "Limit", "switches"]
    assert "cells         249 in 26 tables: 214 as the manual prints them, 35 otherwise by 6 errata, 0 otherwise" in out
    assert "not compared  tables 1, 24" in out


def test_a_difference_is_an_error(spec: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(spec.parent)
    manual = Path("manual.txt")
    manual.write_text(manual.read_text(encoding="utf-8").replace("0..1000", "0..1001"), encoding="utf-8")
    status, out, err = run("covered.yaml", "--manual", "manual.txt")
    assert (status, err) == (1, "")
    line = manual.read_text(encoding="utf-8").split("\n").index("1\tFast speed\trw\tno\t0..1001\t500 (fast)") + 1
    assert f"manual.txt:{line}:20: error[E703]: table 8, range: the manual prints `0..1001`" in out
    assert "\n    1\\tFast speed\\trw\\tno\\t0..1001\\t500 (fast)\n" in out  # the line of the manual, made visible
    assert "otherwise by 6 errata, 1 otherwise without a reason" in out


def test_a_table_that_is_not_accounted_for_is_an_error(spec: Path, run: Run) -> None:
    spec.write_text(spec.read_text(encoding="utf-8").replace("    tables: 28\n", "    tables: 29\n"), encoding="utf-8")
    status, out, _ = run(spec)
    assert status == 1
    assert "error[E701]: table 29 is neither modelled nor listed as without facts" in out
    assert "tables        28 of 29 accounted for (96 %)" in out


def test_a_warning_is_no_error(spec: Path, run: Run) -> None:
    text = spec.read_text(encoding="utf-8").replace("tables: [24], reason", "tables: [24, 5], reason")
    spec.write_text(text, encoding="utf-8")
    status, out, _ = run(spec)
    assert status == 0
    assert "warning[W701]: table 5 is listed as without facts, and `objects.switches` comes from it" in out


def test_json(run: Run) -> None:
    status, out, _ = run(HERE / "covered.yaml", "--manual", HERE / "manual.txt", "--json")
    found: dict[str, Any] = json.loads(out)[0]
    assert status == 0
    assert (found["device"], found["manual"], found["findings"]) == ("toy", "TOY-2 Operating Manual, V1.1", [])
    assert (found["tables"]["count"], found["tables"]["covered"]) == (28, 28)
    assert found["tables"]["lines"][0] == {
        "number": "1", "status": "without facts", "elements": [], "errata": [], "reason": "Abbreviations."
    }  # fmt: skip
    assert found["sections"]["lines"][3]["title"] == "Objects"
    compared = found["comparison"]
    assert compared["cells"] == compared["equal"] + len(compared["by_erratum"])
    assert compared["unexplained"] == []
    first = compared["by_erratum"][0]
    assert (first["table"], first["printed"], first["modelled"], first["errata"]) == (
        5, "Current", "Limit switches", ["E1"]
    )  # fmt: skip
    assert first["paths"] == ["objects.switches.title"]


def test_json_without_the_manual(run: Run) -> None:
    found: dict[str, Any] = json.loads(run(HERE / "covered.yaml", "--json").out)[0]
    assert "comparison" not in found


def test_on_a_terminal(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "120")
    assert "┃" in run(HERE / "covered.yaml").out


def test_a_device_whose_manual_nobody_describes(run: Run, root: Path) -> None:
    status, _, err = run(root / "tests" / "golden" / "toy.yaml")
    assert status == 2
    assert err == (
        "odsmith: error: the spec does not say what the manual of TOY-2 contains\nhint: describe it in `manuals`\n"
    )


def test_one_manual_is_of_one_device(run: Run, spec: Path) -> None:
    copy = spec.with_name("other.yaml")
    text = spec.read_text(encoding="utf-8").replace("  toy:\n", "  other:\n")
    text = text.replace("  device:\n", "  device:\n    identifier: other\n", 1)
    copy.write_text(text, encoding="utf-8")
    status, _, err = run(spec, copy, "--manual", HERE / "manual.txt")
    assert status == 2
    assert "one manual is of one device" in err


def test_what_is_no_manual(run: Run, tmp_path: Path) -> None:
    assert run(HERE / "covered.yaml", "--manual", tmp_path / "none.txt").status == 2
    wrong = tmp_path / "wrong.txt"
    wrong.write_text("Another device\n\nTable 1: A\n")
    status, _, err = run(HERE / "covered.yaml", "--manual", wrong)
    assert status == 2
    assert "wrong.txt is not the manual of the TOY-2\nhint: it is `Another device`\n" in err
