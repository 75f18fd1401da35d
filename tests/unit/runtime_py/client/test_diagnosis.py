"""Why an axis is where it is, from words that no device needs to say."""

from __future__ import annotations

from types import ModuleType

import pytest
from canopen.emcy import EmcyError

from odsmith_runtime.client import diagnosis
from odsmith_runtime.client.facts import Facts


@pytest.fixture
def facts(package: ModuleType) -> Facts:
    return Facts.of(package.__name__)


@pytest.mark.parametrize(
    ("word", "blocked_by", "next_step"),
    [
        (0x0050, "bit 9 of the statusword (remote) is 0", "leave TMCL mode"),
        (0x0240, "bit 4 of the statusword (voltage enabled) is 0", "switch them on, then enable()"),
        (0x0217, "quick_stop_option_code of axis 2 (705Ah) holds it there", "disable(), or enable()"),
        (0x0250, "the drive takes its time, or was not told", "shutdown to ready_to_switch_on by enable()"),
        (0x0218, "bit 3 of the statusword (fault): a fault that came without an emergency", "reset_fault()"),
    ],
)
def test_what_blocks_an_axis(facts: Facts, word: int, blocked_by: str, next_step: str) -> None:
    seen = diagnosis.see(facts, word, 1)
    error = diagnosis.state_error(facts, 2, seen, "operation_enabled", [])
    assert error.blocked_by.startswith(blocked_by)
    assert error.next_step.startswith(next_step)
    assert error.axis == 2
    assert str(error) == (
        f"axis 2 is in {seen.state}, not in operation_enabled: {error.blocked_by}. Next step: {error.next_step}"
    )


def test_the_last_fault_of_the_axis_counts(facts: Facts) -> None:
    rows = {row.condition: row for row in facts.emergencies}

    def frame(condition: str, axis: int) -> EmcyError:
        row = rows[condition]
        return EmcyError(row.code, 1, bytes(axis if octet == "axis" else octet for octet in row.bytes), 0.0)

    frames = [frame("overtemperature", 1), frame("following_error", 1), frame("overtemperature", 0)]
    found = diagnosis.last_fault(facts, 1, frames)
    assert found is not None
    assert found.emergency is not None
    assert (found.axis, found.emergency.condition) == (1, "following_error")
    assert diagnosis.last_fault(facts, 2, frames) is None


def test_an_emergency_that_nobody_documents(facts: Facts) -> None:
    error = diagnosis.emergency(facts, EmcyError(0x9999, 1, bytes(5), 0.0))
    assert str(error) == "the device reports unknown emergency (emergency 9999h)"
    assert error.emergency is None


def test_a_statusword_in_words(facts: Facts) -> None:
    assert str(diagnosis.see(facts, 0x1637, 1)) == (
        "operation_enabled, statusword 1637h: remote, set_point_acknowledge, target_reached, voltage_enabled"
    )
    assert str(diagnosis.see(facts, 0x0001, 1)).startswith("an unknown state (0001h)")
