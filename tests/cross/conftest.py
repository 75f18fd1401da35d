"""Devices as Python packages, and testees that run in this process."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable

import pytest
from tests.cross.testee import Bench

from odsmith.backends.python import PythonBackend
from odsmith.model import Device
from odsmith.render import write
from odsmith_runtime.device import Config, Tables


@pytest.fixture(scope="session")
def python_tables(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Device], Tables]:
    """The tables of a device, from its package as the generator makes it now."""
    made: dict[str, Tables] = {}

    def find(device: Device) -> Tables:
        name = device.identity.identifier
        if name not in made:
            folder = tmp_path_factory.mktemp("packages")
            write(PythonBackend().render(device), folder)
            sys.path.insert(0, str(folder / name / "python"))
            sys.modules.pop(name, None)
            made[name] = Tables.of(importlib.import_module(name))
        return made[name]

    return find


@pytest.fixture(scope="session")
def start_python(python_tables: Callable[[Device], Tables]) -> Callable[..., Bench]:
    """`start_python(device, node_id=5)`: a Python testee, still without power."""

    def begin(device: Device, *, node_id: int = 0, serial: int = 0, time: int = 0) -> Bench:
        return Bench(python_tables(device), Config(serial_number=serial, node_id=node_id), time)

    return begin
