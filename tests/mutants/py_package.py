"""The Python runtime with all its mutants, and the tables of packages that can be changed."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from tests.cross.testee import Bench
from tests.mutants import ramps
from tests.mutants.mutant import Catalogue
from tests.mutants.py_code import ChangedRuntime
from tests.mutants.py_tables import PyTables
from tests.mutants.talks import Talk
from tests.unit.generator.backends.python import test_backend

from odsmith.backends.python import PythonBackend
from odsmith.model import Device
from odsmith.render import write
from odsmith_runtime.device import Config, Tables, ramp

ROW_BY_ROW: tuple[Callable[[Any], None], ...] = (
    test_backend.test_every_object,
    test_backend.test_every_entry,
    test_backend.test_exactly_these_addresses_are_there,
    test_backend.test_every_pdo,
    test_backend.test_every_row_of_the_tables,
    test_backend.test_the_name_plate,
    test_backend.test_a_node_finds_all_tables_that_it_needs,
    test_backend.test_error_behaviour,
    test_backend.test_the_layout_follows_from_the_package,
    test_backend.test_words_of_emergencies,
)
"""Tests that compare a package with its model."""


@dataclass(frozen=True)
class Package:
    """What these tests ask for."""

    model: Device
    module: Any

    @property
    def dictionary(self) -> Any:
        return self.module.DICTIONARY


class PyMutants:
    """All mutants of the Python runtime and of the tables in Python, none of them awake."""

    def __init__(
        self, runtime: ChangedRuntime, devices: Sequence[Device], with_tables: Sequence[str], folder: Path
    ) -> None:
        """`runtime` is loaded already. Packages are generated in `folder`; nobody may have used them before."""
        self._runtime = runtime
        self.code = runtime.catalogue
        self.tables = Catalogue()
        self._packages = {device.identifier: Package(device, _package(device, folder)) for device in devices}
        self._owners: dict[int, PyTables] = {}
        for name in with_tables:
            tables = PyTables(self._packages[name].module, self.tables)
            self._owners |= dict.fromkeys(tables.numbers(), tables)

    def play(self, talk: Talk) -> list[tuple[str, ...]]:
        if talk.device == ramps.DEVICE:
            return [ramps.answer(_Ramps(), line) for line in talk.lines]
        config = Config(serial_number=talk.options.get("serial", 0), node_id=talk.options.get("node_id", 0))
        bench = Bench(Tables.of(self._packages[talk.device].module), config, talk.options.get("time", 0))
        return [tuple(bench.answer(line)) for line in talk.lines]

    def wake_code(self, number: int) -> None:
        self._runtime.wake(number)

    def passed(self) -> set[int]:
        """Mutants of the code that were passed since the last time."""
        return self._runtime.passed()

    def wake_tables(self, number: int) -> None:
        """There is no way back: it is done in a process of its own."""
        self._owners[number].apply(number)

    def comparisons(self, device: str) -> dict[str, Callable[[], bool]]:
        """The tests that compare every row with the model."""
        package = self._packages[device]
        areas = tuple((area.first, area.last, area.stride) for area in package.model.areas if area.stride)
        tests = {test.__name__: partial(_passes, test, package) for test in ROW_BY_ROW}
        return {**tests, "areas": lambda: package.dictionary.areas == areas}


class _Ramps:
    """The ramp generator in Python."""

    def advance(self, numbers: Sequence[int], velocity: int, distance: int) -> tuple[int, bool]:
        return ramp.advance(ramp.Ramp(*numbers), velocity, distance)

    def turn(self, velocity: int, target: int, acceleration: int, v_start: int, v_stop: int) -> int:
        return ramp.turn(velocity, target, acceleration, v_start, v_stop)

    def slow_down(self, velocity: int, deceleration: int) -> int:
        return ramp.slow_down(velocity, deceleration)


def _passes(test: Callable[[Any], None], package: Package) -> bool:
    try:
        test(package)
    except AssertionError:
        return False
    return True


def _package(device: Device, folder: Path) -> Any:
    write(PythonBackend().render(device), folder)
    sys.path.insert(0, str(folder / device.identifier / "python"))
    return importlib.import_module(device.identifier)
