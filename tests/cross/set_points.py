"""Numbers for axes: mostly such with which an axis moves in a few milliseconds.

Hypothesis draws them (`SET_POINTS`), or, where its choices take too long, a plain generator (`some_number`).
"""

from __future__ import annotations

from random import Random

from hypothesis import strategies as st

from odsmith_runtime.device.simulation import SUPPLY

HOMING = 6

STARTS = [(1, 0x1F), (1, 0x3F), (1, 0x5F), (3,), (3,), (HOMING, 0x1F), (HOMING, 0x1F), (8,), (9,)]
"""A mode of operation, and controlwords that start a motion in it."""

WORDS = [6, 7, 0xF, 0xF, 0x1F, 0x1F, 0x3F, 0x5F, 0x7F, 0x10F, 0x11F, 0xB, 0x80, 2, 0]
"""Controlwords: every command, and the bits of the modes."""

Numbers = tuple[int, ...] | range

_ACCELERATIONS = (1_000_000, 10_000_000, 100_000, 16_000_000, 500_000, 51_200, 51_200, 1, 0)

_RAMP: dict[str, Numbers | list[Numbers]] = {
    "profile_velocity": (51_200, 51_200, 200_000, 200_000, 1_000_000, 1000, 0),
    "profile_acceleration": _ACCELERATIONS,
    "profile_deceleration": _ACCELERATIONS,
    "homing_speeds_fast": (51_200, 51_200, 200_000, 200_000, 100_000, 1000, 0),
    "homing_speeds_slow": (10_000, 10_000, 51_200, 20_000, 5000, 1000, 0),
    "homing_acceleration": _ACCELERATIONS,
}
_POSITIONS = range(-4000, 4001)

_NUMBERS: dict[str, Numbers | list[Numbers]] = _RAMP | {
    "modes_of_operation": (1, 3, 6, 8, 9, 1, 3, 0),
    "target_position": [_POSITIONS, _POSITIONS, range(-0x80000000, 0x80000000)],
    "target_velocity": [range(-400_000, 400_001), (0, 51_200, -1)],
    "profile_start_velocity": (0, 1000),
    "end_velocity": (0, 10, 1000),
    "profile_v1": (0, 10_000),
    "profile_a1": _ACCELERATIONS,
    "profile_d1": _ACCELERATIONS,
    "ramp_wait_time": (0, 100, 1000),
    "quick_stop_deceleration": _ACCELERATIONS,
    "homing_method": (35, 17, 18, 19, 21, 1, 2, 3, 5, 33, 34, 0),
    "home_offset": range(-2000, 2001),
    "software_position_limit_minimum": range(-2000, 1),
    "software_position_limit_maximum": range(2001),
    "position_window": (0, 10, 0xFFFFFFFF),
    "position_window_time": (0, 5),
    "following_error_window": (0, 10, 1000),
    "quick_stop_option_code": (1, 2, 5, 6),
    "position_offset": [(0,), range(-2000, 2001)],
    "velocity_offset": [(0,), range(-400_000, 400_001)],
    "interpolation_time_period_value": (1, 10, 0),
    "positioning_option_code": (0, 1, 2),
    "switch_parameters": (0, 0x03, 0x04, 0x08, 0x3F),
    "enable_drive_delay_time": (0, 5),
    "maximum_current": (128, 255, 0),
    "standby_current": (8, 0, 255),
    "setting_delay": (0, 1),
    "power_down_ramp": (0, 1, 7),
    "velocity_dimension_index": (181, 0),
    "chopper_off_time": (0, 5),
    "stop_on_stall": (0, 1000),
    "pwm_threshold_speed": (0, 100_000),
    "smart_energy_threshold_speed": (0, 100_000),
    "dcstep_minimum_speed": (0, 100_000),
    "fullstep_threshold_speed": (0, 100_000),
    "microstep_resolution": (8, 0),
    "encoder_increments": (0, 400),
    "encoder_polarity": (0, 1),
    "encoder_direction": (0, 1),
    "encoder_init_position": (0, 1),
    "encoder_latch_mode": (0, 1, 2),
    "sensor_selection_code": (0, 1),
    "brake_current_feed_release": (0, 200),
    "brake_delay_times_release": (0, 5),
    "brake_delay_times_apply": (0, 5),
}
"""By role; where there are several choices, each of them is as likely as the others."""


def _strategy(numbers: Numbers | list[Numbers]) -> st.SearchStrategy[int]:
    if isinstance(numbers, list):
        return st.one_of([_strategy(choice) for choice in numbers])
    if isinstance(numbers, range):
        return st.integers(numbers[0], numbers[-1])
    return st.sampled_from(numbers)


SET_POINTS = {role: _strategy(numbers) for role, numbers in _NUMBERS.items()}
"""What may be written to an axis beside controlwords, by role."""

RAMP = {role: SET_POINTS[role] for role in _RAMP}
"""What a motion needs before it can begin, by role."""


def some_number(role: str, random: Random) -> int:
    """One for this role, without hypothesis."""
    numbers = _NUMBERS[role]
    return random.choice(random.choice(numbers) if isinstance(numbers, list) else numbers)


SWITCHES = {
    "left_at": st.integers(-3000, -500),
    "right_at": st.integers(500, 3000),
    "home_from": st.integers(-500, 100),
    "home_to": st.integers(100, 500),
    "hysteresis": st.sampled_from([0, 0, 20]),
}
"""Where the switches of an axis stand."""

LEVELS = {
    "temperature": (110, 111, 119, 120, 140, 149, 150),
    SUPPLY: (6999, 7000, 7499, 7500),
    "load": (1022, 1023),
    "increments": (400, 4000),
}
"""Inputs of the hardware with levels at which something happens."""
