"""Timing of whole processes, in turn, so that a drifting machine hits all of them alike."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Series:
    """What a command took: wall time in seconds and peak memory in MiB, one value for each run."""

    name: str
    command: Sequence[str | Path]
    reported: bool = False
    """Take the time that the process prints (seconds) and not that of the whole process."""
    seconds: list[float] = field(default_factory=list)
    mebibytes: list[float] = field(default_factory=list)

    def run(self, environment: dict[str, str]) -> None:
        start = time.perf_counter()
        process = subprocess.Popen(
            [str(part) for part in self.command], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment
        )
        assert process.stdout is not None
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        elapsed = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            sys.exit(f"{' '.join(map(str, self.command))}: exit status {process.returncode}")
        self.seconds.append(float(output) if self.reported else elapsed)
        self.mebibytes.append(usage.ru_maxrss / 1024)

    @property
    def median(self) -> float:
        return statistics.median(self.seconds)


def measure(series: Sequence[Series], runs: int) -> None:
    """One run of each to warm the caches, then `runs` of each in turn."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    for number in range(runs + 1):
        for each in series:
            each.run(environment)
            if number == 0:
                each.seconds.clear()
                each.mebibytes.clear()


def report(title: str, series: Sequence[Series], base: Series) -> None:
    """Medians, and the ratio of each to `base` as the median of the ratios of neighbouring runs."""
    print(f"\n{title} ({len(base.seconds)} runs each, in turn; median, smallest, largest)")
    for each in series:
        ratio = statistics.median(a / b for a, b in zip(each.seconds, base.seconds, strict=True))
        print(
            f"  {each.name:<42} {each.median * 1000:9.2f} ms  {min(each.seconds) * 1000:9.2f}"
            f"  {max(each.seconds) * 1000:9.2f}   {statistics.median(each.mebibytes):6.1f} MiB   x {ratio:.3f}"
        )
