"""The tool that tests the proof: it tells what is caught from what is not, and the list of survivors is held to it."""

from __future__ import annotations

import ctypes
import os
import signal
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import ModuleType

import pytest
from tests.cross.build import run
from tests.mutants import c_code
from tests.mutants.c_code import instrument
from tests.mutants.hunt import Group, Judge, Verdict, hunt, sample
from tests.mutants.mutant import Catalogue, Mutant
from tests.mutants.py_code import HELPERS, changed
from tests.mutants.report import Report, Survivors

Check = Callable[[int], str]


class Awake:
    """What the judges of these tests look at: the number of the mutant that is awake."""

    number = 0

    def wake(self, number: int) -> None:
        self.number = number


def group(count: int, check: Check, name: str = "C tables") -> Group:
    """Mutants 1 to `count`, with one judge, who gets their numbers."""
    awake = Awake()
    catalogue = Catalogue()
    for number in range(1, count + 1):
        catalogue.add("seeded: value", "here", f"{number}")
    judge = Judge("listener", 0.0, lambda: check(awake.number))
    return Group(name, catalogue.mutants, awake.wake, lambda: [lambda _: [judge]])


def complaints(check: Check, *rows: Mapping[str, object], name: str = "C tables", count: int = 2) -> list[str]:
    report = Report(Survivors(rows), 2)
    report.hunt(group(count, check, name))
    return report.complaints()


def key(number: int) -> str:
    return f"here: value: {number}"


def only_2(number: int) -> str:
    return "scenarios" if number == 2 else ""


def test_a_mutant_that_is_caught_is_told() -> None:
    hunted = group(3, only_2)
    verdicts = {mutant.number: verdict for mutant, verdict in hunt(2, hunted, hunted.mutants)}
    assert verdicts == {1: Verdict("", ""), 2: Verdict("scenarios", "listener"), 3: Verdict("", "")}


def killed(_: int) -> str:
    os.kill(os.getpid(), signal.SIGKILL)
    return ""


def endless(_: int) -> str:
    while True:
        pass


def broken(_: int) -> str:
    raise ZeroDivisionError


