"""What a drive does with all its axes, told once for both faces."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from tests.unit.runtime_py.client.faces import Bench, did, ready, tune

from odsmith_runtime.client import ClientError, EmergencyError, NoAnswerError, PlanError, Rpdo, SdoAborted, Tpdo
from odsmith_runtime.client.virtual import VirtualNetwork
from odsmith_runtime.device import MemoryFailure

AXES = range(6)


def plan(drive: Any, on_sync: int = 0) -> list[Rpdo | Tpdo]:
    """What moving all axes by PDO takes."""
    pdos: list[Rpdo | Tpdo] = []
    for axis in drive.axes:
        pdos.append(Rpdo(axis.controlword, axis.target_position, on_sync=on_sync))
        pdos.append(Tpdo(axis.statusword, axis.position_actual_value, on_sync=on_sync))
    return pdos


# ---- process data ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("on_sync", [0, 1])
def test_moving_by_pdo(bench: Bench, on_sync: int) -> None:
    async def story(drive: Any) -> None:
        for axis in drive.axes:
            await tune(axis)
        load = await did(drive.configure_pdos(plan(drive, on_sync), sync_period=0.01))
        assert str(load).count("axis") == 12
        assert drive.nmt_state == "OPERATIONAL"
        axis = drive.axes[3]
        before = len(bench.sent(0x601))
        await did(axis.enable())
        assert len(bench.sent(0x601)) == before
        await did(axis.move_to(5000))
        assert await did(axis.position()) == 5000
        await did(drive.use_pdos(False))
        before = len(bench.sent(0x601))
        await did(axis.move_to(0))
        assert len(bench.sent(0x601)) > before

    bench.play(story)


def test_a_wrong_plan_sends_nothing(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        before = len(bench.network.log)
        axis = drive.axes[0]
        too_long = [Rpdo(axis.target_position, axis.target_velocity, axis.velocity_offset)]
        with pytest.raises(PlanError, match="a PDO has 64"):
            await did(drive.configure_pdos(too_long))
        assert len(bench.network.log) == before

    bench.play(story)


# ---- six axes at once ------------------------------------------------------------------------------------------------


def test_six_axes_in_different_modes_one_in_fault(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        for number in AXES:
            await ready(drive, number)
        for number in (0, 1, 2):
            await did(drive.axes[number].move_to(10_000 * (number + 1), wait=False))
        await did(drive.axes[3].run(30_000, wait=False))
        await did(drive.axes[4].home(35, wait=False))
        await did(drive.axes[5].move_to(-400_000, wait=False))
        bench.fault(5, "overcurrent_a")
        with pytest.raises(EmergencyError) as caught:
            await did(drive.axes[5].wait())
        assert caught.value.axis == 5
        await did(drive.wait(0, 1, 2, 3, 4))
        assert [await did(drive.axes[number].position()) for number in (0, 1, 2)] == [10_000, 20_000, 30_000]
        assert await did(drive.axes[3].velocity()) == 30_000
        assert await did(drive.axes[5].state()) == "fault"
        assert [error.axis for error in drive.emergencies] == [5]

    bench.play(story)


def test_tasks_move_axes_side_by_side(package: ModuleType) -> None:
    bench = Bench(package, "asyncio")

    async def story(drive: Any) -> None:
        for number in AXES:
            await ready(drive, number)
        await asyncio.gather(*(drive.axes[number].move_to(1000 * number + 1) for number in AXES))
        assert [await drive.axes[number].position() for number in AXES] == [1000 * number + 1 for number in AXES]

    bench.play(story)


# ---- streams ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("by_pdo", [False, True])
def test_a_stream_of_positions(bench: Bench, by_pdo: bool) -> None:
    async def story(drive: Any) -> None:
        if by_pdo:
            await did(drive.configure_pdos(plan(drive, on_sync=1)))
        await did(drive.enable())
        rows = [{axis: (axis + 1) * 10 * step for axis in AXES} for step in range(1, 9)]
        started = bench.seconds
        failed = await did(drive.stream(rows, period=0.01))
        assert failed == {}
        assert [await did(axis.position()) for axis in drive.axes] == [80 * (axis + 1) for axis in AXES]
        assert 0.08 <= bench.seconds - started < 1

    bench.play(story)
    assert len(bench.sent(0x080)) >= 8


def test_a_stream_of_velocities(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[2]
        await did(axis.enable())
        rows = [{2: 1000 * step} for step in range(1, 5)]
        await did(drive.stream(rows, period=0.01, mode=9, axes=[2]))
        assert await did(axis.velocity()) == 4000
        await did(axis.stop())

    bench.play(story)


def test_an_axis_that_fails_in_a_stream(bench: Bench) -> None:
    def rows(failing: int) -> Iterator[dict[int, int]]:
        for step in range(20):
            if step == 5:
                bench.fault(failing, "overcurrent_a")
            yield {axis: step for axis in AXES if axis != 1 or failing == 1}

    async def story(drive: Any) -> None:
        await did(drive.enable())
        failed = await did(drive.stream(rows(1), period=0.01, keep_going=True))
        assert list(failed) == [1]
        bench.network.advance(20_000)
        assert await did(drive.axes[0].position()) == 19
        with pytest.raises(EmergencyError) as caught:
            await did(drive.stream(rows(3), period=0.01, axes=[0, 2, 3, 4, 5]))
        assert caught.value.axis == 3

    bench.play(story)


def test_a_cycle_that_cannot_be_said(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        with pytest.raises(
            ValueError, match=r"interpolation_time_period.value of axis 0 .* cannot say a cycle of 0.0005 s"
        ):
            await did(drive.stream([], period=0.0005))

    bench.play(story)


# ---- parameters ------------------------------------------------------------------------------------------------------


def test_parameters_go_to_a_file_and_back(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"

    async def story(drive: Any) -> None:
        axis = drive.axes[3]
        await did(axis.profile_velocity.write(777))
        await did(axis.homing_speeds.fast.write(88))
        await did(drive.save_parameters(path))
        assert str(await did(drive.load_parameters(path))) == "no differences"
        await did(axis.profile_velocity.write(1))
        await did(axis.homing_speeds.fast.write(2))
        await did(axis.tpdo_communication[2].transmission_type.write(7))
        compared = await did(drive.load_parameters(path, write=False))
        assert [difference.written for difference in compared.differences] == [False] * 3
        report = await did(drive.load_parameters(path))
        assert "profile_velocity of axis 3 (7881h): 1 in the device, 777 in the file" in str(report)
        assert len(report.differences) == 3
        assert await did(axis.profile_velocity.raw) == 777
        assert await did(axis.homing_speeds.fast.raw) == 88
        assert await did(axis.tpdo_communication[2].transmission_type.raw) != 7
        assert (await did(drive.load_parameters(path))).differences == ()

    bench.play(story)


def test_a_file_of_something_else(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"

    async def story(drive: Any) -> None:
        path.write_text("device: TMCM-3230\n")
        with pytest.raises(ClientError, match="holds no parameters of a TMCM-6212"):
            await did(drive.load_parameters(path))
        path.write_text("device: TMCM-6212\naxis_0: {colour: 5}\nwhole_device: {node_id: 9}\n")
        report = await did(drive.load_parameters(path))
        assert report.unknown == ("axis_0: colour",)
        assert str(report.differences[0]).endswith("(left as it is)")
        assert await did(drive.objects.node_id.raw) == 1
        assert "axis_0: profile_velocity" in report.missing

    bench.play(story)


def test_store_and_restore(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        await did(drive.axes[0].profile_velocity.write(5))
        await did(drive.store("axis_0"))
        await did(drive.axes[0].profile_velocity.write(6))
        await did(drive.reset())
        assert await did(drive.axes[0].profile_velocity.raw) == 5
        await did(drive.restore())
        await did(drive.reset())
        assert await did(drive.axes[0].profile_velocity.raw) == 0
        with pytest.raises(ValueError, match="no group is called 'axis_9'; groups: all, bus, profile, axis_0"):
            await did(drive.store("axis_9"))

    bench.play(story)


def test_a_new_node_id(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        await did(drive.change_node_id(42))
        assert drive.id == 42
        assert await did(drive.objects.node_id_load.raw) == 42
        assert bench.device.node_id == 42
        await did(drive.axes[0].enable())

    bench.play(story)


def test_a_new_bit_rate(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        with pytest.raises(ClientError, match="say how to `reconnect` it"):
            await did(drive.change_bit_rate(500))
        with pytest.raises(ValueError, match="300 kbit/s is none of the bit rates 20, 50"):
            await did(drive.change_bit_rate(300, reconnect=lambda: None))
        reconnected: list[int] = []
        bench.network.loses = lambda frame: frame.id == 0x581 and bool(reconnected) and len(bench.sent(0x601)) % 2 == 0
        await did(drive.change_bit_rate(500, reconnect=lambda: reconnected.append(1)))
        assert reconnected == [1]
        assert bench.device.bit_rate == 500

    bench.play(story)


def test_a_node_that_does_not_come_back(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        bench.network.loses = lambda frame: frame.id == 0x701
        silent = r"node 1 sent no boot-up message within 0.2 s; nothing was ever heard of it"
        with pytest.raises(NoAnswerError, match=silent):
            await did(drive.reset(timeout=0.2))
        await did(drive.device_type.read())
        with pytest.raises(NoAnswerError, match=r"within 0.2 s; it was last heard 0.2 s ago"):
            await did(drive.reset(timeout=0.2))
        silent = r"node 9 sent no boot-up message within 0.2 s; nothing was ever heard of it"
        bench.network.loses = lambda frame: frame.id == 0x709
        with pytest.raises(NoAnswerError, match=silent):
            await did(drive.change_node_id(9, timeout=0.2))

    bench.play(story)


def test_a_memory_that_fails_is_told(blocking: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(address: int, octet: int) -> None:
        raise MemoryFailure

    monkeypatch.setattr(blocking.device, "nvm_write", fail)
    with pytest.raises(SdoAborted, match=r"store_parameters.all .*06060000h"):
        blocking.drive.store()


# ---- the connection --------------------------------------------------------------------------------------------------


def test_closing_stops_listening(bench: Bench) -> None:
    heard = bench.drive._core if bench.face == "asyncio" else bench.drive._twin._core
    bench.drive.close()
    seen = heard.link.frames
    bench.network.send_message(0x601, bytes.fromhex("40 00 10 00 00 00 00 00"))
    assert heard.link.frames == seen


def test_a_node_that_is_not_there(package: ModuleType) -> None:
    channel: dict[str, Any] = {"interface": "virtual", "channel": "nobody"}
    drive = package.TMCM6212.connect(node_id=3, answer_timeout=0.0, **channel)
    with pytest.raises(NoAnswerError, match="node 3 did not answer"):
        drive.__enter__()
    assert drive.network.bus is None


@pytest.mark.parametrize("node_id", [0, 128])
def test_node_ids(package: ModuleType, node_id: int) -> None:
    with pytest.raises(ValueError, match="a node-ID is 1 to 127"):
        package.TMCM6212(VirtualNetwork(package), node_id)


def test_what_is_written_by_sdo_stays_when_an_rpdo_follows(bench: Bench) -> None:
    async def story(drive: Any) -> None:
        axis = drive.axes[2]
        await did(drive.configure_pdos(plan(drive)))
        await did(axis.target_position.write(55))
        await did(axis.enable())
        assert await did(axis.target_position.raw) == 55

    bench.play(story)
