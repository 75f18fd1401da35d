"""Values by name, told once for both faces."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from tests.unit.runtime_py.client.faces import Bench, did, ready

from odsmith_runtime import OutOfRangeError, ReadOnlyError, WrongTypeError
from odsmith_runtime.client import NoAnswerError, SdoAborted


def test_raw_values_have_their_types(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[1]
        assert await did(drive.device_name.raw) == "TMCM-6212"
        assert (await did(axis.modes_of_operation.raw)).name == "NO_MODE"
        assert (await did(axis.statusword.raw)) & type(axis.statusword.entry.bits.REMOTE).REMOTE
        await did(axis.target_position.write(-5))
        assert await did(axis.target_position.raw) == -5
        await did(axis.homing_speeds.fast.write(7))
        assert bench.device.read(0x6899, 1) == bytes([7, 0, 0, 0])

    bench.play(story)


def test_physical_values_are_exact(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await did(axis.ramp_wait_time.write_phys(Fraction(1, 1000)))
        assert await did(axis.ramp_wait_time.raw) == 31
        assert await did(axis.ramp_wait_time.phys) == Fraction(31, 31250)
        await did(axis.velocity_dimension_index.write(0))
        await did(axis.profile_velocity.write(16384))
        assert await did(axis.profile_velocity.phys) == 15625
        await did(axis.velocity_dimension_index.write(181))
        assert await did(axis.profile_velocity.phys) == 16384

    bench.play(story)


def test_words(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        await did(axis.microstep_resolution.write_desc("microsteps_16"))
        assert await did(axis.microstep_resolution.raw) == 4
        assert await did(axis.microstep_resolution.desc) == "microsteps_16"
        assert await did(axis.statusword.desc) == "voltage_enabled, switch_on_disabled, remote"
        await did(axis.profile_velocity.write(12))
        assert await did(axis.profile_velocity.desc) == "12 pps"
        with pytest.raises(ValueError, match="no value is called 'microsteps_15'; names: fullstep, microsteps_2"):
            await did(axis.microstep_resolution.write_desc("microsteps_15"))

    bench.play(story)


def test_bits(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[0]
        assert await did(axis.statusword.read_bits("remote")) == 1
        assert await did(axis.statusword.read_bits(6)) == 1
        await did(axis.controlword.write_bits("halt", 1))
        assert await did(axis.controlword.raw) == 0x100
        mode_specific = axis.controlword.entry.bits.MODE_SPECIFIC
        await did(axis.controlword.write_bits(mode_specific, 5))
        assert await did(axis.controlword.raw) == 0x150
        assert await did(axis.controlword.read_bits(mode_specific)) == 5
        with pytest.raises(ValueError, match="8 does not fit into"):
            await did(axis.controlword.write_bits(mode_specific, 8))
        with pytest.raises(ValueError, match="no bits are called 'haalt'; names: switch_on, "):
            await did(axis.controlword.read_bits("haalt"))

    bench.play(story)


def test_limits_are_checked_before_sending(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[2]
        before = len(bench.network.log)
        with pytest.raises(OutOfRangeError, match=r"maximum_current of axis 2 \(2403h\): 256 is not in 0..255"):
            await did(axis.maximum_current.write(256))
        with pytest.raises(ReadOnlyError, match="statusword of axis 2"):
            await did(axis.statusword.write(0))
        with pytest.raises(WrongTypeError, match="target_position of axis 2"):
            await did(axis.target_position.write("7"))
        assert len(bench.network.log) == before

    bench.play(story)


def test_a_refusal_of_the_device_is_explained(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = await ready(drive, 2)
        with pytest.raises(SdoAborted) as caught:
            await did(axis.velocity_dimension_index.write(0))
        error = caught.value
        assert (error.axis, error.value, error.code) == (2, 0, 0x08000022)
        assert error.limit == "0 (internal), 181 (pps)"
        assert str(error) == (
            "writing 0 to velocity_dimension_index of axis 2 (248Ch): the device aborted with 08000022h, not possible "
            "in the present device state; it takes 0 (internal), 181 (pps); it is writable in switch_on_disabled only"
        )

    bench.play(story)


def test_a_silent_node(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        await did(drive.device_name.raw)
        bench.network.loses = lambda frame: frame.id == 0x581
        with pytest.raises(
            NoAnswerError,
            match=r"reading statusword of axis 0.*: node 1 did not answer within 1 s; it was last heard 1.0 s ago",
        ):
            await did(drive.axes[0].statusword.raw)

    bench.play(story)
    assert bench.sent(0x601)[-1] == bytes.fromhex("80 41 60 00 00 00 04 05")  # the transfer was ended on both sides


def test_the_node_is_another_device(bench: Bench) -> None:
    bench.network.loses = lambda frame: frame.id == 0x581 and frame.data[1:4] == bytes.fromhex("18 10 02")

    async def story(drive: Any) -> None:
        with pytest.raises(NoAnswerError):
            await did(drive.check_identity())
        bench.network.loses = lambda frame: False
        await did(drive.check_identity())

    bench.play(story)
