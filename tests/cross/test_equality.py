"""The C testee and the Python testee are one device: on the same lines they give the same text.

Both run in this process, which a few tests hold to the programs. Scenarios are played once as they are and once with a
clock that is about to wrap; what they expect is judged in both, so that a wrap which both runtimes get wrong does not
pass; hypothesis writes more. Differences that are known stand in `divergences.yaml`, by the name of the scenario: it
has to be empty, and one that is no difference any more fails.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.cross import events
from tests.cross.clocks import CLOCKS, PLAIN, WRAPPING
from tests.cross.driver import Testee
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.scenario import SCENARIOS, Scenario, all_scenarios
from tests.cross.testee import Bench

from odsmith.model import Device

pytestmark = pytest.mark.slow

KNOWN: dict[str, str] = yaml.safe_load((SCENARIOS.parent / "divergences.yaml").read_text()) or {}

ENDING = ("DUMP 0000-FFFF", "NVM")

StartPython = Callable[..., Bench]


class Answering(Protocol):
    """What all testees are."""

    def answer(self, line: str) -> list[str]: ...


def first_difference(lines: Sequence[str], in_c: Answering, in_python: Answering) -> str:
    """The dialogue up to the first line that the two answer differently; nothing if they are equal."""
    for number, line in enumerate(lines, start=1):
        c, python = in_c.answer(line), in_python.answer(line)
        if c != python:
            return "\n".join([*(f"> {text}" for text in lines[:number]), "--- C", *c, "--- Python", *python])
    return ""


@pytest.mark.parametrize("clock", [PLAIN, WRAPPING], ids=["plain", "wrapping"])
@pytest.mark.parametrize("scenario", all_scenarios(), ids=lambda scenario: scenario.name)
def test_scenario(
    scenario: Scenario, clock: int, start_c: StartC, start_python: StartPython, request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(scenario.device)
    options = {**scenario.options, **({"time": clock} if clock else {})}
    judged = start_c(device, **options)
    scenario.judge(lambda line: tuple(judged.answer(line)))
    lines = [*scenario.lines, *ENDING]
    difference = first_difference(lines, start_c(device, **options), start_python(device, **options))
    if scenario.name in KNOWN:
        assert difference, f"{scenario.name} is equal now: take it off the known differences"
    else:
        assert not difference, difference


@pytest.mark.parametrize("scenario", all_scenarios()[::3], ids=lambda scenario: scenario.name)
def test_a_scenario_that_a_reset_interrupts(
    scenario: Scenario, start_c: StartC, start_python: StartPython, request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(scenario.device)
    twins = (start(device, **scenario.options) for start in (start_c, start_python))
    difference = first_difference([*scenario.interrupted, *ENDING], *twins)
    assert not difference, difference


def test_no_difference_is_known() -> None:
    assert not KNOWN


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212", "io_module", "toy", "every_type"])
@settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_any_dialogue(
    name: str, data: st.DataObject, start_c: StartC, start_python: StartPython, request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(name)
    node_id = data.draw(st.sampled_from([1, 5, 127]), "node-ID")
    lines = data.draw(events.dialogues(device, node_id), "lines")
    clock = data.draw(st.sampled_from(CLOCKS), "clock")
    in_c = start_c(device, node_id=node_id, time=clock)
    difference = first_difference(lines, in_c, start_python(device, node_id=node_id, time=clock))
    assert not difference, difference


ODD_LINES = ["", " ", "T", "T 1 ", "RX 800", "POWER on", "T 2147483648", f"RX 601{' 00' * 90}", " ".join("T" * 41)]


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_programs_are_what_runs_in_this_process(
    name: str,
    c_testee: Callable[[Device], Path],
    python_testee: Callable[[Device], Path],
    start_c: StartC,
    start_python: StartPython,
    request: pytest.FixtureRequest,
) -> None:
    """Every twentieth scenario, and lines that are none; the C program is the one that sanitizers watch."""
    device: Device = request.getfixturevalue(name)
    for scenario in [scenario for scenario in all_scenarios() if scenario.device == name][::20]:
        lines = [*ODD_LINES, *scenario.lines, *ENDING, *ODD_LINES]
        for program, inside in ((c_testee, start_c), (python_testee, start_python)):
            with Testee([str(program(device))], **scenario.options) as outside:
                expected = inside(device, **scenario.options)
                for line in lines:
                    assert list(outside.line(line).lines) == expected.answer(line), f"{scenario.name}: {line}"
