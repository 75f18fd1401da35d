"""Each scenario, played to the C testee: what it answers is what the standard, the manual or the contract says."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from tests.cross.driver import Testee
from tests.cross.scenario import Scenario, all_scenarios

from odsmith.model import Device

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("scenario", all_scenarios(), ids=lambda scenario: scenario.name)
def test_c_answers_as_the_scenario_says(
    scenario: Scenario, start: Callable[..., Testee], request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(scenario.device)
    testee = start(device, **scenario.options)
    for step in scenario.steps:
        answer = testee.line(step.line).lines
        assert step.accepts(answer), "\n".join(
            [f"{scenario.path}:{step.number}: > {step.line}", "expected", *step.expected, "answered", *answer]
        )
