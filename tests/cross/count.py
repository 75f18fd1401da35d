"""How much two testees were held to each other.

    python -m tests.cross.count FILE

prints the sum of what several processes have added to a file.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from pathlib import Path


@dataclass
class Count:
    """`frames`: CAN frames that the device received and sent; `lines`: those of dialogues; `answers`: what was told."""

    frames: int = 0
    lines: int = 0
    answers: int = 0

    def add(self, line: str, answer: Sequence[str]) -> None:
        """A line, and the answer on which both agreed."""
        received = line.startswith("RX ") and not answer[-1].startswith("NACK")
        self.frames += received + sum(text.startswith("TX ") for text in answer)
        self.lines += 1
        self.answers += len(answer)

    def append_to(self, path: Path) -> None:
        """One line, which other processes do not tear."""
        with path.open("a") as file:
            file.write(" ".join(map(str, astuple(self))) + "\n")

    @classmethod
    def of(cls, path: Path) -> Count:
        """The sum of all that was appended."""
        rows = [map(int, line.split()) for line in path.read_text().splitlines()]
        return cls(*map(sum, zip(*rows, strict=True)))


if __name__ == "__main__":
    print(
        "{0.frames:,} frames, {0.lines:,} lines and {0.answers:,} lines of answer".format(Count.of(Path(sys.argv[1])))
    )
