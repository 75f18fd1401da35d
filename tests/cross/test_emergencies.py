"""Every row of the emergency table arises from its cause: on both runtimes, with its bytes, its reaction and its end.

The rows are those of the model, which is the YAML. What causes each of them is the table below: something that happens
to the hardware, to the bus or to the CAN controller while an axis moves. A row without a cause fails, and so does a
cause without a row.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import pytest
from tests.cross.events import download
from tests.cross.expected import encode
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.pds import Machine
from tests.cross.testee import Bench

from odsmith.model import Device, Emergency, ExpandedEntry

NODE_ID = 5
WHOLE_DEVICE = 255

SPEED = 3000  # pps, reached in a tick
BRAKING = 1_000_000  # pps/s: in a third of it in each tick
LONG_ENOUGH = 10  # ticks, for a reaction to end

WARNING, LIMIT = 0x0080, 0x0800  # bits of the statusword
UP, ENABLE, FAULT_RESET = 0x06, 0x0F, 0x80

Step = str | tuple[str, int]
"""A line for the testee, `{axis}` in it; or the role of an entry and the value that is written there."""


@dataclass(frozen=True)
class Cause:
    """`set_up` comes before the axis is enabled; `steps` cause the row, and `end` ends its condition.

    `raises`: all rows that come, if there are more than the one. `on`: the axes that raise it, if not the one that
    moves. `backwards`: that it moves that way.
    """

    steps: tuple[Step, ...]
    end: tuple[Step, ...] = ()
    set_up: tuple[Step, ...] = ()
    raises: tuple[str, ...] = ()
    on: str = "axis"
    backwards: bool = False


def switched(name: str) -> Cause:
    """By the driver: nothing on the bench makes it do so."""
    return Cause((f"FAULT axis{{axis}} {name} on", "T 1000"), (f"FAULT axis{{axis}} {name} off", "T 1000"))


ENCODER: tuple[Step, ...] = (
    "IN axis{axis}.revolution 20",
    "IN axis{axis}.increments 20",
    ("microstep_resolution", 0),
    ("fullstep_resolution", 20),
    ("encoder_increments", 20),
)

CAUSES: dict[str, Cause] = {
    "fault_reset": Cause(
        (
            *switched("overcurrent_a").steps,
            f"T {1000 * LONG_ENOUGH}",
            *switched("overcurrent_a").end,
            ("controlword", FAULT_RESET),
        ),
        raises=("overcurrent_a", "fault_reset"),
    ),
    "open_load_a": switched("open_load_a"),
    "open_load_b": switched("open_load_b"),
    "overcurrent_high_side": switched("overcurrent_high_side"),
    "overcurrent_b": switched("overcurrent_b"),
    "overcurrent_a": switched("overcurrent_a"),
    "stall": Cause(
        ("IN axis{axis}.load 1023", "T 2000"),  # one tick measures, the next one finds
        ("IN axis{axis}.load 0", "T 1000"),
        set_up=(("stop_on_stall", 2500),),
    ),
    "temperature_warning": Cause(
        ("IN axis{axis}.temperature 120", "T 1000"), ("IN axis{axis}.temperature 110", "T 1000")
    ),
    "overtemperature": Cause(
        ("IN axis{axis}.temperature 150", "T 1000"),
        ("IN axis{axis}.temperature 25", "T 1000"),
        raises=("temperature_warning", "overtemperature"),
    ),
    "shutdown_switch": Cause(("IN enable 0", "T 1000"), ("IN enable 1", "T 1000"), on="device"),
    # RPDO 2 of axis 0: controlword, and a mode that there is not
    "parameter_error": Cause(("RX 305 00 00 02",), on="device"),
    "communication_error": Cause(("CAN error",), on="device"),
    "can_overrun": Cause(("CAN overrun",), on="device"),
    "can_tx_full": Cause(("CAN txfull",), on="device"),
    "can_rx_full": Cause(("CAN rxfull",), on="device"),
    "can_passive": Cause(("CAN passive",), ("CAN ok",), on="device"),
    "heartbeat_lost": Cause(
        ("RX 70A 05", "T 4000"),
        (("consumer_heartbeat_time", 0),),
        set_up=(("consumer_heartbeat_time", 0x000A_0004),),
        on="device",
    ),
    "bus_off_recovered": Cause(
        ("CAN busoff", "CAN ok"),
        raises=("can_passive", "bus_off_recovered", "fault_reset"),
        on="device",
    ),
    "pdo_too_short": Cause(("RX 205 00",), on="device"),
    "pdo_too_long": Cause(("RX 205 00 00 00",), on="device"),
    "following_error": Cause(
        ("IN axis{axis}.blocked 1", "T 3000"),  # not behind, 3 behind, 6 behind
        set_up=(*ENCODER, ("following_error_window", 5)),
    ),
    "undervoltage": Cause(("IN supply 6999", "T 1000"), ("IN supply 7500", "T 1000"), on="each axis"),
    "software_limit_positive": Cause(
        ("T 3000",),  # from 3 to 12
        (("software_position_limit_maximum", 1000), "T 1000"),
        set_up=(("software_position_limit_maximum", 10),),
    ),
    "software_limit_negative": Cause(
        ("T 3000",),
        (("software_position_limit_minimum", -1000), "T 1000"),
        set_up=(("software_position_limit_minimum", -10),),
        backwards=True,
    ),
    "limit_switch_positive": Cause(("IN axis{axis}.right 1", "T 1000"), ("IN axis{axis}.right 0", "T 1000")),
    "limit_switch_negative": Cause(
        ("IN axis{axis}.left 1", "T 1000"), ("IN axis{axis}.left 0", "T 1000"), backwards=True
    ),
}

WITHOUT_ENCODER = {"following_error": switched("following_error")}
"""What only the hardware itself can find there."""


class Answering(Protocol):
    """What all testees are."""

    def answer(self, line: str) -> list[str]: ...


class Bus:
    """A testee and its emergencies. `axis` is the one that moves."""

    def __init__(self, testee: Answering, device: Device, axis: int) -> None:
        self.testee = testee
        self.device = device
        self.axis = axis
        self.machine = Machine(device)
        self.entries: dict[tuple[str, int | None], ExpandedEntry] = {}
        for obj in device.expanded:
            for item in obj.entries:
                self.entries.setdefault((item.entry.role, obj.axis), item)
        self.emergencies: list[str] = []
        self.outputs: list[str] = []

    def do(self, steps: Sequence[Step]) -> None:
        for step in steps:
            if isinstance(step, str):
                self.say(step.format(axis=self.axis))
            else:
                self.write(*step)

    def say(self, line: str) -> list[str]:
        answer = self.testee.answer(line)
        assert not answer[-1].startswith("NACK"), line
        self.emergencies += [each for each in answer if each.startswith(f"TX {0x80 + NODE_ID:03X} ")]
        self.outputs += [each for each in answer if each.startswith("OUT ")]
        return answer

    def taken(self) -> list[str]:
        """The emergencies since the last time."""
        found, self.emergencies = self.emergencies, []
        return found

    def entry(self, role: str, axis: int | None = None) -> ExpandedEntry:
        """That of the axis, unless it is one of the whole device."""
        found = self.entries.get((role, None))
        return found or self.entries[role, self.axis if axis is None else axis]

    def write(self, role: str, value: int) -> None:
        item = self.entry(role)
        (line,) = download(NODE_ID, item.index, item.entry.sub, encode(item.entry, value))
        assert self.say(line)[0].startswith(f"TX {0x580 + NODE_ID:03X} 60"), role

    def read(self, role: str, axis: int | None = None) -> int:
        item = self.entry(role, axis)
        answer = self.say(f"DUMP {item.index:04X}-{item.index:04X}")
        (octets,) = (line[11:] for line in answer if line.startswith(f"OD {item.index:04X}:{item.entry.sub:02X}"))
        return int.from_bytes(bytes.fromhex(octets), "little", signed=item.entry.type.signed)

    @property
    def state(self) -> str:
        return self.machine.decode(self.read("statusword"))

    def start(self, cause: Cause) -> None:
        """The axis moves, in OPERATIONAL. What it is told there in the meantime is not told any more."""
        self.say("POWER on")
        self.do(cause.set_up)
        for role, value in (
            ("error_behaviour", 1),  # a lost heartbeat leaves the NMT state as it is
            ("standby_current", 128),
            ("profile_acceleration", 1000 * SPEED),
            ("quick_stop_deceleration", BRAKING),
            ("modes_of_operation", 3),
            ("controlword", UP),
            ("controlword", ENABLE),
        ):
            self.write(role, value)
        self.say("T 1000")
        self.say(f"RX 000 01 {NODE_ID:02X}")
        self.write("target_velocity", self.speed(cause))
        self.say("T 1000")
        assert self.is_moving
        assert not self.taken()

    @staticmethod
    def speed(cause: Cause) -> int:
        return -SPEED if cause.backwards else SPEED

    @property
    def is_moving(self) -> bool:
        return bool(self.read("statusword") & 0x4000)


def frame(device: Device, row: Emergency, axis: int) -> str:
    """What CiA 301 (7.2.7.1) and the manual (section 11) make of a row where nothing else holds."""
    octets = [*row.code.to_bytes(2, "little"), register([row], device)]
    octets += [axis if octet == "axis" else octet for octet in row.bytes]
    return f"TX {0x80 + NODE_ID:03X} {bytes(octets).hex(' ').upper()}"


def register(rows: Sequence[Emergency], device: Device) -> int:
    """1001h while these hold."""
    return sum({1 << device.register_bits[name].bit for row in rows for name in row.register})


def check(testee: Answering, device: Device, name: str, axis: int) -> None:
    has_encoder = any(entry.role == "encoder_increments" for obj in device.objects for entry in obj.entries)
    cause = CAUSES[name] if has_encoder else WITHOUT_ENCODER.get(name, CAUSES[name])
    rows = {row.name: row for row in device.emergencies}
    raised = [rows[each] for each in cause.raises or (name,)]
    axes = {"axis": [axis], "device": [WHOLE_DEVICE], "each axis": range(device.axes)}[cause.on]
    reset, is_over = (frame(device, rows["fault_reset"], number) for number in (axis, WHOLE_DEVICE))
    bus = Bus(testee, device, axis)

    bus.start(cause)
    bus.do(cause.steps)
    assert bus.taken() == [frame(device, row, number) for number in axes for row in raised]
    check_displays(bus, [row for row in raised if not rows[name].momentary])
    check_reaction(bus, rows[name], cause)

    # The condition of an axis ends without a frame.
    bus.do(cause.end)
    assert bus.taken() == ([is_over] if cause.on == "device" and cause.end else [])
    check_displays(bus, [])
    if rows[name].reaction in ("fault_ramp", "fault_off"):
        bus.write("controlword", FAULT_RESET)
        assert bus.taken() == [reset]
        assert bus.state == "switch_on_disabled"


def check_displays(bus: Bus, holding: Sequence[Emergency]) -> None:
    """What shows while the conditions of rows hold: 1001h, 2102h, bit 7 of the statusword."""
    assert bus.read("error_register") == register(holding, bus.device)
    assert bus.read("driver_error_flags") == sum(row.driver_flag for row in holding)
    assert bool(bus.read("statusword") & WARNING) == any(row.reaction == "warning" for row in holding)


def check_reaction(bus: Bus, row: Emergency, cause: Cause) -> None:
    """What the axis does about it in that tick, and what comes of it."""
    power_off = f"OUT axis{bus.axis}.power 0"
    match row.reaction:
        case "none" if row.condition == "fault_reset":
            assert bus.state == "switch_on_disabled"
        case "none" | "warning":
            assert (bus.state, bus.is_moving) == ("operation_enabled", True)
        case "stop_direction":
            bus.say("T 1000")  # a software limit is found at the end of a tick
            assert bus.read("statusword") & LIMIT
            assert (bus.state, bus.is_moving) == ("operation_enabled", False)
            bus.write("target_velocity", -bus.speed(cause))
            bus.say("T 1000")
            assert bus.is_moving
        case "fault_ramp":
            assert (bus.state, bus.is_moving) == ("fault_reaction_active", True)
            assert power_off not in bus.outputs
            bus.say(f"T {1000 * LONG_ENOUGH}")
            assert bus.state == "fault"
            assert power_off in bus.outputs
        case "fault_off":
            assert (bus.state, bus.is_moving) == ("fault", False)
            assert power_off in bus.outputs
        case _:
            raise NotImplementedError(row.reaction)


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_every_row_has_a_cause(name: str, request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    assert {row.name for row in device.emergencies} == CAUSES.keys()
    assert len(device.emergencies) == len(CAUSES)


PLACES = (("tmcm3230", 1), ("tmcm6212", 4))

each_place = pytest.mark.parametrize(("name", "axis"), PLACES)
each_row = pytest.mark.parametrize("row", CAUSES)


@each_place
@each_row
def test_in_python(
    row: str, name: str, axis: int, start_python: Callable[..., Bench], request: pytest.FixtureRequest
) -> None:
    device: Device = request.getfixturevalue(name)
    check(start_python(device, node_id=NODE_ID), device, row, axis)


@pytest.mark.slow
@each_place
@each_row
def test_in_c(row: str, name: str, axis: int, start_c: StartC, request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    check(start_c(device, node_id=NODE_ID), device, row, axis)
