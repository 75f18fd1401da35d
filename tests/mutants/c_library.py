"""The C runtime with all its mutants, and the tables where they can be changed, as a shared library for each device."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from cffi import FFI  # type: ignore[import-untyped]
from tests.cross.build import RUNTIME, SIMULATION, run
from tests.cross.library import CBench
from tests.mutants import c_code, ramps
from tests.mutants.c_tables import CTables
from tests.mutants.mutant import Catalogue
from tests.mutants.talks import Talk
from tests.unit.runtime_c import test_tables

from odsmith.backends.c import CBackend
from odsmith.model import Device
from odsmith.render import write
from odsmith.vocabulary import Vocabulary

HERE = Path(__file__).parent
DUMPS = HERE.parent / "unit" / "runtime_c"

FLAGS = ("-std=c99", "-O1", "-fPIC", "-w", "-fsanitize=address,undefined", "-fsanitize-undefined-trap-on-error")
"""What a sanitizer sees ends the process, which counts as caught. Warnings are about code that is wrong on purpose."""

SANITIZER = (
    *("detect_leaks=0", "verify_asan_link_order=0", "detect_stack_use_after_return=1"),
    *("quarantine_size_mb=8", "malloc_context_size=0"),  # memory that each process would copy
)

_FFI = FFI()
_FFI.cdef("""
    extern int ods_mutant;
    extern unsigned char ods_mutant_passed[];
    typedef struct {
        const char *name;
        void *at;
        uint32_t rows;
        uint32_t stride;
        uint32_t each;
        uint32_t size;
    } column_t;
    extern column_t mutant_columns[];
    int dump_od(void);
    int dump_known(const uint16_t *indices, unsigned count);
    int dump_indices(void);
    int dump_device(void);
    int fflush(void *stream);
    int64_t ods_ramp_slow_down(int64_t velocity, int64_t deceleration);
    int64_t ods_ramp_turn(int64_t velocity, int64_t target, int64_t acceleration, int64_t v_start, int64_t v_stop);
    int64_t ods_ramp_advance(const int64_t *ramp, int64_t velocity, int64_t distance, int *arrives);
