"""States of an axis, told once for both faces."""

from __future__ import annotations

from typing import Any

import pytest
from tests.unit.runtime_py.client.faces import Bench, did, ready, tune

from odsmith_runtime import OutOfRangeError
from odsmith_runtime.client import StateError, StateTimeoutError
from odsmith_runtime.device import Input


def test_up_and_down(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[3]
        assert await did(axis.state()) == "switch_on_disabled"
        await did(axis.enable())
        assert await did(axis.state()) == "operation_enabled"
        assert await did(drive.axes[2].state()) == "switch_on_disabled"
        await did(axis.disable())
        assert await did(axis.state()) == "switch_on_disabled"

    bench.play(story)


def test_enabling_that_takes_longer_names_the_delay(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await did(axis.enable_drive_delay_time.write(200))
        with pytest.raises(StateTimeoutError) as caught:
            await did(axis.enable(timeout=0.05))
        error = caught.value
        assert "axis 0 is in switched_on, not in operation_enabled after 0.05 s" in str(error)
        assert "enable_drive_delay_time of axis 0 (200Ah) is 200 ms" in error.blocked_by
        assert "enable()" not in error.next_step
        assert "statusword 0233h" in error.seen
        with pytest.raises(StateError) as refused:
            await did(axis.move_to(1))
        assert refused.value.next_step == "none but to wait: operation_enabled comes of itself"
        bench.network.advance(200_000)
        await did(axis.require_enabled())

    bench.play(story)


def test_a_mode_that_does_not_come(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        with pytest.raises(StateTimeoutError) as caught:
            await did(axis.set_mode("pv", timeout=0))  # it comes with the next tick
        assert caught.value.blocked_by == (
            "modes_of_operation_display of axis 0 (6061h) is 0, while modes_of_operation of axis 0 (6060h) is 3"
        )
        assert "without the mode of operation after 0 s" in str(caught.value)

    bench.play(story)


def test_disabling_slows_down_first(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.profile_acceleration.write(100_000))
        await did(axis.run(50_000))
        start = await did(axis.position())
        await did(axis.disable())
        assert await did(axis.position()) - start > 50_000**2 // (2 * 100_000) * 0.9

    bench.play(story)


def test_a_coarser_resolution_scales(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await did(axis.microstep_resolution.write(2))
        await did(axis.fullstep_resolution.write(400))
        assert await did(axis.scale()) == (4, 400)
        axis = await ready(drive)
        await did(axis.move_to(1, unit="revolutions"))
        assert await did(axis.position()) == 1600

    bench.play(story)


def test_quick_stop_switches_off(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        await did(axis.run(100_000))
        await did(axis.quick_stop())
        assert await did(axis.velocity()) == 0
        await did(axis.enable())

    bench.play(story)


def test_a_missing_enable_input_is_named(bench: Bench) -> None:
    bench.device.input(bench.network.now_us, Input.ENABLE, 0, 0)
    bench.network.advance(2000)

    async def story(drive: Any) -> None:
        with pytest.raises(StateError) as caught:
            await did(drive.axes[0].move_to(5))
        assert caught.value.blocked_by.startswith("bit 3 of the statusword (fault): Shutdown switch active")

    bench.play(story)


def test_a_fault_that_still_holds_is_not_reset(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive)
        bench.fault(0, "overtemperature")
        bench.network.advance(2000)
        with pytest.raises(StateError, match="axis 0 is in fault, not in switch_on_disabled"):
            await did(axis.reset_fault(timeout=0.1))
        bench.fault(0, "overtemperature", False)
        bench.network.advance(2000)
        await did(axis.reset_fault())
        assert await did(axis.state()) == "switch_on_disabled"
        await did(axis.enable())
        await did(axis.move_to(100))

    bench.play(story)


def test_modes_by_name(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        for mode, code in (("pp", 1), ("profile_velocity", 3), (6, 6), ("CSP", 8)):
            await did(axis.set_mode(mode))
            assert await did(axis.mode()) == code
        with pytest.raises(ValueError, match="'torque' is no mode of operation: no_mode"):
            await did(axis.set_mode("torque"))
        with pytest.raises(OutOfRangeError, match="modes_of_operation of axis 0"):
            await did(axis.set_mode(4))

    bench.play(story)


def test_a_controlword_by_hand_is_kept(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await tune(axis)
        await did(axis.set_mode("pv"))
        for word in (6, 7, 15):
            await did(axis.controlword.write(word))
        await did(axis.target_velocity.write(1000))
        await did(axis.halt())
        assert await did(axis.controlword.raw) == 0x10F
        assert await did(axis.state()) == "operation_enabled"

    bench.play(story)
