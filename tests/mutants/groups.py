"""All mutants that there are, with those who judge them.

Three judges listen to a talk: what the scenario says that was worked out by hand, or what the oracle works out from the
specification; and then the other runtime, which has to say the same word for word. Tables are compared with the model,
too, row by row.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from tests.cross.devices import ROOT, SPECIFICATIONS, device
from tests.mutants.c_library import CMutants
from tests.mutants.hunt import Group, Judge, in_processes
from tests.mutants.mutant import Mutant
from tests.mutants.py_code import ChangedRuntime
from tests.mutants.py_package import PyMutants
from tests.mutants.talks import Talk, all_talks

from odsmith.compile import compile_file
from odsmith.vocabulary import Vocabulary

WITH_TABLES = ("tmcm3230", "tmcm6212")
"""Devices whose tables have mutants; those of the others come from the same templates."""

ENOUGH = 250
"""Talks that come past a mutant in Python, which is slow: those with small devices and few lines go first."""

QUICK = 0.2
"""Comparisons that take less than so many seconds come before all talks."""

Comparison = Callable[[], bool]
Answers = list[tuple[str, ...]]


class Runtime(Protocol):
    """A runtime with its mutants."""

    def play(self, talk: Talk) -> Answers: ...
    def passed(self) -> set[int]: ...


@dataclass(frozen=True)
class Reference:
    """What is known of a talk or a comparison with no mutant awake.

    `passed` has a bit for each mutant of the code that it came past, `answers` the hash of each answer.
    """

    seconds: float
    passed: int = 0
    answers: tuple[int, ...] = ()


def all_groups(runtime: ChangedRuntime, folder: Path, jobs: int) -> list[Group]:
    """Compiles everything in `folder` and lets both runtimes answer without a mutant.

    Raises RuntimeError where they do not agree, or a judge objects: then there is nothing to prove here.
    """
    devices = {name: device(name) for name in SPECIFICATIONS}
    vocabulary = compile_file(ROOT / "spec" / "cia" / "cia.yaml")
    assert isinstance(vocabulary, Vocabulary)
    with ThreadPoolExecutor(jobs) as pool:
        c = CMutants(list(devices.values()), vocabulary, WITH_TABLES, folder / "c", pool)
    python = PyMutants(runtime, list(devices.values()), WITH_TABLES, folder / "python")
    talks = all_talks(list(devices.values()))
    in_c = _listen(jobs, c, talks)
    in_python = _listen(jobs, python, talks)
    different = [talk.name for talk in talks if in_c[talk.name].answers != in_python[talk.name].answers]
    if different:
        raise RuntimeError(f"without any mutant, C and Python answer differently to {', '.join(different[:10])}")

    by_size = sorted(talks, key=lambda talk: (len(devices[talk.device].expanded), len(talk.lines), talk.name))

    def of_code(runtime: Runtime, references: dict[str, Reference], most: int) -> Callable[[Mutant], Iterator[Judge]]:
        def judges(mutant: Mutant) -> Iterator[Judge]:
            passing = (talk for talk in by_size if references[talk.name].passed >> mutant.number & 1)
            for talk in itertools.islice(passing, most):
                yield _judge_of_talk(runtime, talk, references[talk.name])

        return judges

    def of_tables(
        runtime: Runtime, references: dict[str, Reference], comparisons: dict[str, dict[str, Comparison]]
    ) -> Callable[[Mutant], Iterator[Judge]]:
        seconds = _time(jobs, comparisons)

        def judges(mutant: Mutant) -> Iterator[Judge]:
            owner = next(name for name in WITH_TABLES if mutant.where.startswith(name))
            for name, comparison in comparisons[owner].items():
                usual = seconds[owner, name]
                yield Judge(name, usual, partial(_differs, comparison), keen=usual < QUICK)
            for talk in talks:
                if talk.device == owner:
                    yield _judge_of_talk(runtime, talk, references[talk.name])

        return judges

    return [
        Group("C code", c.code.mutants, c.wake_code, of_code(c, in_c, len(talks))),
        Group("Python code", python.code.mutants, python.wake_code, of_code(python, in_python, ENOUGH)),
        Group(
            "C tables",
            c.tables.mutants,
            c.wake_tables,
            of_tables(c, in_c, {name: c.comparisons(devices[name], vocabulary) for name in WITH_TABLES}),
        ),
        Group(
            "Python tables",
            python.tables.mutants,
            python.wake_tables,
            of_tables(python, in_python, {name: python.comparisons(name) for name in WITH_TABLES}),
        ),
    ]


def _judge_of_talk(runtime: Runtime, talk: Talk, reference: Reference) -> Judge:
    def objects() -> str:
        answers = runtime.play(talk)
        if not talk.accepts(answers):
            return talk.judge
        return "" if tuple(map(hash, answers)) == reference.answers else "other runtime"

    return Judge(talk.name, reference.seconds, objects)


def _differs(comparison: Comparison) -> str:
    """What a comparison cannot read is no equal either."""
    try:
        return "" if comparison() else "model"
    except Exception:
        return "model"


def _listen(jobs: int, runtime: Runtime, talks: Sequence[Talk]) -> dict[str, Reference]:
    """What a runtime answers in which no mutant is awake. Raises RuntimeError where a judge objects."""

    def listen(part: Sequence[Talk]) -> dict[str, Reference]:
        found = {}
        for talk in part:
            runtime.passed()
            begin = time.process_time()
            answers = runtime.play(talk)
            seconds = time.process_time() - begin
            passed = sum(1 << number for number in runtime.passed())
            found[talk.name] = Reference(seconds, passed, tuple(map(hash, answers)) if talk.accepts(answers) else ())
        return found

    references: dict[str, Reference] = {}
    for _, result in in_processes(jobs, [talks[n::jobs] for n in range(jobs)], listen):
        references |= result or {}
    objected = [talk.name for talk in talks if talk.name not in references or not references[talk.name].answers]
    if objected:
        raise RuntimeError(f"without any mutant, judges object to {', '.join(objected[:10])}")
    return references


def _time(jobs: int, comparisons: dict[str, dict[str, Comparison]]) -> dict[tuple[str, str], float]:
    """How long each comparison takes. Raises RuntimeError for one that finds a difference."""

    def measure(task: tuple[str, str]) -> float | None:
        begin = time.process_time()
        return None if _differs(comparisons[task[0]][task[1]]) else time.process_time() - begin

    tasks = [(device, name) for device, names in comparisons.items() for name in names]
    measured = dict(in_processes(jobs, tasks, measure))
    wrong = [name for (_, name), seconds in measured.items() if seconds is None]
    if wrong:
        raise RuntimeError(f"without any mutant, the tables differ from the model: {', '.join(wrong)}")
    return measured
