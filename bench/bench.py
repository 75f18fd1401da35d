"""`make bench`: how long the generator and what it generates take, beside the peers, in one run.

Cold means a new process; the bytecode caches of Python and of the templates may be warm.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from measure import Series, measure, report
from synthetic import synthetic_spec

ROOT = Path(__file__).parent.parent
BIN = Path(sys.executable).parent
GENERATED = ROOT / "generated"
EDS_FILES = {
    "tmcm3230": GENERATED / "tmcm3230" / "eds" / "TMCM-3230.eds",
    "tmcm6212": GENERATED / "tmcm6212" / "eds" / "TMCM-6212.eds",
}

TIMED = "import time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"


BUILD_ANEW = """
import shutil, sys
from odsmith.cli import main
project, out, *devices = sys.argv[1:]
shutil.rmtree(out, ignore_errors=True)
sys.exit(main(["build", *devices, "--project", project, "--out", out]))
"""


def bench_build(folder: Path, runs: int, *devices: str) -> None:
    """A full build of devices into a new folder, and a check of it, beside dcf2dev on the EDS of the last one."""
    out = folder / "-".join(devices)
    build = Series("odsmith build, every artefact", [sys.executable, "-c", BUILD_ANEW, ROOT, out, *devices])
    command: list[str | Path] = [
        sys.executable,
        "-m",
        "odsmith.cli",
        "build",
        *devices,
        "--project",
        ROOT,
        "--out",
        out,
    ]
    check = Series("odsmith build --check", [*command, "--check"])
    peer = Series(f"dcf2dev, C alone, {devices[-1]}", [BIN / "dcf2dev", EDS_FILES[devices[-1]], devices[-1]])
    measure([build, check, peer], runs)
    report(f"Build of {', '.join(devices)}", [build, check, peer], peer)


def bench_import(folder: Path, runs: int, device: str) -> None:
    """Importing the bindings beside reading the EDS; the time inside the process, after its start."""
    shutil.copytree(GENERATED / device / "python" / device, folder / "site" / device)
    path = f"import sys; sys.path.insert(0, {str(folder / 'site')!r}); "

    def bindings(name: str, statements: str) -> Series:
        return Series(name, [sys.executable, "-c", path + TIMED.format(statements)], True)

    import_eds = "import canopen; " + TIMED.format(f"canopen.import_od({str(EDS_FILES[device])!r})")
    eds = Series("canopen.import_od of the EDS", [sys.executable, "-c", import_eds], True)
    series = [
        bindings(f"import {device}", f"import {device}"),
        bindings("... and its dictionary", f"from {device} import DICTIONARY"),
        bindings("... and the first look-up in it", f"from {device} import DICTIONARY; DICTIONARY[0x6840]"),
        bindings("... or the first enumeration", f"from {device} import DICTIONARY, HomingMethod"),
        bindings("... or the first flags", f"from {device} import DICTIONARY, Statusword"),
        eds,
    ]
    measure(series, runs)
    report(f"Import of the bindings of {device}", series, eds)


def bench_growth(folder: Path, runs: int) -> None:
    """A synthetic device of 8 to 64 axes: time against bytes of output."""
    series = []
    for axes in (8, 16, 32, 64):
        spec = folder / f"synthetic{axes}.yaml"
        spec.write_text(synthetic_spec(axes), encoding="utf-8")
        out = folder / f"synthetic{axes}"
        series.append(
            Series(
                f"{axes} axes", [sys.executable, "-m", "odsmith.cli", "build", spec, "--out", out, "--project", ROOT]
            )
        )
    measure(series, runs)
    report("Growth with the number of axes (time against 8 axes)", series, series[0])
    for each, axes in zip(series, (8, 16, 32, 64), strict=True):
        size = sum(path.stat().st_size for path in (folder / f"synthetic{axes}").rglob("*") if path.is_file())
        print(f"  {axes:>3} axes: {size / 1024:8.1f} KiB of output, {each.median * 1e9 / size:6.1f} ns a byte")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=11)
    runs = parser.parse_args().runs
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bench_build(folder, runs, "tmcm3230")
        bench_build(folder, runs, "cia", "tmcm3230", "tmcm6212")
        bench_import(folder, 2 * runs + 1, "tmcm3230")
        bench_import(folder, 2 * runs + 1, "tmcm6212")
        bench_growth(folder, max(3, runs // 3))


if __name__ == "__main__":
    main()
