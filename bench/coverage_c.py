"""`make coverage`: which lines of the C runtime the tests execute.

    coverage_c.py FOLDER

FOLDER is searched for what programs compiled with `--coverage` leave when they end; several programs of the same
sources are added up. Prints a line for each file, with the lines that nobody executes, and ends with exit status 1
below 95 % of all lines of `runtime_c/src`.
"""

from __future__ import annotations

import argparse
import gzip
import json
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parent.parent
SOURCES = ROOT / "runtime_c"
LEAST = 95.0
"""Per cent."""

Lines = dict[Path, dict[int, int]]
"""How often each line was executed, by file and number."""


def read_counts(folder: Path, gcov: str) -> Lines:
    """What all programs under a folder executed of the runtime."""
    files: Lines = {}
    for notes in sorted(folder.rglob("*.gcno")):
        command = [gcov, "--json-format", "--stdout", str(notes)]
        done = subprocess.run(command, capture_output=True, cwd=folder, check=False)
        if done.returncode:
            sys.exit(f"{' '.join(command)}\n{done.stderr.decode()}")
        data = gzip.decompress(done.stdout) if done.stdout.startswith(b"\x1f\x8b") else done.stdout
        for record in data.splitlines():
            report = json.loads(record)
            for file in report["files"]:
                path = (Path(report["current_working_directory"]) / file["file"]).resolve()
                if path.is_relative_to(SOURCES):
                    counts = files.setdefault(path, {})
                    for line in file["lines"]:
                        number = line["line_number"]
                        counts[number] = counts.get(number, 0) + line["count"]
    return files


def ranges(numbers: Iterable[int]) -> str:
    """`3-5, 9`."""
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in runs)


def share(executed: int, lines: int) -> float:
    return 100.0 * executed / lines if lines else 100.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--gcov", default="gcov", help="the one of the compiler that was used")
    arguments = parser.parse_args()
    if shutil.which(arguments.gcov) is None:
        print(f"{arguments.gcov} is not installed: nothing was counted", file=sys.stderr)
        return 2
    files = read_counts(arguments.folder.resolve(), arguments.gcov)
    wanted = sorted((SOURCES / "src").glob("*.c"))
    strangers = [path.name for path in wanted if path not in files]
    if not wanted or strangers:
        print(f"no test program has {', '.join(strangers) or 'anything of the runtime'}", file=sys.stderr)
        return 1

    total = executed = 0
    print("Lines of the C runtime that the tests execute")
    for path in [*wanted, *sorted(path for path in files if path not in wanted)]:
        missed = [number for number, count in files[path].items() if count == 0]
        lines = len(files[path])
        print(
            f"  {path.name:<22} {lines - len(missed):>5} of {lines:>5}  {share(lines - len(missed), lines):6.1f} %",
            end="",
        )
        print(f"  not: {ranges(missed)}" if missed else "")
        if path in wanted:
            total += lines
            executed += lines - len(missed)
    covered = share(executed, total)
    fine = covered >= LEAST
    print(
        f"  runtime_c/src: {executed} of {total}, {covered:.1f} %; wanted {LEAST:.0f} %: {'ok' if fine else 'MISSED'}"
    )
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
