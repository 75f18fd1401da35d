"""A program on the client that says which types it expects; type checkers must have nothing to say about it.

It is read and never run. `make lint` gives it to mypy, `test_type_checkers.py` to mypy and pyright.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import assert_type

import canopen
from tmcm6212 import (
    TMCM6212,
    AsyncTMCM6212,
    AsyncTMCM6212Axis,
    Controlword,
    HomingMethod,
    Statusword,
    SwitchParameters,
    TMCM6212Axis,
)

from odsmith_runtime.client import (
    AsyncValue,
    BusLoad,
    EmergencyError,
    MotionTimeoutError,
    Rpdo,
    Scale,
    SdoAborted,
    Seen,
    StateError,
    Tpdo,
    Value,
)


def connects(network: canopen.Network) -> None:
    with TMCM6212.connect(interface="socketcan", channel="can0", node_id=3, answer_timeout=0.5) as drive:
        assert_type(drive, TMCM6212)
        assert_type(drive.axes, tuple[TMCM6212Axis, ...])
    assert_type(TMCM6212(network, 3).emergencies, tuple[EmergencyError, ...])


def names_objects(drive: TMCM6212) -> None:
    x = drive.axes[0]
    assert_type(drive.device_name.raw, str)
    assert_type(drive.objects.identity.vendor_id.raw, int)
    assert_type(x.homing_speeds.fast, Value[int])
    assert_type(x.homing_method.raw, HomingMethod | int)
    assert_type(x.statusword.raw, Statusword)
    assert_type(x.controlword.bits[Controlword.HALT], int)
    assert_type(x.profile_velocity.phys, Fraction)
    assert_type(x.profile_velocity.entry.high, int | None)
    x.switch_parameters.raw = SwitchParameters.LEFT_LIMIT_OFF | SwitchParameters.RIGHT_LIMIT_OFF
    x.profile_velocity.raw = 51_200
    x.profile_velocity.phys = Fraction(512, 10)
    x.homing_method.desc = "current_position"


def moves(x: TMCM6212Axis) -> None:
    x.enable(timeout=2)
    x.set_mode("pp")
    x.move_to(Fraction(1, 2), unit="revolutions", wait=False)
    x.move_by(1000, timeout=5)
    x.run(0.5, unit="rev/s")
    x.home(HomingMethod.NEGATIVE_LIMIT)
    assert_type(x.status(), Seen)
    assert_type(x.scale(), Scale)
    assert_type(x.position(), int)
    assert_type(x.velocity_in("steps/s"), Fraction)


def exchanges(drive: TMCM6212, rows: list[Mapping[int, int]]) -> None:
    plan = [Rpdo(drive.axes[0].controlword, on_sync=1), Tpdo(drive.axes[0].statusword, event_timer=0.1)]
    assert_type(drive.configure_pdos([*plan, Tpdo(drive.axes[1].statusword)], sync_period=0.01), BusLoad)
    assert_type(drive.stream(rows, period=0.01, keep_going=True), dict[int, EmergencyError])
    print(drive.load_parameters("x.yaml", write=False).differences)


def fails(x: TMCM6212Axis) -> str:
    try:
        x.move_to(0)
    except StateError as error:
        return f"{error.axis} {error.state} {error.wanted} {error.blocked_by} {error.next_step}"
    except EmergencyError as error:
        return f"{error.title} {error.cause} {error.remedy}"
    except MotionTimeoutError as error:
        return error.seen
    except SdoAborted as error:
        return f"{error.entry.label} {error.code:08X} {error.limit}"
    return ""


async def for_asyncio(network: canopen.Network) -> None:
    async with AsyncTMCM6212(network) as drive:
        x = drive.axes[0]
        assert_type(x, AsyncTMCM6212Axis)
        assert_type(x.homing_speeds.fast, AsyncValue[int])
        assert_type(await x.statusword.raw, Statusword)
        await x.controlword.write(Controlword.SWITCH_ON)
        await x.move_to(1.5, unit="revolutions")
        assert_type(await x.position_in("revolutions"), Fraction)