@pytest.mark.parametrize("check", [killed, endless, broken])
def test_a_mutant_that_ends_its_process_or_never_answers_is_caught(
    check: Check, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tests.mutants.hunt.LEAST_PATIENCE", 0.1)
    hunted = group(1, check)
    assert [verdict.how for _, verdict in hunt(1, hunted, hunted.mutants)] == ["crash"]


def test_a_survivor_that_is_not_listed_fails() -> None:
    assert complaints(only_2) == [f"survived: {key(1)}"]


def test_a_survivor_that_is_listed_does_not_fail() -> None:
    assert complaints(only_2, {"reason": "seeded", "mutants": [key(1)]}) == []
    assert complaints(lambda _: "", {"reason": "seeded", "mutants": ["here: value: *"]}) == []


def test_a_listed_mutant_that_is_caught_fails() -> None:
    rows = {"reason": "seeded", "mutants": [key(1), key(2)]}
    assert complaints(only_2, rows) == [f"caught by listener, take it off the survivors: {key(2)}"]


def test_a_listed_mutant_that_is_not_there_fails() -> None:
    rows = {"reason": "seeded", "mutants": [key(1), "elsewhere: *"]}
    assert complaints(only_2, rows) == ["no such mutant: elsewhere: *"]


@pytest.mark.parametrize(("is_equivalent", "complains"), [(False, True), (True, False)])
def test_of_code_so_many_have_to_be_caught(is_equivalent: bool, complains: bool) -> None:
    """Mutants that nobody can tell apart do not count."""
    rows = {"reason": "seeded", "mutants": [key(number) for number in (2, 3)], "equivalent": is_equivalent}
    found = complaints(lambda number: "" if number in (2, 3) else "oracle", rows, name="C code", count=20)
    assert found == (["only 90.0% of the mutants of C code are caught"] if complains else [])


def test_a_sample_has_all_kinds_and_no_listed_mutants() -> None:
    mutants = [Mutant(f"{n}", f"kind {n % 3}", "", n) for n in range(30)]
    chosen = sample(mutants, 9)
    assert len(chosen) == 9
    assert {mutant.kind for mutant in chosen} == {"kind 0", "kind 1", "kind 2"}
    assert chosen == sample(mutants[::-1], 9)
    report = Report(Survivors([{"reason": "seeded", "mutants": [key(1)]}]), 2, sample=8)
    report.hunt(group(2, lambda number: "caught" if number == 1 else ""))
    assert report.complaints() == [f"survived: {key(2)}"]


# ---- code ------------------------------------------------------------------------------------------------------------

C = """
unsigned clamp(unsigned value, unsigned high)
{
    unsigned result = value;
    if ((value > high) || (value == 7u)) {
        result = high;
    }
    return result;
}
"""

PYTHON = """
def clamp(value: int, high: int) -> int:
    result = value
    if value > high or value == 7:
        result = high
    return result
"""

DIFFERENT = {
    "if turned": {(3, 9): 9, (7, 9): 7, (12, 9): 12},
    "if removed": {(7, 9): 7, (12, 9): 12},
    "alternative removed: 1": {(12, 9): 12},
    "alternative removed: 2": {(7, 9): 7},
    "limit moved": {},
    "comparison turned": {(3, 9): 9, (7, 9): 7},
    "statement removed": {(7, 9): 7, (12, 9): 12},
}
"""What clamp() gives in each mutant, where it differs from the original."""

CALLS = {(3, 9): 3, (7, 9): 9, (9, 9): 9, (12, 9): 9}


def differences(clamp: Callable[[int, int], int]) -> dict[tuple[int, int], int]:
    return {call: answer for call, usual in CALLS.items() if (answer := clamp(*call)) != usual}


def named(mutants: Iterable[Mutant]) -> list[tuple[str, int]]:
    """Kinds, counted where one comes several times, and numbers."""
    kinds = [mutant.kind.partition(": ")[2] for mutant in mutants]
    names = [
        f"{kind}: {kinds[: at + 1].count(kind)}" if kinds.count(kind) > 1 else kind for at, kind in enumerate(kinds)
    ]
    return list(zip(names, range(1, len(kinds) + 1), strict=True))


@pytest.mark.slow
def test_c_code_is_changed_in_each_way(tmp_path: Path) -> None:
    source = tmp_path / "clamp.c"
    source.write_text(C)
    catalogue = Catalogue()
    text = instrument([source], catalogue)["clamp.c"]
    source.write_text(f"{c_code.HEADER}int ods_mutant;\nunsigned char ods_mutant_passed[99];\n{text}")
    run(["cc", "-std=c99", "-shared", "-fPIC", str(source), "-o", str(tmp_path / "clamp.so")])
    library = ctypes.CDLL(str(tmp_path / "clamp.so"))
    awake = ctypes.c_int.in_dll(library, "ods_mutant")
    assert differences(library.clamp) == {}
    for name, number in named(catalogue.mutants):
        awake.value = number
        assert differences(library.clamp) == DIFFERENT[name], name
    assert {name for name, _ in named(catalogue.mutants)} == set(DIFFERENT)


def test_python_code_is_changed_in_each_way(tmp_path: Path) -> None:
    source = tmp_path / "clamp.py"
    source.write_text(PYTHON)
    catalogue = Catalogue()
    helpers = ModuleType("helpers")
    exec(HELPERS, helpers.__dict__)
    names: dict[str, Callable[[int, int], int]] = {"_mutant": helpers}  # type: ignore[dict-item]
    exec(compile(changed(source, catalogue), "clamp.py", "exec"), names)
    assert differences(names["clamp"]) == {}
    kinds = named(catalogue.mutants)
    for name, number in kinds:
        helpers.__dict__["awake"] = number
        if name != "statement removed: 1":  # there is nothing to return then
            assert differences(names["clamp"]) == DIFFERENT[name.removesuffix(": 2") if "statement" in name else name]
    found = {name.removesuffix(": 1") if "statement" in name else name for name, _ in kinds}
    assert found - {"statement removed: 2"} == set(DIFFERENT)
