"""The generated C of all models in one folder, and a way to compile test programs against it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest

from odsmith.backends.c import CBackend
from odsmith.compile import compile_file
from odsmith.model import Device
from odsmith.render import write
from odsmith.vocabulary import Vocabulary

HERE = Path(__file__).parent

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")


@dataclass(frozen=True)
class CTree:
    """A folder with the generated C of the vocabulary and of devices, beside the runtime's headers."""

    folder: Path
    runtime: Path

    def sources(self, device: str) -> list[Path]:
        return sorted((self.folder / device / "c").glob("*.c"))

    def headers(self, device: str) -> list[Path]:
        return sorted((self.folder / device / "c").rglob("*.h"))

    def includes(self, *devices: str) -> list[str]:
        folders = [self.runtime / "include", *(self.folder / name / "c" for name in ("cia", *devices))]
        return [f"-I{folder}" for folder in folders]


@pytest.fixture(scope="session")
def toy(root: Path) -> Device:
    """Two axes, no TPDO, no emergencies, hardly a default."""
    model = compile_file(root / "tests" / "golden" / "toy.yaml")
    assert isinstance(model, Device)
    return model


@pytest.fixture(scope="session")
def ctree(
    tmp_path_factory: pytest.TempPathFactory,
    root: Path,
    tmcm3230: Device,
    tmcm6212: Device,
    io_module: Device,
    toy: Device,
    vocabulary: Vocabulary,
) -> CTree:
    folder = tmp_path_factory.mktemp("generated")
    for model in (tmcm3230, tmcm6212, io_module, toy, vocabulary):
        write(CBackend().render(model), folder)
    return CTree(folder, root / "runtime_c")


Run = Callable[[Iterable[str]], str]


@pytest.fixture(scope="session")
def run() -> Run:
    """Run a command and give its output; a failure shows what it said."""

    def run_command(command: Iterable[str]) -> str:
        done = subprocess.run(list(command), capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr[-4000:]}"
        return done.stdout

    return run_command


@pytest.fixture(scope="session")
def compiles(tool: Callable[[str], str], tmp_path_factory: pytest.TempPathFactory) -> Callable[..., list[str]]:
    """`compiles("gcc", "-m32")` gives the beginning of a command; skips where this compiler cannot link for 32 bits."""

    def find(compiler: str, *flags: str) -> list[str]:
        command = [tool(compiler), *flags]
        if "-m32" in flags:
            probe = tmp_path_factory.mktemp("probe") / "probe.c"
            probe.write_text("#include <stdint.h>\nint main(void) { return 0; }\n")
            done = subprocess.run([*command, str(probe), "-o", str(probe.with_suffix(""))], capture_output=True)
            if done.returncode:
                tool("the 32-bit C library of " + compiler)  # no such program: skips, or fails in CI
        return command

    return find


@pytest.fixture(scope="session")
def run_dump(
    ctree: CTree, run: Run, compiles: Callable[..., list[str]], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., list[str]]:
    """Compile and run `dump_od` or `dump_device` for a device; gives the lines that it prints."""

    def dump(program: str, device: str, compiler: str = "cc", *flags: str) -> list[str]:
        binary = tmp_path_factory.mktemp(program) / program
        run(
            [
                *compiles(compiler, *flags),
                *("-std=c99", "-O1", *WARNINGS, *ctree.includes(device)),
                f'-DDEVICE_HEADER="{device}_device.h"',
                f"-DDEVICE={device}_device",
                f"-DABORT_CODES={device}_abort_codes",
                f"-DABORT_COUNT={device.upper()}_ABORT_CODES",
                *map(str, ctree.sources(device)),
                str(HERE / f"{program}.c"),
                *("-o", str(binary)),
            ]
        )
        return run([str(binary)]).splitlines()

    return dump
