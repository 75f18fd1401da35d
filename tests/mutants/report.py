"""What came of the hunt, beside what survivors.yaml expects."""

from __future__ import annotations

import re
import resource
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml
from tests.mutants.hunt import Group, Verdict, hunt, sample
from tests.mutants.mutant import Mutant

LEAST_OF_CODE = 0.95
"""Which part of the mutants of a runtime's code has to be caught, but for those that no dialogue can tell apart."""

GROUPS = 4

STEP = 1000
"""A word is said each time that so many are hunted down."""


class Survivors:
    """The mutants that are known to survive: patterns of keys, where `*` stands for anything, each with its reason."""

    def __init__(self, rows: Iterable[Mapping[str, Any]]) -> None:
        """A row has `reason`, `mutants`, and perhaps `equivalent: true`: nobody could tell them from the original."""
        self._patterns: dict[str, re.Pattern[str]] = {}
        self._equivalent: set[str] = set()
        self._used: set[str] = set()
        for row in rows:
            assert row["reason"].strip()
            for pattern in row["mutants"]:
                assert pattern not in self._patterns, f"listed twice: {pattern}"
                self._patterns[pattern] = re.compile(re.escape(pattern).replace(r"\*", ".*"))
                if row.get("equivalent", False):
                    self._equivalent.add(pattern)

    @classmethod
    def listed(cls) -> Survivors:
        return cls(yaml.safe_load((Path(__file__).parent / "survivors.yaml").read_text()))

    def __contains__(self, mutant: Mutant) -> bool:
        found = {pattern for pattern, regex in self._patterns.items() if regex.fullmatch(mutant.key)}
        self._used |= found
        return bool(found)

    def is_equivalent(self, mutant: Mutant) -> bool:
        return any(self._patterns[pattern].fullmatch(mutant.key) for pattern in self._equivalent)

    def unused(self) -> list[str]:
        return [pattern for pattern in self._patterns if pattern not in self._used]


class Report:
    """Prints totals as they come, and complains at the end.

    A sample has none of the mutants that are listed: to find that nothing catches them takes longest.
    """

    def __init__(self, survivors: Survivors, jobs: int, *, sample: int = 0, only: str = "") -> None:
        self._survivors = survivors
        self._jobs = jobs
        self._sample = sample
        self._only = only
        self._complaints: list[str] = []

    def hunt(self, group: Group) -> None:
        mutants = [mutant for mutant in group.mutants if self._only in mutant.kind or self._only in mutant.key]
        if self._sample:
            mutants = [mutant for mutant in sample(mutants, self._sample // GROUPS) if mutant not in self._survivors]
        begin = _processor_time()
        verdicts: dict[Mutant, Verdict] = {}
        for mutant, verdict in hunt(self._jobs, group, mutants):
            verdicts[mutant] = verdict
            if not len(verdicts) % STEP:
                print(f"{group.name}: {len(verdicts)} of {len(mutants)}", file=sys.stderr, flush=True)
        self._print(group.name, verdicts, _processor_time() - begin)
        for mutant, verdict in verdicts.items():
            is_listed = mutant in self._survivors
            if is_listed and verdict.how:
                self._complaints.append(f"caught by {verdict.judge}, take it off the survivors: {mutant.key}")
            if not is_listed and not verdict.how:
                self._complaints.append(f"survived: {mutant.key}")

    def complaints(self) -> list[str]:
        """All that is wrong after the last group."""
        unused = [] if self._sample or self._only else self._survivors.unused()
        return [*self._complaints, *(f"no such mutant: {pattern}" for pattern in unused)]

    def _print(self, name: str, verdicts: Mapping[Mutant, Verdict], seconds: float) -> None:
        survived = [mutant for mutant, verdict in verdicts.items() if not verdict.how]
        equivalent = sum(self._survivors.is_equivalent(mutant) for mutant in survived)
        caught = len(verdicts) - len(survived)
        part = caught / max(len(verdicts) - equivalent, 1)
        print(
            f"{name}: {len(verdicts)} mutants, {caught} caught, {equivalent} equivalent: {part:.1%}, "
            f"in {seconds:.0f} s of processor time"
        )
        kinds: dict[str, Counter[str]] = defaultdict(Counter)
        for mutant, verdict in verdicts.items():
            for row in ("all", mutant.kind):
                kinds[row][verdict.how or "survived"] += 1
        for kind, counts in sorted(kinds.items()):
            print(f"    {kind}: {', '.join(f'{how} {count}' for how, count in counts.most_common())}")
        if "code" in name and verdicts and part < LEAST_OF_CODE:
            self._complaints.append(f"only {part:.1%} of the mutants of {name} are caught")


def _processor_time() -> float:
    """Seconds of this process and all that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)
