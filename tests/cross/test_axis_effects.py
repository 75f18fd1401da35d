"""Every entry of an axis that can be written does what its effect says: each one is written on each axis, and it shows.

Both runtimes are tried in this process; `tests/unit/runtime_c` has the same cases for programs of every compiler, and
sees to it that no effect is without one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest
from tests.cross.driver import Driver, InProcess
from tests.cross.expected import encode, entries
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.testee import Bench

from odsmith.model import Device, ExpandedEntry

pytestmark = pytest.mark.slow

MS = 1000

PP, PV, HM, CSP = 1, 3, 6, 8
ENABLE, SET_POINT, RELATIVE, START, HALT = 0x0F, 0x1F, 0x5F, 0x1F, 0x100

REACHED, LIMIT, ACKNOWLEDGED = 1 << 10, 1 << 11, 1 << 12
DISABLED, QUICK_STOP = (0x004F, 0x0040), (0x006F, 0x0007)
"""States: the bits of the statusword that tell them, and how they are then."""

RAMP = {
    "profile_start_velocity": 1000,
    "profile_a1": 400_000,
    "profile_v1": 4000,
    "profile_acceleration": 800_000,
    "profile_velocity": 12_000,
    "profile_deceleration": 800_000,
    "profile_d1": 400_000,
    "end_velocity": 1000,
    "quick_stop_deceleration": 1_000_000,
}


TPDO, COURSE = 0x1800, 0x190
"""The first TPDO of axis 0, and the CAN-ID under which the position is told every millisecond."""


@dataclass
class Drive:
    """An axis on the bus. Its switches are not looked at, and it keeps the current that it runs with."""

    node: Driver
    device: Device
    axis: int

    def __post_init__(self) -> None:
        self._items: dict[str, ExpandedEntry] = {}
        for item in entries(self.device):
            if item.axis == self.axis:
                self._items.setdefault(item.entry.role, item)
        self._tell_course()
        self.node.do("TELL driver off")
        self.put("switch_parameters", 3)
        self.put("standby_current", 128)
        for name, value in RAMP.items():
            self.put(name, value)

    def item(self, name: str) -> ExpandedEntry:
        """The entry of the value that the runtimes know under this name."""
        return self._items[name]

    def of_effect(self, effect: str) -> list[ExpandedEntry]:
        found = [item for item in entries(self.device) if item.axis == self.axis and item.entry.effect == effect]
        assert found
        return found

    def write(self, item: ExpandedEntry, value: int) -> None:
        assert self.node.sdo_write(item.index, item.entry.sub, encode(item.entry, value)) == 0, (hex(item.index), value)

    def put(self, name: str, value: int) -> None:
        self.write(self.item(name), value)

    def get(self, name: str) -> int:
        item = self.item(name)
        octets = self.node.sdo_read(item.index, item.entry.sub)
        assert isinstance(octets, bytes)
        return int.from_bytes(octets, "little", signed=item.entry.type.low < 0)

    def input(self, name: str, value: int) -> None:
        self.node.input(f"axis{self.axis}.{name}", value)

    def tick(self, times: int = 1) -> None:
        self.node.advance(times * MS)

    def control(self, *words: int) -> None:
        for word in words:
            self.put("controlword", word)

    def enable(self, mode: int) -> None:
        self.put("modes_of_operation", mode)
        self.control(0x06, ENABLE)
        self.tick()
        assert self.shows(0x006F, 0x0027)
        assert self.get("modes_of_operation_display") == mode

    def go(self, target: int, word: int = SET_POINT) -> None:
        self.put("target_position", target)
        self.control(ENABLE, word)

    def shows(self, mask: int, bits: int) -> bool:
        return self.get("statusword") & mask == bits

    @property
    def position(self) -> int:
        return self.get("position_actual_value")

    def course(self, ticks: int) -> list[int]:
        """Where the axis is after each of so many ticks."""
        self.tick(ticks)
        told = {frame.at: frame.data for frame in self.node.last.frames if frame.id == COURSE}
        assert len(told) == ticks
        return [int.from_bytes(data, "little", signed=True) for data in told.values()]

    def _tell_course(self) -> None:
        record = TPDO + 0x40 * self.axis
        position = self.item("position_actual_value")
        for index, sub, value, size in (
            (record, 1, 0xC0000000 | COURSE, 4),
            (record + 0x200, 0, 0, 1),
            (record + 0x200, 1, position.index << 16 | position.entry.sub << 8 | position.entry.bit_length, 4),
            (record + 0x200, 0, 1, 1),
            (record, 2, 255, 1),
            (record, 5, 1, 2),
            (record, 1, 0x40000000 | COURSE, 4),
        ):
            assert self.node.sdo_write(index, sub, value.to_bytes(size, "little")) == 0
        self.node.nmt(0x01)

    def outputs(self, name: str) -> list[tuple[int, int]]:
        """What the last line put out to something of the axis: when, in ticks, and what."""
        begin = self.node.last.begin
        return [
            ((at - begin) // MS, value)
            for at, output, value in self.node.last.outputs
            if output == f"axis{self.axis}.{name}"
        ]

    def emergencies(self) -> list[int]:
        """The codes of those of this axis in the last answer."""
        sent = self.node.last.sent(0x80 + self.node.node_id)
        return [int.from_bytes(data[:2], "little") for data in sent if data[4] == self.axis]


Drives = Callable[[Device], Iterator[Drive]]


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


def drives_on(start: Callable[[Device], Driver]) -> Drives:
    """All axes of a device, each of them on a bench of its own."""

    def begin(device: Device) -> Iterator[Drive]:
        for axis in range(device.axes):
            node = start(device)
            node.power()
            node.advance(MS)
            yield Drive(node, device, axis)

    return begin


@pytest.fixture(params=["C", "Python"])
def drives(request: pytest.FixtureRequest, start_c: StartC, start_python: Callable[..., Bench]) -> Drives:
    start = start_c if request.param == "C" else start_python
    return drives_on(lambda device: InProcess(start(device).answer))


# ---- commands and set-points -----------------------------------------------------------------------------------------


def test_effect_controlword(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.control(0x06)
        assert drive.shows(0x006F, 0x0021)
        drive.control(0x07)
        assert drive.shows(0x006F, 0x0023)


def test_effect_mode(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.put("modes_of_operation", PV)
        assert drive.get("modes_of_operation_display") == 0
        drive.tick()
        assert drive.get("modes_of_operation_display") == PV


def test_effect_target_position(device: Device, drives: Drives) -> None:
    """In profile position it waits for the edge, in cyclic synchronous position the axis is there in a tick."""
    for drive in drives(device):
        drive.enable(PP)
        drive.put("target_position", 100)
        drive.tick(200)
        assert drive.position == 0
        drive.go(100)
        drive.tick(200)
        assert drive.position == 100
        drive.enable(CSP)
        drive.put("target_position", 150)
        drive.tick()
        assert drive.position == 150


def test_effect_target_velocity(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.enable(PV)
        drive.put("target_velocity", -3000)
        drive.tick(50)
        assert drive.get("velocity_actual_value") == -3000


def test_effect_set_point_offset(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.enable(CSP)
        drive.put("target_position", 40)
        drive.put("position_offset", 2)
        drive.tick()
        assert drive.position == 42
        drive.put("position_offset", -2)
        drive.tick()
        assert drive.position == 38
        drive.enable(9)
        drive.put("target_velocity", 5000)
        drive.put("velocity_offset", 500)
        drive.tick()
        assert drive.get("velocity_actual_value") == 5500


def test_effect_interpolation_time(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.enable(CSP)
        drive.put("interpolation_time_period_value", 4)
        drive.put("target_position", 40)
        assert drive.course(5) == [10, 20, 30, 40, 40]
        drive.put("interpolation_time_period_index", -2)
        drive.put("target_position", 0)
        assert drive.course(5) == [39, 38, 37, 36, 35]


def test_effect_option_code(device: Device, drives: Drives) -> None:
    """605Ah and 60F2h have a choice; the others have one value each."""
    for drive in drives(device):
        for name, value in (
            ("fault_reaction_option_code", 2),
            ("shutdown_option_code", 0),
            ("disable_operation_option_code", 1),
            ("halt_option_code", 1),
        ):
            drive.put(name, value)
        for code, state in ((1, DISABLED), (2, DISABLED), (5, QUICK_STOP), (6, QUICK_STOP)):
            drive.put("quick_stop_option_code", code)
            drive.enable(PP)
            drive.control(0x02)
            assert drive.shows(*state), code
            drive.control(0)
        for option, counts_from_target in ((0, True), (1, False), (2, False)):
            drive.put("positioning_option_code", option)
            drive.enable(PP)
            target = drive.position + 1000
            drive.go(target)
            drive.tick(20)
            drive.control(ENABLE | HALT)
            drive.tick(50)
            stopped = drive.position
            assert stopped < target
            drive.put("target_position", 10)
            drive.control(RELATIVE | HALT, ENABLE)
            drive.tick(200)
            assert drive.position == (target if counts_from_target else stopped) + 10, option
            drive.control(0)


# ---- ramps -----------------------------------------------------------------------------------------------------------


def test_effect_ramp_parameter(device: Device, drives: Drives) -> None:
    """Another value of any of them makes another way out of the same there and back, and a quick stop."""

    def there_and_back(drive: Drive) -> list[int]:
        drive.enable(PP)
        way = []
        for target, ticks in ((500, 70), (0, 200)):
            drive.go(target)
            way += drive.course(ticks)
            assert way[-1] == target
        drive.go(500)
        way += drive.course(30)
        drive.control(0x02)
        way += drive.course(30)
        drive.enable(PP)
        drive.go(0)
        drive.tick(400)
        assert drive.position == 0
        return way

    for drive in drives(device):
        usual = there_and_back(drive)
        assert there_and_back(drive) == usual
        for item in drive.of_effect("ramp_parameter"):
            before = RAMP.get(item.entry.role, 0)
            drive.write(item, 2 * before or 3000)
            assert there_and_back(drive) != usual, item.entry.role
            drive.write(item, before)
        assert there_and_back(drive) == usual


def test_effect_unit_selection(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        for unit, speed in ((0, 2861), (181, 3000)):
            drive.control(0)
            drive.put("velocity_dimension_index", unit)
            drive.tick()
            assert drive.get("acceleration_dimension_index") == (0 if unit == 0 else 179)
            drive.enable(PV)
            drive.put("target_velocity", 3000)
            drive.tick(100)
            assert drive.get("velocity_actual_value") in (2999, 3000)
            begin = drive.position
            drive.tick(1000)
            assert abs(drive.position - begin - speed) <= 1


def test_effect_position_limit(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.put("software_position_limit_minimum", -50)
        drive.put("software_position_limit_maximum", 70)
        drive.enable(PP)
        for target, end in ((1000, 70), (-1000, -50)):
            drive.go(target)
            drive.tick(200)
            assert drive.position == end
            assert drive.shows(LIMIT, LIMIT)


def test_effect_position_window(device: Device, drives: Drives) -> None:
    """The target is reached as soon as the axis has been in the window for that long."""

    def reached_after(drive: Drive) -> int:
        drive.put("target_position", 200)
        drive.control(ENABLE, RELATIVE)
        for tick in range(1, 200):
            drive.tick()
            if drive.shows(REACHED, REACHED):
                drive.tick(100)
                return tick
        return 0

    for drive in drives(device):
        drive.enable(PP)
        without = reached_after(drive)
        drive.put("position_window", 20)
        early = reached_after(drive)
        assert 0 < early < without
        drive.put("position_window_time", 30)
        assert reached_after(drive) == early + 30


# ---- homing ----------------------------------------------------------------------------------------------------------


def home(drive: Drive, ticks: int) -> list[int]:
    """The course of a homing that begins now at the position which the axis has."""
    drive.enable(HM)
    drive.control(ENABLE, START)
    way = drive.course(ticks)
    drive.control(0)
    return way


def home_from(drive: Drive, offset: int) -> list[int]:
    """A homing to the left that begins with the shaft at 0 and ends at the switch; the way that it takes."""
    drive.input("shaft", 0)
    way = home(drive, 250)
    assert way[-1] == -offset
    return [position - way[0] for position in way[:-1]] + way[-1:]


def set_up_homing(drive: Drive) -> None:
    drive.put("switch_parameters", 0)
    drive.input("left_at", -100)
    drive.input("right_at", 100)
    drive.put("homing_speeds_fast", 4000)
    drive.put("homing_speeds_slow", 1000)
    drive.put("homing_acceleration", 500_000)


def test_effect_homing_method(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        set_up_homing(drive)
        for method, is_on_its_way in ((17, -1), (18, 1), (0, 0)):
            drive.put("homing_method", method)
            way = home(drive, 10)
            assert (way[-1] > way[0]) - (way[-1] < way[0]) == is_on_its_way, method
        drive.put("homing_method", 35)
        assert home(drive, 1) == [0]


def test_effect_homing_parameter(device: Device, drives: Drives) -> None:
    """Speeds and acceleration make another way; the offset shows at its end."""
    for drive in drives(device):
        set_up_homing(drive)
        drive.put("homing_method", 17)
        begin = home_from(drive, 0)
        for name, value in (
            ("homing_speeds_fast", 5000),
            ("homing_speeds_slow", 900),
            ("homing_acceleration", 300_000),
        ):
            before = drive.get(name)
            drive.put(name, value)
            assert home_from(drive, 0) != begin, name
            drive.put(name, before)
        assert home_from(drive, 0) == begin
        drive.put("home_offset", 12)
        assert home_from(drive, 12)[-1] == -12
        assert drive.get("home_offset_display") == 12


# ---- switches and faults ---------------------------------------------------------------------------------------------


def test_effect_switch_parameters(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        for parameters, inputs in ((0x00, 0), (0x04, 1), (0x08, 2), (0x20, 4), (0x2C, 7), (0x3F, 0), (0x2D, 6)):
            drive.put("switch_parameters", parameters)
            drive.tick()
            assert drive.get("digital_inputs") & 7 == inputs, hex(parameters)


def test_effect_stop_on_stall(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.input("blocked", 1)
        drive.enable(PV)
        drive.put("target_velocity", 5000)
        drive.tick(100)
        assert not drive.emergencies()
        drive.put("stop_on_stall", 4000)
        drive.tick(2)
        assert drive.emergencies() == [0x3230]


# ---- motor and driver ------------------------------------------------------------------------------------------------


def test_effect_driver_parameter(device: Device, drives: Drives) -> None:
    """Whatever the driver is told: by the index of the object on axis 0."""
    for drive in drives(device):
        drive.node.do("TELL driver on")
        names = [name for name, effect in device.effects.items() if effect.to_driver]
        for item in (item for name in names for item in drive.of_effect(name)):
            allowed = item.entry.allowed
            for value in (allowed.low, allowed.high) if allowed else (0, 1):
                drive.write(item, value)
                assert drive.node.last.parameters == [
                    (drive.node.now, drive.axis, item.index - 0x200 * drive.axis, value)
                ]
        drive.node.nmt(0x81)
        assert sorted(drive.node.last.parameters) == drive.node.last.parameters


def test_effect_microstep_resolution(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.put("microstep_resolution", 4)
        drive.tick()
        assert drive.get("microstep_resolution_display") == 4


def test_effect_driver_current(device: Device, drives: Drives) -> None:
    """A chopper that is off leaves the motor without current; 20B9h says how slowly the current falls."""
    for drive in drives(device):
        drive.enable(PP)
        for off_time, current in ((0, 0), (5, 17)):
            drive.put("chopper_off_time", off_time)
            drive.tick()
            assert drive.outputs("current") == [(1, current)]
        drive.put("standby_current", 112)
        for ramp in (1, 3):
            drive.put("power_down_ramp", ramp)
            drive.control(0, 0x06, ENABLE)
            drive.tick(200)
            (first, one), (second, another) = drive.outputs("current")
            assert (one, another) == (16, 15)
            assert abs(second - first - 16.384 * ramp) <= 1


def test_effect_speed_threshold(device: Device, drives: Drives) -> None:
    """Which of its ways to run a motor the driver chooses: bits coolStep, stealthChop, dcStep and high speed."""
    thresholds = {
        "smart_energy_threshold_speed": (8, 9),
        "pwm_threshold_speed": (11, 9),
        "dcstep_minimum_speed": (9, 13),
        "fullstep_threshold_speed": (1, 9),
    }
    for drive in drives(device):
        assert {item.entry.role for item in drive.of_effect("speed_threshold")} == thresholds.keys()
        drive.node.do("TELL driver on")
        drive.enable(PV)
        for name, flags in thresholds.items():
            drive.put(name, 2000)
            for speed, expected in zip((1000, 3000), flags, strict=True):
                drive.put("target_velocity", 0)
                drive.tick(100)
                drive.put("target_velocity", speed)
                drive.tick(100)
                assert drive.outputs("driver")[-1][1] == expected, (name, speed)
            drive.put(name, 0)


def test_effect_current(device: Device, drives: Drives) -> None:
    """The running one, and some time after a stop the other one: 32nds of the full current."""
    for drive in drives(device):
        drive.put("power_down_ramp", 0)
        drive.put("maximum_current", 255)
        drive.put("standby_current", 15)
        drive.put("setting_delay", 2)
        drive.put("modes_of_operation", PP)
        drive.control(0x06, ENABLE)
        assert drive.outputs("current") == [(0, 32)]
        drive.tick(50)
        assert drive.outputs("current") == [(21, 2)]


def test_effect_brake(device: Device, drives: Drives) -> None:
    for drive in drives(device):
        drive.put("brake_current_feed_release", 9)
        drive.put("brake_current_feed_apply", 40)
        assert drive.outputs("brake") == [(0, 40)]
        drive.put("enable_drive_delay_time", 3)
        drive.put("brake_delay_times_release", 5)
        drive.put("brake_delay_times_apply", 7)
        drive.control(0x06, ENABLE)
        assert drive.outputs("power") == [(0, 1)]
        drive.tick(20)
        assert drive.outputs("brake") == [(3, 9)]
        assert drive.shows(0x006F, 0x0027)
        drive.control(0x07)
        assert drive.outputs("brake") == [(0, 40)]
        drive.tick(20)
        assert drive.outputs("power") == [(7, 0)]


# ---- encoder ---------------------------------------------------------------------------------------------------------


def with_encoder(drives: Iterator[Drive], increments: int = 2000) -> Iterator[Drive]:
    """Axes whose encoders count, 51200 microsteps a revolution."""
    for drive in drives:
        drive.input("increments", increments)
        drive.put("encoder_increments", increments)
        drive.tick()
        yield drive


def test_effect_encoder_parameter(tmcm6212: Device, drives: Drives) -> None:
    def turned(drive: Drive, steps: int = 51_200) -> int:
        begin = drive.position
        drive.input("shaft", steps)
        drive.tick(2)
        way = drive.position - begin
        drive.input("shaft", 0)
        drive.tick(2)
        return way

    for drive in with_encoder(drives(tmcm6212)):
        assert turned(drive) == 51_200
        for name, value, way in (
            ("encoder_direction", 1, -51_200),
            ("fullstep_resolution", 400, -102_400),
            ("encoder_increments", 4000, -51_200),
            ("encoder_direction", 0, 51_200),
        ):
            drive.put(name, value)
            assert turned(drive) == way, name
        drive.put("sensor_selection_code", -1)
        drive.input("shaft", 100)
        drive.tick()
        assert drive.get("velocity_actual_value") == 0
        drive.put("sensor_selection_code", 0)
        drive.input("shaft", 200)
        drive.tick()
        assert drive.get("velocity_actual_value") > 0
        for choice, demand in ((0, 0), (1, drive.position)):
            drive.put("encoder_init_position", choice)
            drive.enable(PP)
            assert (drive.get("position_demand_value") == drive.position) == bool(choice), demand
            drive.control(0)


def test_effect_encoder_latch(tmcm6212: Device, drives: Drives) -> None:
    """The next index pulse, which comes once in a revolution, and none after it."""
    for drive in with_encoder(drives(tmcm6212)):
        drive.put("encoder_polarity", 1)
        drive.enable(PV)
        drive.put("encoder_latch_mode", 1)
        drive.put("target_velocity", 100_000)
        drive.tick(800)
        assert drive.get("encoder_latch_mode") == 0
        assert 51_200 <= drive.get("latched_encoder_position") <= 51_300
        drive.tick(800)
        assert drive.get("latched_encoder_position") <= 51_300


def test_effect_following_window(tmcm6212: Device, drives: Drives) -> None:
    for drive in with_encoder(drives(tmcm6212)):
        drive.input("blocked", 1)
        drive.enable(PV)
        drive.put("target_velocity", 5000)
        drive.tick(200)
        assert not drive.emergencies()
        drive.put("following_error_window", 100)
        drive.tick(2)
        assert drive.emergencies() == [0x8611]
