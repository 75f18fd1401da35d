"""Hunt mutants: each one is woken in a process of its own, where the judges listen to it until one of them objects."""

from __future__ import annotations

import hashlib
import itertools
import os
import pickle
import resource
import select
import signal
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple, TypeVar

from tests.mutants.mutant import Mutant

PATIENCE = 20
"""How much longer than usual a judge may take, and..."""

LEAST_PATIENCE = 2.0
"""...the seconds of processor time that each one may."""

RECENT = 6
"""How many of those that caught the neighbours of a mutant are asked first."""


@dataclass(frozen=True)
class Judge:
    """Who may object to a mutant that is awake, and how long that takes without one.

    `objects` gives the word for the report, or nothing. An exception is a crash.
    """

    name: str
    seconds: float
    objects: Callable[[], str]


Judges = Callable[[Mutant], Iterable[Judge]]


class Verdict(NamedTuple):
    """What caught a mutant, and by whom; nothing where `how` is empty."""

    how: str
    judge: str


NOBODY = Verdict("", "")


@dataclass
class Group:
    """Mutants of one kind of thing, and who judges them.

    In each of its `rounds` other judges look at those mutants that nobody has caught before.
    """

    name: str
    mutants: Sequence[Mutant]
    wake: Callable[[int], None]
    rounds: Callable[[], Iterable[Judges]]
    _caught_by: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))

    def judge(self, mutant: Mutant, who: Judges) -> Verdict:
        """Wake a mutant and ask who caught its neighbours, then the others in their order. There is no way back."""
        judges = {judge.name: judge for judge in who(mutant)}
        near, alike = self._caught_by[mutant.where], self._caught_by[mutant.kind]
        recent = [name for name in (*near[: -RECENT - 1 : -1], *alike[: -RECENT - 1 : -1]) if name in judges]
        self.wake(mutant.number)
        for name in dict.fromkeys([*recent, *judges]):
            _allow(LEAST_PATIENCE + PATIENCE * judges[name].seconds)
            try:
                how = judges[name].objects()
            except Exception:
                how = "crash"
            if how:
                return Verdict(how, name)
        return NOBODY

    def remember(self, mutant: Mutant, judge: str) -> None:
        for known in (self._caught_by[mutant.where], self._caught_by[mutant.kind]):
            if judge in known:
                known.remove(judge)
            known.append(judge)


def hunt(jobs: int, group: Group, mutants: Sequence[Mutant]) -> Iterator[tuple[Mutant, Verdict]]:
    """What becomes of each mutant, in the order in which it is known; so many at a time."""
    left = list(mutants)
    rounds = iter(group.rounds())
    while left and (judges := next(rounds, None)) is not None:
        survivors = []
        for mutant, result in in_processes(jobs, left, partial(group.judge, who=judges)):
            verdict: Verdict = Verdict("crash", "") if result is None else result
            if verdict.judge:
                group.remember(mutant, verdict.judge)
            if verdict.how:
                yield mutant, verdict
            else:
                survivors.append(mutant)
        left = survivors
    for mutant in left:
        yield mutant, NOBODY


def sample(mutants: Sequence[Mutant], size: int) -> list[Mutant]:
    """So many mutants, of all kinds and always the same ones."""
    kinds: dict[str, list[Mutant]] = defaultdict(list)
    for mutant in sorted(mutants, key=lambda mutant: hashlib.sha256(mutant.key.encode()).digest()):
        kinds[mutant.kind].append(mutant)
    rounds = (part for parts in itertools.zip_longest(*kinds.values()) for part in parts if part is not None)
    return sorted(itertools.islice(rounds, size), key=lambda mutant: mutant.number)


# ---- processes -------------------------------------------------------------------------------------------------------

T = TypeVar("T")


def in_processes(jobs: int, tasks: Iterable[T], work: Callable[[T], Any]) -> Iterator[tuple[T, Any]]:
    """The result of each task from a process of its own, as they come; None where the process ended before."""
    waiting = iter(tasks)
    running: dict[int, tuple[T, int, bytearray]] = {}
    while True:
        for task in itertools.islice(waiting, jobs - len(running)):
            pid, pipe = _start(work, task)
            running[pipe] = task, pid, bytearray()
        if not running:
            return
        for pipe in select.select(list(running), [], [])[0]:
            octets = os.read(pipe, 1 << 20)
            task, pid, received = running[pipe]
            received += octets
            if not octets:
                del running[pipe]
                os.close(pipe)
                os.waitpid(pid, 0)
                yield task, pickle.loads(received) if received else None


def _start(work: Callable[[T], Any], task: T) -> tuple[int, int]:
    """A process that works on a task: its number, and the pipe that its result comes out of."""
    reader, writer = os.pipe()
    pid = os.fork()
    if pid:
        os.close(writer)
        return pid, reader
    try:
        os.close(reader)
        _quiet()
        octets = pickle.dumps(work(task))
        with os.fdopen(writer, "wb") as pipe:
            pipe.write(octets)
    finally:
        os._exit(0)


def _quiet() -> None:
    """A mutant may die in any way; nobody wants to read about it."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def _allow(seconds: float) -> None:
    """Processor time until a signal ends this process."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
