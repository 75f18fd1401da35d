"""What all tests share: the compiled models, and the programs that only some machines have."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from tests.cross import devices
from tests.cross.build import Build, build_testee, shared_folder
from tests.cross.driver import Testee
from tests.cross.programs import write_python_testee

from odsmith.compile import compile_file
from odsmith.model import Device
from odsmith.vocabulary import Vocabulary

# Machines are noisy, so no example is judged by its time; CI tries the same examples in each run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.register_profile("fast", deadline=None, max_examples=25)

ROOT = Path(__file__).parent.parent


def pytest_configure(config: pytest.Config) -> None:
    is_fast = config.getoption("markexpr") == "not slow"
    settings.load_profile("fast" if is_fast else "ci" if os.environ.get("CI") else "local")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--accept", action="store_true", help="overwrite expected outputs with the actual ones")


@pytest.fixture(scope="session")
def accept(request: pytest.FixtureRequest) -> bool:
    """Expected outputs are to be overwritten."""
    return bool(request.config.getoption("--accept"))


@pytest.fixture(scope="session")
def root() -> Path:
    """The checkout."""
    return ROOT


@pytest.fixture(scope="session")
def tool() -> Callable[[str], str]:
    """`tool("clang")` gives the path of a program; without it the test is skipped, but fails where CI is set."""

    def find(name: str) -> str:
        path = shutil.which(name)
        if path is None and os.environ.get("CI"):
            pytest.fail(f"{name} is missing: .ci/run must install it")
        if path is None:
            pytest.skip(f"{name} is not installed")
        return path

    return find


@pytest.fixture(scope="session")
def tmcm3230() -> Device:
    return devices.device("tmcm3230")


@pytest.fixture(scope="session")
def tmcm6212() -> Device:
    return devices.device("tmcm6212")


@pytest.fixture(scope="session")
def io_module() -> Device:
    """A device without axes."""
    return devices.device("io_module")


@pytest.fixture(scope="session")
def toy() -> Device:
    """Two axes, no TPDO, no emergencies, hardly a default."""
    return devices.device("toy")


@pytest.fixture(scope="session")
def every_type() -> Device:
    """Everything that the others lack: numbers of 1 and 64 bits in PDOs, texts that can be written, and more."""
    return devices.device("every_type")


@pytest.fixture(scope="session")
def vocabulary() -> Vocabulary:
    return compile_file(ROOT / "spec" / "cia" / "cia.yaml")


@pytest.fixture(scope="session")
def c_build() -> Build:
    """How C is compiled."""
    return Build()


@pytest.fixture(scope="session")
def c_testee(
    c_build: Build, vocabulary: Vocabulary, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[Device], Path]:
    """The program that is the C testee of a device; compiled once in a test run."""
    folder = shared_folder(tmp_path_factory.getbasetemp())
    return lambda device: build_testee(device, vocabulary, c_build, folder)


@pytest.fixture(scope="session")
def python_testee(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Device], Path]:
    """The program that is the Python testee of a device, from its package as the generator makes it now."""
    folder = tmp_path_factory.mktemp("testees")
    return lambda device: write_python_testee(device, folder)


@pytest.fixture
def testee_program(c_testee: Callable[[Device], Path]) -> Callable[[Device], Path]:
    """The program that `start` starts; modules that judge both runtimes say otherwise."""
    return c_testee


@pytest.fixture
def start(testee_program: Callable[[Device], Path]) -> Iterator[Callable[..., Testee]]:
    """`start(device, node_id=5)` starts a testee, still without power. It gives none but the declared abort codes."""
    running: list[tuple[Device, Testee]] = []

    def begin(device: Device, *, node_id: int = 0, serial: int = 0, time: int = 0) -> Testee:
        testee = Testee([str(testee_program(device))], node_id=node_id, serial=serial, time=time)
        running.append((device, testee))
        return testee

    yield begin
    for device, testee in running:
        testee.close()
        declared = {code.code for code in device.abort_codes if code.used}
        assert not declared or testee.abort_codes <= declared
