"""Each scenario, played to both testees: what they answer is what the standard, the manual or the contract says.

Here the clock begins as the scenario has it, and sanitizers watch the C testee; `test_equality.py` judges the same with
a clock that is about to wrap.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from _pytest.mark import ParameterSet
from tests.cross.driver import Testee
from tests.cross.scenario import Scenario, all_scenarios
from tests.cross.testee import Bench

from odsmith.model import Device

QUICK = 3
"""Each third scenario is among the fast tests."""

LONG_US = 2_000_000
"""What takes longer in the device takes long in Python, too."""


def _parameter(number: int, scenario: Scenario) -> ParameterSet:
    times = (int(step.line[2:]) for step in scenario.steps if step.line.startswith("T "))
    is_slow = number % QUICK or sum(times) > LONG_US
    return pytest.param(scenario, id=scenario.name, marks=[pytest.mark.slow] if is_slow else [])


each_scenario = pytest.mark.parametrize("scenario", [_parameter(*each) for each in enumerate(all_scenarios())])


@pytest.mark.slow
@each_scenario
def test_c_answers_as_the_scenario_says(
    scenario: Scenario, start: Callable[..., Testee], request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(scenario.device)
    testee = start(device, **scenario.options)
    scenario.judge(lambda line: testee.line(line).lines)


@each_scenario
def test_python_answers_as_the_scenario_says(
    scenario: Scenario, start_python: Callable[..., Bench], request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(scenario.device)
    bench = start_python(device, **scenario.options)
    scenario.judge(lambda line: tuple(bench.answer(line)))


def test_there_are_scenarios_for_every_abort_code(tmcm3230: Device, tmcm6212: Device) -> None:
    """Each code that a device declares as used is expected by a scenario of that device."""
    for device in (tmcm3230, tmcm6212):
        expected = {
            int.from_bytes(bytes.fromhex(line)[-4:], "little")
            for scenario in all_scenarios()
            if scenario.device == device.identity.identifier
            for step in scenario.steps
            for frame in step.expected
            if frame.startswith("TX 5") and (line := frame[7:]).startswith("80 ")
        }
        assert {code.code for code in device.abort_codes if code.used} <= expected
