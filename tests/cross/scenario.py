"""Scenarios: dialogues with a testee, kept as text files.

    # What it shows, and the clause or section that it comes from.
    device: tmcm6212
    options: --node-id 5

    > POWER on
    BUS 1000 5
    TX 705 00
    ...
    > RX 605 40 00 10 00 00 00 00 00
    TX 585 43 00 10 00 92 01 FC FF

A line that begins with `>` is sent. What follows is the expected answer: exactly these lines, but for the last one,
`NEXT`, which may be left out. `...` stands for any number of lines. Text from ` #` on is a comment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SCENARIOS = Path(__file__).parent / "scenarios"

ANYTHING = "..."

RESET_NODE = "RX 000 81 00"


@dataclass(frozen=True)
class Step:
    """A line for the testee, and its expected answer; `number` is that of the line in the file."""

    number: int
    line: str
    expected: tuple[str, ...]

    def accepts(self, answer: tuple[str, ...]) -> bool:
        """Whether an answer, which ends with NEXT or NACK, is the expected one."""
        if not self.expected or not self.expected[-1].startswith(("NEXT", "NACK", ANYTHING)):
            if not answer[-1].startswith("NEXT"):
                return False
            answer = answer[:-1]
        return _match(self.expected, answer)


@dataclass(frozen=True)
class Scenario:
    """`options` are those of the testee's command line, by their names in Python."""

    path: Path
    device: str
    options: dict[str, int]
    steps: tuple[Step, ...]

    @property
    def name(self) -> str:
        """`sdo/expedited`, wherever the file is."""
        return self.path.relative_to(SCENARIOS).with_suffix("").as_posix()

    @property
    def lines(self) -> list[str]:
        """What is sent."""
        return [step.line for step in self.steps]

    @property
    def interrupted(self) -> list[str]:
        """Half of the lines, reset node, and all of them again, which no answer is expected to: what did it forget?"""
        return [*self.lines[: len(self.lines) // 2], RESET_NODE, *self.lines]

    def judge(self, answer_to: Callable[[str], tuple[str, ...]]) -> None:
        """Play it to a testee. AssertionError: an answer is another one than expected."""
        for step in self.steps:
            answer = answer_to(step.line)
            assert step.accepts(answer), "\n".join(
                [f"{self.path}:{step.number}: > {step.line}", "expected", *step.expected, "answered", *answer]
            )


@cache
def all_scenarios() -> tuple[Scenario, ...]:
    return tuple(read(path) for path in sorted(SCENARIOS.rglob("*.txt")))


def read(path: Path) -> Scenario:
    """Raises ValueError for a file that is no scenario."""
    headers: dict[str, str] = {}
    steps: list[Step] = []
    for number, line in _lines(path):
        if line.startswith(">"):
            steps.append(Step(number, line[1:].strip(), ()))
        elif steps:
            last = steps.pop()
            steps.append(Step(last.number, last.line, (*last.expected, line)))
        else:
            key, colon, value = line.partition(":")
            if not colon or key not in ("device", "options"):
                raise ValueError(f"{path}:{number}: neither `device:` nor `options:` nor a step that begins with >")
            headers[key] = value.strip()
    if "device" not in headers or not steps:
        raise ValueError(f"{path}: a scenario names its device and has steps")
    words = headers.get("options", "").split()
    options = {
        name.removeprefix("--").replace("-", "_"): int(value, 16 if name == "--time" else 10)
        for name, value in zip(words[::2], words[1::2], strict=True)
    }
    return Scenario(path, headers["device"], options, tuple(steps))


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(path.read_text().splitlines(), start=1):
        text = line.strip() if not line.startswith("#") else ""
        text = text.partition(" #")[0].strip()
        if text:
            yield number, text


def _match(expected: tuple[str, ...], answer: tuple[str, ...]) -> bool:
    if not expected:
        return not answer
    if expected[0] == ANYTHING:
        return any(_match(expected[1:], answer[n:]) for n in range(len(answer) + 1))
    return bool(answer) and answer[0] == expected[0] and _match(expected[1:], answer[1:])
