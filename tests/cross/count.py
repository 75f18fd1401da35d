"""How much two testees were held to each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


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
