"""`make fuzz`, `make fuzz-short`: let libFuzzer look for events that break a promise of the C runtime.

What it learns is kept in `build/fuzz/corpus` for the next time. Where it finds something it stops with exit status 1
and leaves the input in `build/fuzz`; `build/fuzz/fuzz_node FILE` does it again.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
DEVICES = ("tmcm3230", "tmcm6212")
FOREVER = 0

TARGET = ("fuzz_node.c", "invariants.c", "rig.c")
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")
SANITIZERS = "address,undefined"


def build(compiler: str, out: Path, runtime: Path, libfuzzer: bool) -> None:
    """Compile the target with the runtime and both devices; ends with exit status 2 where that fails."""
    generated = [ROOT / "generated" / name / "c" for name in ("cia", *DEVICES)]
    sources = [HERE / name for name in (*TARGET, *(() if libfuzzer else ("standalone.c",)))]
    sources += sorted((runtime / "src").glob("*.c"))
    sources += sorted(path for folder in generated for path in folder.glob("*.c"))
    sanitizers = f"{'fuzzer,' if libfuzzer else ''}{SANITIZERS}"
    done = subprocess.run(
        [
            compiler,
            *("-std=c99", "-O1", "-g", *WARNINGS),
            *(f"-fsanitize={sanitizers}", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"),
            *(f"-I{folder}" for folder in (runtime / "include", *generated)),
            *map(str, sources),
            *("-o", str(out)),
        ]
    )
    if done.returncode:
        sys.exit(2)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=FOREVER, help="stop after so long; without it only at a find")
    parser.add_argument("--runs", type=int, help="stop after so many inputs, the same ones each time")
    parser.add_argument("--seed", type=int, help="of the random numbers")
    parser.add_argument("--runtime", type=Path, default=ROOT / "runtime_c", help="folder of the runtime")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "fuzz", help="folder for what is made")
    parser.add_argument("--compiler", default="clang", help="one that knows -fsanitize=fuzzer")
    parser.add_argument("--standalone", action="store_true", help="made-up inputs without libFuzzer, any compiler")
    arguments = parser.parse_args()
    if shutil.which(arguments.compiler) is None:
        print(f"{arguments.compiler} is not installed; --compiler names another, --standalone needs no libFuzzer")
        return 2

    work: Path = arguments.work.resolve()
    corpus, seeds = work / "corpus", work / "seeds"
    corpus.mkdir(parents=True, exist_ok=True)
    subprocess.run([sys.executable, str(HERE / "seeds.py"), str(seeds)], check=True)
    binary = work / ("standalone" if arguments.standalone else "fuzz_node")
    build(arguments.compiler, binary, arguments.runtime.resolve(), not arguments.standalone)

    environment = {**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"}
    if arguments.standalone:
        for command in (
            [str(binary), *map(str, sorted(seeds.iterdir()))],
            [str(binary), "--random", str(arguments.seed or 1), str(arguments.runs or 1000)],
        ):
            if subprocess.run(command, env=environment).returncode:
                return 1
        return 0
    command = [
        str(binary),
        f"-artifact_prefix={work}/",
        "-print_final_stats=1",
        "-timeout=25",
        "-max_len=2048",
        "-len_control=20",
    ]
    if arguments.seed is not None:
        command.append(f"-seed={arguments.seed}")
    if arguments.runs is not None:
        command.append(f"-runs={arguments.runs}")
    elif arguments.seconds != FOREVER:
        command.append(f"-max_total_time={arguments.seconds}")
    done = subprocess.run([*command, str(corpus), str(seeds)], env=environment)
    return 1 if done.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
