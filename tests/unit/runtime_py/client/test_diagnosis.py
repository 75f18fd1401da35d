"""Why an axis is where it is, from words that no device needs to say."""

from __future__ import annotations

from types import ModuleType

import pytest
from canopen.emcy import EmcyError

from odsmith_runtime.client import StateTimeoutError, diagnosis
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
        (
            0x0250,
            "controlword of axis 2 (7040h) does not say shutdown, bits 1, 2 = 1 and bits 0, 7 = 0",
            "shutdown to ready_to_switch_on by enable()",
        ),
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


def told(facts: Facts, word: int, wanted: str, **values: int) -> tuple[str, str]:
    """What blocks axis 0 and what leads on, with values by their roles; after a time-out of 5 s."""
    error = diagnosis.state_error(facts, 0, diagnosis.see(facts, word, 1), wanted, [], values, 5)
    assert isinstance(error, StateTimeoutError)
    assert error.seen in str(error)
    return error.blocked_by, error.next_step


def test_a_controlword_that_says_something_else(facts: Facts) -> None:
    blocked_by, next_step = told(facts, 0x0231, "operation_enabled", controlword=0x0006)
    assert (
        blocked_by
        == "controlword of axis 0 (6040h) is 0006h: it does not say switch_on, bits 0, 1, 2 = 1 and bits 3, 7 = 0"
    )
    assert next_step == "switch_on or switch_on_and_enable_operation to switched_on by enable()"
    late, _ = told(facts, 0x0231, "operation_enabled", controlword=0x0007)
    assert late.endswith("it says switch_on, bits 0, 1, 2 = 1 and bits 3, 7 = 0, but the axis did not follow")


def test_a_delay_that_runs_is_named(facts: Facts) -> None:
    delays = {"enable_drive_delay_time": 700, "brake_delay_times_release": 30, "brake_delay_times_apply": 40}
    blocked_by, next_step = told(facts, 0x0233, "operation_enabled", controlword=0x000F, **delays)
    assert "enable_drive_delay_time of axis 0 (200Ah) is 700 ms" in blocked_by
    assert "brake_delay_times.release of axis 0 (2002h:02) is 30 ms" in blocked_by
    assert next_step == "none but to wait: operation_enabled comes of itself"
    modes = {"modes_of_operation_display": 3}
    blocked_by, next_step = told(facts, 0x4237, "switched_on", controlword=0x0007, **delays, **modes)
    assert "it slows down by profile_acceleration of axis 0 (6083h), then the brake takes its time" in blocked_by
    assert "brake_delay_times.apply of axis 0 (2002h:01) is 40 ms" in blocked_by
    assert next_step == "none but to wait: switched_on comes of itself"


def test_waits_that_are_not_for_a_state(facts: Facts) -> None:
    modes = {"modes_of_operation": 8, "modes_of_operation_display": 1}
    blocked_by, next_step = told(facts, 0x4237, diagnosis.STANDSTILL, **modes)
    assert blocked_by.startswith(
        "bit 14 of the statusword (motor activity) is 1: it slows down by profile_deceleration"
    )
    assert next_step == "quick_stop(), or wait longer"
    blocked_by, next_step = told(facts, 0x4217, diagnosis.STANDSTILL, **modes)
    assert "quick_stop_deceleration of axis 0 (6085h)" in blocked_by
    assert next_step == "none but to wait"
    blocked_by, next_step = told(facts, 0x0237, diagnosis.ACKNOWLEDGE, **modes)
    assert blocked_by.startswith(
        "bit 12 of the statusword (set-point acknowledge) is 0 after bit 4 was set in controlword"
    )
    assert "modes_of_operation_display of axis 0 (6061h) is 1" in next_step
    blocked_by, _ = told(facts, 0x1237, diagnosis.ACKNOWLEDGE, **modes)
    assert "is 1 after bit 4 was taken out of controlword of axis 0 (6040h)" in blocked_by
    for word in (0x0237, 0x0218):
        blocked_by, next_step = told(facts, word, diagnosis.MODE, **modes)
        assert blocked_by.startswith(
            "modes_of_operation_display of axis 0 (6061h) is 1, while modes_of_operation of axis 0"
        )
        assert next_step.startswith("set_mode() once more")


def test_a_fault_that_was_reset_is_over(facts: Facts) -> None:
    rows = {row.condition: row for row in facts.emergencies}

    def frame(condition: str, axis: int) -> EmcyError:
        row = rows[condition]
        return EmcyError(row.code, 1, bytes(axis if octet == "axis" else octet for octet in row.bytes), 0.0)

    frames = [frame("overtemperature", 1), frame("fault_reset", 0), frame("fault_reset", 255)]
    assert diagnosis.last_fault(facts, 1, frames) is not None  # it was another axis
    frames.append(frame("fault_reset", 1))
    assert diagnosis.last_fault(facts, 1, frames) is None
    frames.append(frame("stall", 1))
    found = diagnosis.last_fault(facts, 1, frames)
    assert found is not None
    assert found.title == rows["stall"].title


def test_an_emergency_that_nobody_documents(facts: Facts) -> None:
    error = diagnosis.emergency(facts, EmcyError(0x9999, 1, bytes(5), 0.0))
    assert str(error) == "the device reports unknown emergency (emergency 9999h)"
    assert error.emergency is None


def test_a_statusword_in_words(facts: Facts) -> None:
    assert str(diagnosis.see(facts, 0x1637, 1)) == (
        "operation_enabled, statusword 1637h: remote, set_point_acknowledge, target_reached, voltage_enabled"
    )
    assert str(diagnosis.see(facts, 0x0001, 1)).startswith("an unknown state (0001h)")
