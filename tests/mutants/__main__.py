"""The proof is tested: every mutant of the tables and nearly every one of the code has to be caught.

    python -m tests.mutants [--sample N] [--only WORD] [--jobs N]

Survivors stand in survivors.yaml, each with a reason. One that is not there fails, and so does one that is caught.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import tempfile
from pathlib import Path

from tests.mutants.py_code import ChangedRuntime

RUNTIME = Path(__file__).parent.parent.parent / "runtime_py" / "odsmith_runtime" / "device"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__.partition("\n")[0])
    parser.add_argument("--sample", type=int, default=0, metavar="N", help="so many mutants of all kinds, not all")
    parser.add_argument("--only", default="", metavar="WORD", help="those with this word in kind or name")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="processes at a time")
    options = parser.parse_args()
    runtime = ChangedRuntime(sorted(RUNTIME.glob("*.py")))
    runtime.load()  # before anything else imports the runtime
    from tests.mutants.c_library import with_sanitizer
    from tests.mutants.groups import all_groups
    from tests.mutants.report import Report, Survivors

    with_sanitizer([sys.executable, "-m", "tests.mutants", *sys.argv[1:]])
    report = Report(Survivors.listed(), options.jobs, sample=options.sample, only=options.only)
    with tempfile.TemporaryDirectory() as folder:
        groups = all_groups(runtime, Path(folder), options.jobs)
        gc.freeze()  # or each process would copy all of it
        for group in groups:
            report.hunt(group)
    complaints = report.complaints()
    print("\n".join(complaints))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
