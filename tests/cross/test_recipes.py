"""The recipes of the manual, as the model has them, work on both runtimes as they are written.

A step that writes is an SDO download, one that expects polls by SDO until what it says has come true, a wait lets time
pass, and an input is one of the simulated hardware.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.cross import expected
from tests.cross.driver import Testee

from odsmith.model import Device, ExpandedEntry, Mode, Step

pytestmark = pytest.mark.slow

POLL_US = 10_000
PATIENCE_US = 60_000_000
"""How long a step may take to come true: the longest move is one of about eleven seconds."""


@pytest.fixture(params=["c", "python"])
def testee_program(request: pytest.FixtureRequest) -> Callable[[Device], Path]:
    program: Callable[[Device], Path] = request.getfixturevalue(f"{request.param}_testee")
    return program


class Cook:
    """Carries out the steps of recipes of a mode on an axis."""

    def __init__(self, testee: Testee, device: Device, axis: int, mode: Mode) -> None:
        self.testee = testee
        self.device = device
        self.axis = axis
        self.status_bits = {bit.name: bit.mask for bit in (*self._entry("statusword").entry.bits, *mode.status_bits)}

    def do(self, step: Step) -> None:
        for name, value in step.arguments:
            match step.kind:
                case "write":
                    self._write(name, value)
                case "expect":
                    self._wait_for(name, value)
                case "wait":
                    self.testee.advance(1000 * int(value))
                case "input":
                    self.testee.input(f"axis{self.axis}.{name}", int(value))
                case _:
                    raise NotImplementedError(f"no recipe has had a step `{step.kind}` so far")

    def _entry(self, name: str) -> ExpandedEntry:
        """That of this axis which a step calls `object` or `object.sub_name`."""
        object_name, _, sub_name = name.partition(".")
        objects = (obj for obj in self.device.expanded if obj.object.name == object_name and obj.axis == self.axis)
        return next(item for obj in objects for item in obj.entries if item.entry.name == (sub_name or object_name))

    def _write(self, name: str, value: int | str) -> None:
        item = self._entry(name)
        assert isinstance(value, int)
        refused = self.testee.sdo_write(item.index, item.entry.sub, expected.encode(item.entry, value))
        assert not refused, f"{name} := {value} is refused with {refused:08X}h"

    def _read(self, name: str) -> int:
        item = self._entry(name)
        octets = self.testee.sdo_read(item.index, item.entry.sub)
        assert isinstance(octets, bytes)
        return int.from_bytes(octets, "little", signed=item.entry.type.signed)

    def _wait_for(self, name: str, value: int | str) -> None:
        end = self.testee.now + PATIENCE_US
        while not self._holds(name, value):
            assert self.testee.now < end, f"{name} does not become {value}"
            self.testee.advance(POLL_US)

    def _holds(self, name: str, value: int | str) -> bool:
        if name == "state":
            state = next(state for state in self.device.pds_states if state.name == value)
            return self._read("statusword") & state.mask == state.value
        if name == "status_bit":
            return bool(self._read("statusword") & self.status_bits[str(value)])
        return self._read(name) == value


def all_recipes(device: Device) -> Iterator[tuple[Mode, str, tuple[Step, ...]]]:
    for mode in device.modes:
        for recipe in mode.recipes:
            yield mode, recipe.name, recipe.steps


@pytest.mark.parametrize(("name", "axis"), [("tmcm3230", 0), ("tmcm6212", 5)])
def test_recipes(name: str, axis: int, start: Callable[..., Testee], request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    recipes = list(all_recipes(device))
    assert recipes
    for mode, recipe, steps in recipes:
        testee = start(device, node_id=5)
        testee.power()
        cook = Cook(testee, device, axis, mode)
        for number, step in enumerate(steps, start=1):
            try:
                cook.do(step)
            except AssertionError as error:
                pytest.fail(f"{recipe}, step {number} ({step.text or step.arguments}): {error}")
