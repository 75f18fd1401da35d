"""Compile test programs from the C runtime and the generated tables of a device."""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from odsmith.backends.c import CBackend
from odsmith.model import Device
from odsmith.render import write
from odsmith.vocabulary import Vocabulary

HERE = Path(__file__).parent
RUNTIME = HERE.parent.parent / "runtime_c"

SIMULATION = RUNTIME / "port" / "simulation"

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")


COVERAGE = os.environ.get("ODSMITH_COVERAGE", "")
"""A folder for programs that count what they execute; `make coverage` names one."""


@dataclass(frozen=True)
class Build:
    """A compiler and the flags that make it another one, such as -m32."""

    compiler: str = "cc"
    flags: tuple[str, ...] = ()

    @property
    def command(self) -> list[str]:
        return [self.compiler, *self.flags]

    def links(self, folder: Path, *flags: str) -> bool:
        """Whether a program can be made and started: the libraries of `flags` need not be installed."""
        source = folder / "probe.c"
        source.write_text("#include <stdint.h>\nint main(void) { return 0; }\n")
        program = folder / "probe"
        done = subprocess.run([*self.command, *flags, str(source), "-o", str(program)], capture_output=True)
        return done.returncode == 0 and subprocess.run([program], capture_output=True).returncode == 0


def build_testee(device: Device, vocabulary: Vocabulary, build: Build, folder: Path) -> Path:
    """The testee of a device, made in `folder` unless it is there already, which several processes may ask at once.

    Sanitizers watch it where the compiler has them.
    """
    return _build(device, vocabulary, build, folder, watched=True)


def build_library(device: Device, vocabulary: Vocabulary, build: Build, folder: Path) -> Path:
    """The same as a shared library: quick, for nothing watches it, nor counts what it executes."""
    return _build(device, vocabulary, build, folder, watched=False)


def build_simulation(vocabulary: Vocabulary, build: Build, folder: Path) -> Path:
    """The simulated hardware of an axis as a shared library, with what C alone knows of its struct."""

    def make(home: Path) -> None:
        write(CBackend().render(vocabulary), home)
        (home / "size.c").write_text(_SIZE)
        includes = (f"-I{place}" for place in (home / "cia" / "c", SIMULATION))
        sources = (str(SIMULATION / "ods_simulation.c"), "size.c")
        _compile(build, home, False, *includes, *sources, "-o", "simulation.so", "-shared")

    return _once(folder, "simulation", (vocabulary.digest, build), make) / "simulation.so"


_SIZE = """
#include <stddef.h>
#include "ods_simulation.h"
size_t simulation_size(void);
int64_t simulation_shaft(const ods_simulation_t *axis);
void simulation_answer(const ods_simulation_t *axis, ods_motor_answer_t *answer);
size_t simulation_size(void)
{
    return sizeof(ods_simulation_t);
}
int64_t simulation_shaft(const ods_simulation_t *axis)
{
    return axis->shaft;
}
void simulation_answer(const ods_simulation_t *axis, ods_motor_answer_t *answer)
{
    *answer = axis->answer;
}
"""


def _build(device: Device, vocabulary: Vocabulary, build: Build, folder: Path, *, watched: bool) -> Path:
    def make_runtime(home: Path) -> None:
        """The objects of the runtime, which knows no device."""
        write(CBackend().render(vocabulary), home)
        sources = sorted((RUNTIME / "src").glob("*.c"))
        _compile(build, home, watched, f"-I{home / 'cia' / 'c'}", "-c", *map(str, sources))

    def make(home: Path) -> None:
        name = device.identifier
        write(CBackend().render(device), home)
        (home / "condition_names.h").write_text("".join(_condition_names(vocabulary)))
        sources = (
            *sorted((home / name / "c").glob("*.c")),
            HERE / ("testee.c" if watched else "library.c"),
            SIMULATION / "ods_simulation.c",
            *sorted(runtime.glob("*.o")),
        )
        _compile(
            build,
            home,
            watched,
            *(f"-I{place}" for place in (runtime / "cia" / "c", home / name / "c", home, SIMULATION)),
            *(f'-DDEVICE_HEADER="{name}.h"', f"-DDEVICE_TYPE={name}_t", f"-DDEVICE_INIT={name}_init"),
            *map(str, sources),
            *("-o", product),
            *(() if watched else ("-shared",)),
        )

    product = "testee" if watched else "testee.so"
    runtime = _once(folder, "runtime", (vocabulary.digest, build, watched), make_runtime)
    return _once(folder, "testee", (device.identifier, device.digest, runtime), make) / product


def _condition_names(vocabulary: Vocabulary) -> Iterator[str]:
    for name in vocabulary.conditions:
        yield f'[ODS_CONDITION_{name.upper()}] = "{name}",\n'


def _compile(build: Build, home: Path, watched: bool, *arguments: str) -> None:
    kind: tuple[str, ...]
    if not watched:
        kind = ("-O2", "-fPIC")
    elif COVERAGE:
        kind = ("-O0", "--coverage")
    else:
        kind = ("-O1", *(SANITIZERS if build.links(home, *SANITIZERS) else ()))
    run([*build.command, "-std=c99", *kind, *WARNINGS, f"-I{RUNTIME / 'include'}", *arguments], home)


def _once(folder: Path, name: str, key: object, make: Callable[[Path], None]) -> Path:
    """The folder that `make` fills, by the first process that needs it, for each name and key."""
    home = folder / f"{name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}"
    done = home / "done"
    with _alone(folder / f"{home.name}.lock"):
        if not done.exists():
            home.mkdir(exist_ok=True)
            make(home)
            done.touch()
    return home


def run(command: Iterable[str], folder: Path | None = None) -> str:
    """Run a command, in a folder, and give its output; a failure shows what it said."""
    done = subprocess.run(list(command), cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr[-4000:]}"
    return done.stdout


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def shared_folder(own: Path) -> Path:
    """A folder that all workers of one test run share, given the one of this worker."""
    if COVERAGE:
        Path(COVERAGE).mkdir(parents=True, exist_ok=True)
        return Path(COVERAGE)
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
