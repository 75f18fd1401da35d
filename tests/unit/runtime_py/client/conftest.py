"""The TMCM-6212 in this process, on both engines, with both faces of its drive."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from tests.unit.runtime_py.client.faces import FACES, Bench
from tests.unit.runtime_py.io.conftest import c_library, generated

__all__ = ["c_library"]

ENGINES = ("python", pytest.param("c", marks=pytest.mark.slow))


@pytest.fixture(scope="session")
def package() -> ModuleType:
    """The generated package `tmcm6212`."""
    return generated("tmcm6212")


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Python, and C where there is a compiler."""
    choice: str = request.param
    if choice == "c":
        library: Path = request.getfixturevalue("c_library")
        monkeypatch.setenv("XDG_CACHE_HOME", str(library.parents[3]))
    return choice


@pytest.fixture(params=FACES)
def bench(request: pytest.FixtureRequest, package: ModuleType, engine: str) -> Bench:
    """A device and a drive of each face."""
    return Bench(package, request.param, engine)


@pytest.fixture
def blocking(package: ModuleType) -> Bench:
    """A device and a drive of the blocking face, where one is enough."""
    return Bench(package, "blocking")
