"""`make bench-cross`: how much the two runtimes are held to each other, and how fast each of them answers.

All scenarios are played to the C testee and to its Python twin in this process, as they are and once more with a clock
that is about to wrap; after each one comes a dump of everything. The times are those of the answers, without making
devices or comparing. A frame is one that the device received or sent.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tests.cross.build import Build, build_library
from tests.cross.clocks import WRAPPING
from tests.cross.count import Count
from tests.cross.devices import ROOT, device
from tests.cross.library import CBench
from tests.cross.scenario import Scenario, all_scenarios
from tests.cross.testee import Bench

from odsmith.backends.python import PythonBackend
from odsmith.compile import compile_file
from odsmith.render import write
from odsmith.vocabulary import Vocabulary
from odsmith_runtime.device import Config, Tables

ENDING = ("DUMP 0000-FFFF", "NVM")

Answer = Callable[[str], list[str]]


class Language:
    """A runtime, and the time it has taken for its answers, in seconds: to scenarios, and to the dumps after them."""

    def __init__(self, name: str, start: Callable[[str, dict[str, int]], Answer]) -> None:
        self.name = name
        self.start = start
        self.seconds = 0.0
        self.dumping = 0.0

    def play(self, scenario: Scenario, options: dict[str, int]) -> list[list[str]]:
        answer = self.start(scenario.device, options)
        begin = time.perf_counter()
        told = [answer(step.line) for step in scenario.steps]
        end = time.perf_counter()
        told += [answer(line) for line in ENDING]
        self.seconds += end - begin
        self.dumping += time.perf_counter() - end
        return told


def languages(folder: Path) -> list[Language]:
    """Compiles the C runtime for the devices of the scenarios."""
    vocabulary = compile_file(ROOT / "spec" / "cia" / "cia.yaml")
    assert isinstance(vocabulary, Vocabulary)
    libraries: dict[str, Path] = {}
    tables: dict[str, Tables] = {}
    for name in sorted({scenario.device for scenario in all_scenarios()}):
        model = device(name)
        libraries[name] = build_library(model, vocabulary, Build(), folder)
        write(PythonBackend().render(model), folder)
        sys.path.insert(0, str(folder / name / "python"))
        tables[name] = Tables.of(importlib.import_module(name))

    def c(name: str, options: dict[str, int]) -> Answer:
        return CBench(libraries[name], **options).answer

    def python(name: str, options: dict[str, int]) -> Answer:
        config = Config(serial_number=options.get("serial", 0), node_id=options.get("node_id", 0))
        return Bench(tables[name], config, options.get("time", 0)).answer

    return [Language("C", c), Language("Python", python)]


def main() -> int:
    scenarios = all_scenarios()
    compared, differences = Count(), 0
    with tempfile.TemporaryDirectory() as folder:
        runtimes = languages(Path(folder))
        begin = time.perf_counter()
        for scenario in scenarios:
            for options in (scenario.options, {**scenario.options, "time": WRAPPING}):
                c, python = (runtime.play(scenario, options) for runtime in runtimes)
                differences += c != python
                sent = (*(step.line for step in scenario.steps), *ENDING)
                for line, answer, other in zip(sent, c, python, strict=True):
                    if answer == other:
                        compared.add(line, answer)
        seconds = time.perf_counter() - begin
    print(f"{len(scenarios)} scenarios, each with two clocks: {differences} differences")
    print(f"compared: {compared.lines:,} lines, {compared.frames:,} frames, {compared.answers:,} lines of answer")
    print(
        f"in {seconds:.1f} s: {compared.lines / seconds:,.0f} lines, {compared.frames / seconds:,.0f} frames"
        f" and {compared.answers / seconds:,.0f} lines of answer per second"
    )
    played = 2 * sum(len(scenario.steps) for scenario in scenarios)
    for runtime in runtimes:
        dump = 1000 * runtime.dumping / (2 * len(scenarios))
        print(f"{runtime.name:7}{played / runtime.seconds:10,.0f} lines per s, {dump:.2f} ms for a dump with image")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
