"""What an axis does, told once for both faces."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from tests.unit.runtime_py.client.faces import Bench, did, ready, tune

from odsmith_runtime import OutOfRangeError
from odsmith_runtime.client import EmergencyError, MotionError, MotionTimeoutError, StateError, StateTimeoutError


def test_moves_in_three_units(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.move_to(1000))
        assert await did(axis.position()) == 1000
        await did(axis.move_to(10, unit="steps"))
        assert await did(axis.position()) == 2560
        await did(axis.move_to(Fraction(1, 8), unit="revolutions"))
        assert await did(axis.position()) == 6400
        await did(axis.move_by(-400))
        assert await did(axis.position()) == 6000
        assert await did(axis.position_in("revolutions")) == Fraction(6000, 51_200)

    bench.play(story)


def test_a_velocity_in_internal_units(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await did(axis.velocity_dimension_index.write(0))
        axis = await ready(drive)
        await did(axis.run(1, unit="rev/s"))
        assert await did(axis.target_velocity.read()) == round(51_200 * Fraction(16384, 15625))
        assert abs(await did(axis.velocity_in("rev/s")) - 1) < Fraction(1, 10_000)

    bench.play(story)


def test_run_and_stop(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.run(-20_000))
        assert await did(axis.velocity()) == -20_000
        await did(axis.stop())
        assert await did(axis.velocity()) == 0
        assert await did(axis.state()) == "operation_enabled"

    bench.play(story)


def test_stopping_a_move_forgets_it(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.move_to(1_000_000, wait=False))
        bench.network.advance(20_000)
        await did(axis.stop())
        where = await did(axis.position())
        assert 0 < where < 1_000_000
        bench.network.advance(50_000)
        assert await did(axis.position()) == where
        await did(axis.move_to(where + 100))

    bench.play(story)


def test_halt_and_resume(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.move_to(100_000, wait=False))
        bench.network.advance(20_000)
        await did(axis.halt())
        where = await did(axis.position())
        bench.network.advance(50_000)
        assert await did(axis.position()) == where < 100_000
        await did(axis.resume())
        await did(axis.wait())
        assert await did(axis.position()) == 100_000

    bench.play(story)


def test_running_takes_a_halt_back(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.run(20_000))
        await did(axis.halt())
        assert await did(axis.velocity()) == 0
        await did(axis.run(30_000, timeout=1))
        assert await did(axis.velocity()) == 30_000
        await did(axis.halt())
        where = await did(axis.position())
        await did(axis.move_to(where - 100, timeout=1))
        assert await did(axis.position()) == where - 100
        assert await did(axis.controlword.read()) == 0x0F

    bench.play(story)


def test_a_new_target_replaces_one_that_is_halted(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.move_to(1_000_000, wait=False))
        bench.network.advance(20_000)
        await did(axis.halt())
        where = await did(axis.position())
        highest = where
        await did(axis.move_to(0, wait=False))
        for _ in range(100):
            bench.network.advance(1000)
            highest = max(highest, bench.device.shaft(0))
        assert highest <= where + 1  # it never went on to the old target

    bench.play(story)


def test_halting_a_homing_ends_it(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.homing_speeds.fast.write(100_000))
        await did(axis.homing_acceleration.write(2_000_000))
        await did(axis.home(17, wait=False))
        bench.network.advance(100_000)
        assert await did(axis.velocity()) < 0
        await did(axis.halt())
        assert await did(axis.velocity()) == 0
        assert await did(axis.controlword.read()) == 0x0F
        await did(axis.resume())  # there is nothing to resume
        bench.network.advance(100_000)
        assert await did(axis.velocity()) == 0
        await did(axis.run(20_000, timeout=1))

    bench.play(story)


def test_a_halt_does_not_hold_back_homing_or_a_stream(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.run(20_000))
        await did(axis.halt())
        await did(axis.home(35))
        assert await did(axis.controlword.read()) == 0x0F
        await did(axis.set_mode("pp"))
        await did(axis.halt())
        await did(drive.stream([{0: step} for step in range(5)], period=0.01, axes=[0]))
        assert await did(axis.position()) == 4

    bench.play(story)


def test_a_halt_that_takes_too_long(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.run(100_000))
        await did(axis.profile_acceleration.write(1000))
        with pytest.raises(StateTimeoutError) as caught:
            await did(axis.halt(timeout=0.05))
        error = caught.value
        assert (error.wanted, error.timeout) == ("standstill", 0.05)
        assert "axis 0 is in operation_enabled, without standstill after 0.05 s: bit 14" in str(error)
        assert "profile_acceleration of axis 0 (6083h)" in error.blocked_by
        assert "motor_activity" in error.seen
        await did(axis.quick_stop())

    bench.play(story)


def test_home_here_needs_no_power(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[5]
        await did(axis.home(35))
        assert await did(axis.position()) == 0

    bench.play(story)


def test_home_on_a_switch(bench: Bench) -> None:
    bench.set(1, "left_at", -3000)

    async def story(drive: Any) -> None:
        axis = drive.axes[1]
        await tune(axis)
        await did(axis.switch_parameters.write(0))
        await did(axis.homing_speeds.fast.write(100_000))
        await did(axis.homing_speeds.slow.write(5000))
        await did(axis.homing_acceleration.write(2_000_000))
        await did(axis.enable())
        await did(axis.home(17, timeout=5))
        assert await did(axis.position()) == 0
        assert -3100 < bench.device.shaft(1) < -2900

    bench.play(story)


def test_homing_that_finds_nothing(bench: Bench) -> None:
    bench.set(0, "right", 1)

    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        for entry, value in ((axis.homing_speeds.fast, 100_000), (axis.homing_speeds.slow, 5000)):
            await did(entry.write(value))
        await did(axis.homing_acceleration.write(2_000_000))
        await did(axis.enable())
        with pytest.raises(MotionError, match="axis 0 found no home position"):
            await did(axis.home(17, timeout=5))

    bench.set(0, "left", 1)
    bench.play(story)


# ---- what goes wrong -------------------------------------------------------------------------------------------------


def test_a_move_needs_power(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        with pytest.raises(StateError) as caught:
            await did(drive.axes[2].move_to(5))
        error = caught.value
        assert (error.axis, error.state, error.wanted) == (2, "switch_on_disabled", "operation_enabled")
        assert error.blocked_by.startswith(
            "controlword of axis 2 (7040h) is 0000h: it does not say shutdown, bits 1, 2 = 1"
        )
        assert error.next_step == "shutdown to ready_to_switch_on by enable()"
        assert not isinstance(error, TimeoutError)

    bench.play(story)


def test_a_fault_says_why_and_what_to_do(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive, 4)
        await did(axis.move_to(100_000, wait=False))
        bench.fault(4, "overtemperature")
        with pytest.raises(EmergencyError) as caught:
            await did(axis.wait())
        error = caught.value
        assert error.axis == 4
        assert error.emergency is not None
        assert error.emergency.condition == "overtemperature"
        assert error.cause in str(error)
        assert error.remedy in str(error)
        assert "statusword" in error.seen
        with pytest.raises(StateError) as refused:
            await did(axis.enable())
        assert refused.value.state == "fault"
        assert error.title in refused.value.blocked_by
        assert refused.value.next_step.endswith("reset_fault()")

    bench.play(story)


def test_a_fault_without_an_emergency_is_not_the_last_one(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        bench.fault(0, "overtemperature")
        bench.network.advance(2000)
        bench.fault(0, "overtemperature", False)
        bench.network.advance(2000)
        await did(axis.reset_fault())
        await did(axis.enable())
        await did(axis.move_to(1_000_000, wait=False))
        bench.network.send_message(0x000, bytes([2, 1]))
        bench.network.advance(200_000)
        bench.network.send_message(0x000, bytes([1, 1]))
        with pytest.raises(MotionError, match="a fault that came without an emergency, such as NMT STOPPED") as caught:
            await did(axis.wait())
        assert not isinstance(caught.value, EmergencyError)
        with pytest.raises(StateError, match="came without an emergency"):
            await did(axis.move_to(0))

    bench.play(story)


def test_a_fault_from_before_a_reset_is_forgotten(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        bench.fault(0, "overtemperature")
        bench.network.advance(2000)
        bench.fault(0, "overtemperature", False)
        await did(drive.reset())
        await did(axis.enable())
        bench.network.send_message(0x000, bytes([2, 1]))
        bench.network.advance(2000)
        bench.network.send_message(0x000, bytes([1, 1]))
        with pytest.raises(StateError, match="came without an emergency"):
            await did(axis.enable())

    bench.play(story)


def test_a_time_out_says_what_was_last_seen(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        with pytest.raises(MotionTimeoutError) as caught:
            await did(axis.move_to(1_000_000, timeout=0.1))
        assert isinstance(caught.value, TimeoutError)
        assert "axis 0 did not end its movement within 0.1 s" in str(caught.value)
        assert "motor_activity" in caught.value.seen
        assert "mode profile_position; target_position 1000000; position_actual_value " in caught.value.seen

    bench.play(story)


def test_a_velocity_of_zero_is_found(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.profile_velocity.write(0))
        with pytest.raises(MotionError, match=r"axis 0 does not move: profile_velocity of axis 0 \(6081h\) is 0"):
            await did(axis.move_to(1000))
        assert bench.seconds < 2

    bench.play(story)


def test_a_limit_switch_is_found(bench: Bench) -> None:
    bench.set(0, "right_at", 500)

    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.disable())
        await did(axis.switch_parameters.write(0))
        await did(axis.enable())
        with pytest.raises(MotionError, match="bit 11 of the statusword"):
            await did(axis.move_to(100_000))

    bench.play(story)


def test_a_target_behind_a_software_limit(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.software_position_limit.maximum.write(700))
        await did(axis.software_position_limit.minimum.write(-700))
        with pytest.raises(MotionError, match="axis 0 went as far as a limit lets it"):
            await did(axis.move_to(1000))
        assert await did(axis.position()) == 700

    bench.play(story)


def test_limits_are_checked_before_anything_is_sent(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        sent = len(bench.sent(0x601))
        with pytest.raises(OutOfRangeError, match=r"target_position of axis 0 \(607Ah\)"):
            await did(axis.move_to(1 << 31))
        assert len(bench.sent(0x601)) == sent + 1  # the statusword was asked for

    bench.play(story)
