"""The TMCM-6212 as a virtual device, in Python and in C."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest
from tests.cross.build import shared_folder

from odsmith_runtime.device import Frame
from odsmith_runtime.io import VirtualDevice

ROOT = Path(__file__).parents[4]

Make = Callable[..., VirtualDevice]


def generated(name: str) -> ModuleType:
    """A generated package of the checkout."""
    for folder in ("cia", name):
        path = str(ROOT / "generated" / folder / "python")
        if path not in sys.path:
            sys.path.insert(0, path)
    return importlib.import_module(name)


@pytest.fixture(scope="session")
def package() -> ModuleType:
    return generated("tmcm6212")


@pytest.fixture(scope="session")
def other_package() -> ModuleType:
    return generated("tmcm3230")


@pytest.fixture(scope="session")
def c_library(tmp_path_factory: pytest.TempPathFactory, tool: Callable[[str], str]) -> Iterator[Path]:
    """The library of the C engine, in a cache of its own."""
    from odsmith.compile import compile_spec
    from odsmith.engine import build

    tool("cc")
    home = shared_folder(tmp_path_factory.getbasetemp()) / "cache"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(home))
        yield build(compile_spec(ROOT / "spec" / "tmcm6212.yaml"))


@pytest.fixture(params=["python", pytest.param("c", marks=pytest.mark.slow)])
def make(request: pytest.FixtureRequest, package: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Make:
    """`make(node_id=5)` gives a virtual device that nobody has started, on each engine."""
    choice: str = request.param
    if choice == "c":
        library: Path = request.getfixturevalue("c_library")
        monkeypatch.setenv("XDG_CACHE_HOME", str(library.parents[3]))
    return lambda node_id=1, **options: VirtualDevice(package, node_id, engine=choice, **options)


@pytest.fixture
def device(package: ModuleType) -> VirtualDevice:
    """A device in Python, as node 1, that nobody has started."""
    return VirtualDevice(package, engine="python")


def read(index: int, sub: int = 0, node: int = 1) -> Frame:
    """A request to read."""
    return Frame(0x600 + node, bytes([0x40, index & 0xFF, index >> 8, sub, 0, 0, 0, 0]))


def write(index: int, value: int, size: int, sub: int = 0, node: int = 1) -> Frame:
    """A request to write."""
    command = 0x23 | (4 - size) << 2
    number = (value & ((1 << 8 * size) - 1)).to_bytes(4, "little")
    return Frame(0x600 + node, bytes([command, index & 0xFF, index >> 8, sub]) + number)


def number(device: VirtualDevice, index: int, sub: int = 0) -> int:
    octets = device.engine.read(index, sub)
    assert isinstance(octets, bytes)
    return int.from_bytes(octets, "little", signed=True)
