"""All mutants that there are, with those who judge them.

Three judges listen to a talk: what the scenario says that was worked out by hand, or what the oracle works out from the
specification; and then the other runtime, which has to say the same word for word. Tables are compared with the model
before, row by row, which takes milliseconds; only where the model says nothing, as of places in memory, do talks judge.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Protocol

from tests.cross.devices import ROOT, SPECIFICATIONS, device
from tests.mutants.c_library import CMutants
from tests.mutants.hunt import Group, Judge, Judges, in_processes
from tests.mutants.mutant import Mutant
from tests.mutants.py_code import ChangedRuntime
from tests.mutants.py_package import PyMutants
from tests.mutants.talks import Talk, all_talks

from odsmith.compile import compile_file
from odsmith.vocabulary import Vocabulary

WITH_TABLES = ("tmcm3230", "tmcm6212")
"""Devices whose tables have mutants; those of the others come from the same templates."""

ENOUGH = 400
"""Talks that come past a mutant in Python, which is slow, beside those of its topic: quick ones go first."""

TOPICS = {
    "access": {"write", "sdo"},
    "axis": {"fsa", "mode", "emergency", "stall", "encoder", "driver"},
    "cyclic": {"csp", "csv"},
    "heartbeat": {"heartbeat", "guarding"},
    "mode": {"pp", "pv", "csp", "csv", "mode"},
    "motion": {"ramp", "encoder"},
    "motor": {"driver", "brake", "stall"},
    "nmt": {"nmt", "sdo"},
    "node": {"time", "nmt"},
    "od": {"write", "nmt", "store"},
    "pdo": {"pdo", "sync", "time"},
    "simulation": {"driver", "emergency", "limits", "homing", "stall"},
}
"""Folders of scenarios that are about a module, where they do not have its name."""

ADDRESSES = "addresses"
"""The one comparison that is not quick: all 2^24 addresses are asked."""

Comparison = Callable[[], bool]
Answers = list[tuple[str, ...]]


class Runtime(Protocol):
    """A runtime with its mutants."""

    def play(self, talk: Talk) -> Answers: ...
    def passed(self) -> set[int]: ...


@dataclass(frozen=True)
class Reference:
    """What is known of a talk with no mutant awake.

    `passed` has a bit for each mutant of the code that it came past, `answers` the hash of each answer.
    """

    seconds: float
    work: int
    passed: int
    answers: tuple[int, ...]


class Listener:
    """Has a runtime play talks in which no mutant is awake, each one once."""

    def __init__(self, jobs: int, runtime: Runtime, other: Listener | None = None) -> None:
        """`other` has listened to the other runtime, or will."""
        self._jobs = jobs
        self._runtime = runtime
        self._other = other
        self._known: dict[str, Reference] = {}

    def listen(self, talks: Sequence[Talk]) -> Mapping[str, Reference]:
        """What is known of these talks and others, by name.

        Raises RuntimeError where a judge objects, or the runtimes do not agree: then there is nothing to prove here.
        """
        new = [talk for talk in talks if talk.name not in self._known]
        for _, result in in_processes(self._jobs, [new[n :: self._jobs] for n in range(self._jobs)], self._play):
            self._known |= result or {}
        _complain("judges object to", (talk for talk in new if not self._answers(talk)))
        if self._other:
            others = self._other.listen(talks)
            wrong = (talk for talk in new if self._answers(talk) != others[talk.name].answers)
            _complain("C and Python answer differently to", wrong)
        return self._known

    def _answers(self, talk: Talk) -> tuple[int, ...]:
        return self._known[talk.name].answers if talk.name in self._known else ()

    def _play(self, part: Sequence[Talk]) -> dict[str, Reference]:
        found = {}
        for talk in part:
            self._runtime.passed()
            begin = time.process_time()
            answers = self._runtime.play(talk)
            seconds = time.process_time() - begin
            passed = sum(1 << number for number in self._runtime.passed())
            hashes = tuple(map(hash, answers)) if talk.accepts(answers) else ()
            found[talk.name] = Reference(seconds, talk.work(answers), passed, hashes)
        return found


def _complain(what: str, talks: Iterable[Talk]) -> None:
    names = [talk.name for talk in talks]
    if names:
        raise RuntimeError(f"without any mutant, {what} {', '.join(names[:10])}")


def all_groups(runtime: ChangedRuntime, folder: Path, jobs: int) -> list[Group]:
    """Compiles everything in `folder`."""
    devices = {name: device(name) for name in SPECIFICATIONS}
    vocabulary = compile_file(ROOT / "spec" / "cia" / "cia.yaml")
    assert isinstance(vocabulary, Vocabulary)
    with ThreadPoolExecutor(jobs) as pool:
        c = CMutants(list(devices.values()), vocabulary, WITH_TABLES, folder / "c", pool)
    python = PyMutants(runtime, list(devices.values()), WITH_TABLES, folder / "python")
    all_of_them = cache(lambda: all_talks(list(devices.values())))  # which tables need not
    c_listener = Listener(jobs, c)
    python_listener = Listener(jobs, python, c_listener)

    def of_c_code() -> Iterator[Judges]:
        talks = all_of_them()
        yield _of_code(c, talks, c_listener.listen(talks), len(talks))

    def of_python_code() -> Iterator[Judges]:
        talks = all_of_them()
        yield _of_code(python, talks, python_listener.listen(talks), ENOUGH)

    def of_c_tables() -> Iterator[Judges]:
        yield from _of_tables(jobs, {name: c.comparisons(devices[name], vocabulary) for name in WITH_TABLES})
        yield _of_uses(c, all_of_them(), c_listener.listen(all_of_them()))

    def of_python_tables() -> Iterator[Judges]:
        yield from _of_tables(jobs, {name: python.comparisons(name) for name in WITH_TABLES})

    return [
        Group("C tables", c.tables.mutants, c.wake_tables, of_c_tables),
        Group("Python tables", python.tables.mutants, python.wake_tables, of_python_tables),
        Group("C code", c.code.mutants, c.wake_code, of_c_code),
        Group("Python code", python.code.mutants, python.wake_code, of_python_code),
    ]


# ---- code ------------------------------------------------------------------------------------------------------------


def _of_code(runtime: Runtime, talks: Sequence[Talk], references: Mapping[str, Reference], most: int) -> Judges:
    """Talks that come past the place of the mutant: those of its topic, then the quick ones."""
    by_work = sorted(talks, key=lambda talk: references[talk.name].work)

    def judges(mutant: Mutant) -> Iterator[Judge]:
        module = mutant.where.partition(".")[0].removeprefix("ods_")
        topics = TOPICS.get(module, {module})
        passing = [talk for talk in by_work if references[talk.name].passed >> mutant.number & 1]
        first = [talk for talk in passing if talk.name.partition("/")[0] in topics]
        others = [talk for talk in passing[:most] if talk not in first]
        for talk in (*first, *others):
            yield _judge_of_talk(runtime, talk, references[talk.name])

    return judges


def _of_uses(runtime: Runtime, talks: Sequence[Talk], references: Mapping[str, Reference]) -> Judges:
    """All talks with the device of a table, quick ones first."""
    by_work = sorted(talks, key=lambda talk: references[talk.name].work)

    def judges(mutant: Mutant) -> Iterator[Judge]:
        device = mutant.where.partition(" ")[0]
        return (_judge_of_talk(runtime, talk, references[talk.name]) for talk in by_work if talk.device == device)

    return judges


def _judge_of_talk(runtime: Runtime, talk: Talk, reference: Reference) -> Judge:
    def objects() -> str:
        answers = runtime.play(talk)
        if not talk.accepts(answers):
            return talk.judge
        return "" if tuple(map(hash, answers)) == reference.answers else "other runtime"

    return Judge(talk.name, reference.seconds, objects)


# ---- tables ----------------------------------------------------------------------------------------------------------


def _of_tables(jobs: int, comparisons: Mapping[str, Mapping[str, Comparison]]) -> Iterator[Judges]:
    """Comparisons with the model, by device; quick ones first."""
    for is_quick in (True, False):
        part = {
            owner: {name: each for name, each in names.items() if (name != ADDRESSES) == is_quick}
            for owner, names in comparisons.items()
        }
        yield partial(_comparing, part, _time(jobs, part))


def _comparing(
    comparisons: Mapping[str, Mapping[str, Comparison]], seconds: Mapping[tuple[str, str], float], mutant: Mutant
) -> Iterator[Judge]:
    owner = next(name for name in comparisons if mutant.where.startswith(name))
    for name, comparison in comparisons[owner].items():
        yield Judge(name, seconds[owner, name], partial(_differs, comparison))


def _time(jobs: int, comparisons: Mapping[str, Mapping[str, Comparison]]) -> dict[tuple[str, str], float]:
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


def _differs(comparison: Comparison) -> str:
    """What a comparison cannot read is no equal either."""
    try:
        return "" if comparison() else "model"
    except Exception:
        return "model"
