"""What all tests share: the compiled models, and the programs that only some machines have."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

from odsmith.compile import compile_file
from odsmith.model import Device
from odsmith.vocabulary import Vocabulary

# Machines are noisy, so no example is judged by its time; CI tries the same examples in each run.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")

ROOT = Path(__file__).parent.parent


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


def _device(name: str) -> Device:
    model = compile_file(ROOT / "spec" / name)
    assert isinstance(model, Device)
    return model


@pytest.fixture(scope="session")
def tmcm3230() -> Device:
    return _device("tmcm3230.yaml")


@pytest.fixture(scope="session")
def tmcm6212() -> Device:
    return _device("tmcm6212.yaml")


@pytest.fixture(scope="session")
def io_module() -> Device:
    """A device without axes."""
    return _device("examples/io_module.yaml")


@pytest.fixture(scope="session")
def vocabulary() -> Vocabulary:
    return compile_file(ROOT / "spec" / "cia" / "cia.yaml")