""")


def with_sanitizer(command: list[str]) -> None:
    """Begin anew with the library that these flags need before all others, unless it is there already.

    Programs that are started later do without.
    """
    if "ASAN_OPTIONS" not in os.environ:
        library = subprocess.run(["cc", "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
        environment = {"LD_PRELOAD": library.stdout.strip(), "ASAN_OPTIONS": ":".join(SANITIZER)}
        os.execve(command[0], command, {**os.environ, **environment})
    os.environ.pop("LD_PRELOAD", None)


class CMutants:
    """All mutants of the C runtime and of the tables in C, none of them awake."""

    def __init__(
        self,
        devices: Sequence[Device],
        vocabulary: Vocabulary,
        with_tables: Sequence[str],
        folder: Path,
        pool: Executor,
    ) -> None:
        """Compiles everything in `folder`, which may be a new one."""
        self._folder = folder
        self.code = Catalogue()
        self.tables = Catalogue()
        self._with_tables = with_tables
        self._build(devices, vocabulary, pool)
        self._highest = max(mutant.number for mutant in self.code.mutants)
        self._libraries = {device.identifier: _FFI.dlopen(str(self._path(device.identifier))) for device in devices}
        self._owners: dict[int, CTables] = {}
        for name in with_tables:
            tables = CTables(_FFI, self._libraries[name], name, self.tables)
            self._owners |= dict.fromkeys(tables.numbers(), tables)

    def play(self, talk: Talk) -> list[tuple[str, ...]]:
        if talk.device == ramps.DEVICE:
            generator = _Ramps(next(iter(self._libraries.values())))
            return [ramps.answer(generator, line) for line in talk.lines]
        bench = CBench(self._path(talk.device), **talk.options)
        return [tuple(bench.answer(line)) for line in talk.lines]

    def wake_code(self, number: int) -> None:
        for library in self._libraries.values():
            library.ods_mutant = number

    def passed(self) -> set[int]:
        """Mutants of the code that were passed since the last time."""
        found = set()
        for library in self._libraries.values():
            octets = _FFI.buffer(library.ods_mutant_passed, self._highest + 1)
            found |= {number for number, octet in enumerate(octets[:]) if octet}
            octets[:] = bytes(len(octets))
        return found

    def wake_tables(self, number: int) -> None:
        """There is no way back: it is done in a process of its own."""
        self._owners[number].apply(number)

    # ---- comparing ---------------------------------------------------------------------------------------------------

    def comparisons(self, device: Device, vocabulary: Vocabulary) -> dict[str, Callable[[], bool]]:
        """The tests that compare every row with the model; the objects that there are before all 2^24 addresses.

        Most wrong addresses show in the first sub-indices of some index.
        """
        tables = list(test_tables._expected_tables(device, vocabulary))
        dictionary = list(test_tables._expected_dictionary(device, vocabulary))
        indices = sorted({item.index for item in device.expanded})
        subs = {(item.index, found.entry.sub) for item in device.expanded for found in item.entries}
        first = [f"{index:04X}:{sub} {(index, sub) in subs:d}" for index in indices for sub in range(2)]
        library = self._libraries[device.identifier]
        known = partial(library.dump_known, indices, len(indices))
        return {
            "tables": lambda: _printed(library, library.dump_device) == tables,
            "objects": lambda: _printed(library, known) == dictionary,
            "indices": lambda: _printed(library, library.dump_indices) == first,
            "addresses": lambda: _printed(library, library.dump_od) == dictionary,
        }

    # ---- compiling ---------------------------------------------------------------------------------------------------

    def _path(self, device: str) -> Path:
        return self._folder / f"{device}.so"

    def _build(self, devices: Sequence[Device], vocabulary: Vocabulary, pool: Executor) -> None:
        folder = self._folder
        sources = sorted([*(RUNTIME / "src").glob("*.[ch]"), *SIMULATION.glob("*.[ch]")])
        texts = c_code.instrument(sources, self.code)
        (folder / "src").mkdir(parents=True, exist_ok=True)
        for model in (vocabulary, *devices):
            write(CBackend().render(model), folder)
        for name, text in texts.items():
            (folder / "src" / name).write_text(text)
        (folder / "mutant.h").write_text(c_code.HEADER)
        passed = f"unsigned char ods_mutant_passed[{len(self.code.mutants) + 1}];"
        (folder / "mutant.c").write_text(f"int ods_mutant;\n{passed}\n")
        names = (f'[ODS_CONDITION_{name.upper()}] = "{name}",\n' for name in vocabulary.conditions)
        (folder / "condition_names.h").write_text("".join(names))
        runtime = ["mutant.c", *(f"src/{name}" for name in texts if name.endswith(".c"))]
        tasks = [["-include", "mutant.h", "-c", source, "-o", f"{Path(source).stem}.o"] for source in runtime]
        tasks += [task for device in devices for task in self._tasks(device.identifier)]
        list(pool.map(self._compile, tasks))
        here = c_code.compiled("".join(pool.map(self._preprocessed, runtime[1:])))
        self.code.mutants = [mutant for mutant in self.code.mutants if mutant.number in here]
        objects = [f"{Path(source).stem}.o" for source in runtime]
        for device in devices:
            parts = sorted(str(path) for path in folder.glob(f"{device.identifier}-*.o"))
            self._compile(["-shared", *objects, *parts, "-o", f"{device.identifier}.so"])

    def _tasks(self, device: str) -> Iterator[list[str]]:
        """The arguments that compile what a library has of its device."""
        home = f"{device}/c"
        defines = [
            *(f'-DDEVICE_HEADER="{device}.h"', f"-DDEVICE_TYPE={device}_t", f"-DDEVICE_INIT={device}_init"),
            *(f"-DDEVICE={device}_device", f"-DOD={device}_od", f"-DVALUES={device}_values_t"),
            *(f"-DABORT_CODES={device}_abort_codes", f"-DABORT_COUNT={device.upper()}_ABORT_CODES"),
            *(f'-DDEVICE_TABLES="{device}_device.c"', f'-DOD_TABLES="{device}_od.c"'),
        ]
        tables = [str(HERE / "tables.c")]
        if device not in self._with_tables:
            tables = [f"{home}/{device}_device.c", f"{home}/{device}_od.c"]
        own = [str(HERE.parent / "cross" / "library.c"), str(HERE / "dumps.c")]
        for source in (f"{home}/{device}.c", *own, *tables):
            yield [f"-I{home}", f"-I{DUMPS}", *defines, "-c", source, "-o", f"{device}-{Path(source).stem}.o"]

    def _preprocessed(self, source: str) -> str:
        return run(["cc", "-E", "-P", *self._includes(), "-include", "mutant.h", source], self._folder)

    def _includes(self) -> list[str]:
        return [f"-I{place}" for place in (".", "src", "cia/c", RUNTIME / "include")]

    def _compile(self, arguments: Sequence[str]) -> None:
        run(["cc", *FLAGS, *self._includes(), *arguments], self._folder)


class _Ramps:
    """The ramp generator in a library."""

    def __init__(self, library: Any) -> None:
        self._library = library

    def advance(self, ramp: Sequence[int], velocity: int, distance: int) -> tuple[int, bool]:
        arrives = _FFI.new("int *", 1)  # it has to be told when it does not
        speed = self._library.ods_ramp_advance(list(ramp), velocity, distance, arrives)
        return int(speed), bool(arrives[0])

    def turn(self, velocity: int, target: int, acceleration: int, v_start: int, v_stop: int) -> int:
        return int(self._library.ods_ramp_turn(velocity, target, acceleration, v_start, v_stop))

    def slow_down(self, velocity: int, deceleration: int) -> int:
        return int(self._library.ods_ramp_slow_down(velocity, deceleration))


def _printed(library: Any, function: Callable[[], int]) -> list[str]:
    """The lines that a function prints; none where it complains."""
    sys.stdout.flush()
    with _stdout_in_memory() as file:
        status = function()
        library.fflush(_FFI.NULL)
    with os.fdopen(file) as text:
        text.seek(0)
        return [] if status else text.read().splitlines()


@contextmanager
def _stdout_in_memory() -> Iterator[int]:
    """A file that takes what this process prints."""
    stdout, file = os.dup(1), os.memfd_create("printed")
    os.dup2(file, 1)
    try:
        yield file
    finally:
        os.dup2(stdout, 1)
        os.close(stdout)
