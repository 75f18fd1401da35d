"""The generated C of all models in one folder, and a way to compile test programs against it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.cross.build import COVERAGE, WARNINGS, Build
from tests.cross.build import run as run_command

from odsmith.backends.c import CBackend
from odsmith.model import Device
from odsmith.render import write
from odsmith.vocabulary import Vocabulary

HERE = Path(__file__).parent


@dataclass(frozen=True)
class CTree:
    """A folder with the generated C of the vocabulary and of devices, beside the runtime's headers."""

    folder: Path
    runtime: Path

    def sources(self, device: str) -> list[Path]:
        return sorted((self.folder / device / "c").glob("*.c"))

    def tables(self, device: str) -> list[Path]:
        """Those that need no runtime but the look-up."""
        return [self.runtime / "src" / "ods_od.c", *(path for path in self.sources(device) if path.stem != device)]

    def headers(self, device: str) -> list[Path]:
        return sorted((self.folder / device / "c").rglob("*.h"))

    def includes(self, *devices: str) -> list[str]:
        folders = [self.runtime / "include", *(self.folder / name / "c" for name in ("cia", *devices))]
        return [f"-I{folder}" for folder in folders]


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
    return run_command


@pytest.fixture(scope="session")
def compiles(tool: Callable[[str], str], tmp_path_factory: pytest.TempPathFactory) -> Callable[..., list[str]]:
    """`compiles("gcc", "-m32")` gives the beginning of a command; skips where this compiler cannot link for 32 bits."""

    def find(compiler: str, *flags: str) -> list[str]:
        build = Build(tool(compiler), flags)
        if "-m32" in flags and not build.links(tmp_path_factory.mktemp("probe")):
            tool("the 32-bit C library of " + compiler)  # no such program: skips, or fails in CI
        return build.command

    return find


@pytest.fixture(scope="session")
def run_dump(
    ctree: CTree, run: Run, compiles: Callable[..., list[str]], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., list[str]]:
    """Compile and run `dump_od`, `dump_device` or `dump_init` for a device; gives the lines that it prints."""

    def dump(program: str, device: str, compiler: str = "cc", *flags: str) -> list[str]:
        binary = tmp_path_factory.mktemp(program) / program
        run(
            [
                *compiles(compiler, *flags),
                *("-std=c99", "-O1", *WARNINGS, *ctree.includes(device)),
                f'-DDEVICE_HEADER="{device}_device.h"',
                f'-DNODE_HEADER="{device}.h"',
                f"-DNODE={device}_t",
                f"-DINIT={device}_init",
                f"-DDEVICE={device}_device",
                f"-DVALUES={device}_values_t",
                f"-DABORT_CODES={device}_abort_codes",
                f"-DABORT_COUNT={device.upper()}_ABORT_CODES",
                *map(str, ctree.sources(device) if program == "dump_init" else ctree.tables(device)),
                str(HERE / f"{program}.c"),
                *("-o", str(binary)),
            ]
        )
        return run([str(binary)]).splitlines()

    return dump


@pytest.fixture(
    scope="session",
    params=[
        pytest.param(("gcc", "-m64"), id="gcc-m64"),
        pytest.param(("gcc", "-m32"), id="gcc-m32"),
        pytest.param(("clang", "-m64"), id="clang-m64"),
        pytest.param(("clang", "-m32"), id="clang-m32"),
    ],
)
def c_build(request: pytest.FixtureRequest, compiles: Callable[..., list[str]]) -> Build:
    """Every compiler at hand; lines are counted with one of them."""
    if COVERAGE and request.param != ("gcc", "-m64"):
        pytest.skip("lines are counted with gcc, 64 bit")
    compiler, *flags = compiles(*request.param)
    return Build(compiler, tuple(flags))
