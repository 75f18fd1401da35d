"""What a mutant is, whatever it changes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One change. `key` names it in reports and in survivors.yaml, `number` chooses it among those of its maker.

    `where` is what mutants near each other have in common: the same dialogues catch them.
    """

    key: str
    kind: str
    where: str
    number: int


class Catalogue:
    """Numbers mutants from 1 and gives those that look alike different keys."""

    def __init__(self) -> None:
        self.mutants: list[Mutant] = []
        self._seen: Counter[str] = Counter()

    def add(self, kind: str, where: str, what: str) -> int:
        """The number of a new mutant: `what` is changed at the place `where`."""
        key = f"{where}: {kind.partition(': ')[2]}: {' '.join(what.split())}"
        self._seen[key] += 1
        if self._seen[key] > 1:
            key = f"{key} #{self._seen[key]}"
        self.mutants.append(Mutant(key, kind, where, len(self.mutants) + 1))
        return len(self.mutants)
