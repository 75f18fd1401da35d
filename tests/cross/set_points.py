"""Numbers for axes, drawn by hypothesis: mostly such with which an axis moves in a few milliseconds."""

from __future__ import annotations

from hypothesis import strategies as st

from odsmith_runtime.device.simulation import SUPPLY

HOMING = 6

STARTS = [(1, 0x1F), (1, 0x3F), (1, 0x5F), (3,), (3,), (HOMING, 0x1F), (HOMING, 0x1F), (8,), (9,)]
"""A mode of operation, and controlwords that start a motion in it."""

WORDS = [6, 7, 0xF, 0xF, 0x1F, 0x1F, 0x3F, 0x5F, 0x7F, 0x10F, 0x11F, 0xB, 0x80, 2, 0]
"""Controlwords: every command, and the bits of the modes."""

_ACCELERATIONS = st.sampled_from([1_000_000, 10_000_000, 100_000, 16_000_000, 500_000, 51_200, 51_200, 1, 0])

RAMP = {
    "profile_velocity": st.sampled_from([51_200, 51_200, 200_000, 200_000, 1_000_000, 1000, 0]),
    "profile_acceleration": _ACCELERATIONS,
    "profile_deceleration": _ACCELERATIONS,
    "homing_speeds_fast": st.sampled_from([51_200, 51_200, 200_000, 200_000, 100_000, 1000, 0]),
    "homing_speeds_slow": st.sampled_from([10_000, 10_000, 51_200, 20_000, 5000, 1000, 0]),
    "homing_acceleration": _ACCELERATIONS,
}
"""What a motion needs before it can begin, by role."""

_POSITIONS = st.integers(-4000, 4000)

SET_POINTS = RAMP | {
    "modes_of_operation": st.sampled_from([1, 3, 6, 8, 9, 1, 3, 0]),
    "target_position": st.one_of(_POSITIONS, _POSITIONS, st.integers(-0x80000000, 0x7FFFFFFF)),
    "target_velocity": st.one_of(st.integers(-400_000, 400_000), st.sampled_from([0, 51_200, -1])),
    "profile_start_velocity": st.sampled_from([0, 1000]),
    "end_velocity": st.sampled_from([0, 10, 1000]),
    "profile_v1": st.sampled_from([0, 10_000]),
    "profile_a1": _ACCELERATIONS,
    "profile_d1": _ACCELERATIONS,
    "ramp_wait_time": st.sampled_from([0, 100, 1000]),
    "quick_stop_deceleration": _ACCELERATIONS,
    "homing_method": st.sampled_from([35, 17, 18, 19, 21, 1, 2, 3, 5, 33, 34, 0]),
    "home_offset": st.integers(-2000, 2000),
    "software_position_limit_minimum": st.integers(-2000, 0),
    "software_position_limit_maximum": st.integers(0, 2000),
    "position_window": st.sampled_from([0, 10, 0xFFFFFFFF]),
    "position_window_time": st.sampled_from([0, 5]),
    "following_error_window": st.sampled_from([0, 10, 1000]),
    "quick_stop_option_code": st.sampled_from([1, 2, 5, 6]),
    "position_offset": st.one_of(st.just(0), st.integers(-2000, 2000)),
    "velocity_offset": st.one_of(st.just(0), st.integers(-400_000, 400_000)),
    "interpolation_time_period_value": st.sampled_from([1, 10, 0]),
    "positioning_option_code": st.sampled_from([0, 1, 2]),
    "switch_parameters": st.sampled_from([0, 0x03, 0x04, 0x08, 0x3F]),
    "enable_drive_delay_time": st.sampled_from([0, 5]),
    "maximum_current": st.sampled_from([128, 255, 0]),
    "standby_current": st.sampled_from([8, 0, 255]),
    "setting_delay": st.sampled_from([0, 1]),
    "power_down_ramp": st.sampled_from([0, 1, 7]),
    "velocity_dimension_index": st.sampled_from([181, 0]),
    "chopper_off_time": st.sampled_from([0, 5]),
    "stop_on_stall": st.sampled_from([0, 1000]),
    "pwm_threshold_speed": st.sampled_from([0, 100_000]),
    "smart_energy_threshold_speed": st.sampled_from([0, 100_000]),
    "dcstep_minimum_speed": st.sampled_from([0, 100_000]),
    "fullstep_threshold_speed": st.sampled_from([0, 100_000]),
    "microstep_resolution": st.sampled_from([8, 0]),
    "encoder_increments": st.sampled_from([0, 400]),
    "encoder_polarity": st.sampled_from([0, 1]),
    "encoder_direction": st.sampled_from([0, 1]),
    "encoder_init_position": st.sampled_from([0, 1]),
    "encoder_latch_mode": st.sampled_from([0, 1, 2]),
    "sensor_selection_code": st.sampled_from([0, 1]),
    "brake_current_feed_release": st.sampled_from([0, 200]),
    "brake_delay_times_release": st.sampled_from([0, 5]),
    "brake_delay_times_apply": st.sampled_from([0, 5]),
}
"""What may be written to an axis beside controlwords, by role."""

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
