"""Simulated hardware of an axis, behind the callback `motor` of a port; the twin of `ods_simulation.c`.

    axes = [Simulation() for _ in range(node_axes)]
    def output(self, output, channel, value): axes[channel].output(output, value)      # of outputs of an axis
    def motor(self, axis, demand, answer): return axes[axis].motor(demand)

It is a motor without mass that makes every step it is told, with limit and home switches, an encoder, a load, a
temperature and a supply. What a hand does to it is an input: `set`, and the node's `motor` with the answer.

The shaft and all inputs are the bench's: they stay what they are when the node is reset or its power goes. Nothing
happens between two calls, so what a shaft passes by within a tick nobody sees.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.words import Condition

from .port import DriverFlags, Lines, MotorAnswer, Output

if TYPE_CHECKING:
    from .port import MotorDemand

# Figures of this simulation: no manual has them. A condition ends only when its cause has gone by some way.
_WARM = 120  # degrees Celsius: from here on the temperature warning
_HOT = 150  # degrees Celsius: from here on overtemperature
_COOLING = 10  # so many degrees below, they end
_SUPPLY = 24_000  # mV
_LOW_SUPPLY = 7_000  # mV: below it undervoltage
_GOOD_SUPPLY = 7_500  # mV: from here on none
_ROOM_TEMPERATURE = 25
_ABSOLUTE_ZERO = -273
_HIGHEST_TEMPERATURE = 1_000
_HIGHEST_SUPPLY = 100_000
_MICROSTEPS_PER_REVOLUTION = 51_200  # of a motor with 200 full steps, at 256 microsteps for each of them

_IDLE_LOAD = 1023
_PWM_MAX = 255
_PWM_PPS = 1_000  # for each step of the PWM scale

_MIN, _MAX = -0x80000000, 0x7FFFFFFF


class Range(NamedTuple):
    """What an input may be, and what it is at first."""

    low: int
    high: int
    initial: int = 0


SUPPLY = "supply"
"""The input that all axes of a module have in common."""

INPUTS = {
    "left": Range(0, 1),  # 1: somebody presses the switch; so the next two
    "right": Range(0, 1),
    "home": Range(0, 1),
    "left_at": Range(_MIN, _MAX),  # the switch is active here and to the left of it
    "right_at": Range(_MIN, _MAX),  # the switch is active here and to the right of it
    "home_from": Range(_MIN, _MAX),  # the switch is active from here
    "home_to": Range(_MIN, _MAX),  # up to here
    "hysteresis": Range(0, _MAX),  # so far outside a switch has to be before it is released
    "load": Range(0, _IDLE_LOAD),  # what takes so much away from the load value of a moving motor, 1023 when idle
    "blocked": Range(0, 1),  # 1: the shaft is held
    "temperature": Range(_ABSOLUTE_ZERO, _HIGHEST_TEMPERATURE, _ROOM_TEMPERATURE),  # of the driver, degrees Celsius
    "revolution": Range(1, _MAX, _MICROSTEPS_PER_REVOLUTION),  # microsteps of a revolution of the shaft
    "increments": Range(0, _MAX),  # of the encoder in a revolution; 0: there is none
    "shaft": Range(_MIN, _MAX),  # turns the shaft to this position
    SUPPLY: Range(0, _HIGHEST_SUPPLY, _SUPPLY),  # of the motor, in mV
}
"""What can be set. Positions are those of the shaft, in microsteps; where none was set there is no such switch."""


class Simulation:
    """An axis, at first a motor at rest at position 0, cold, supplied, without switches and encoder.

    `shaft` is the position of its shaft in microsteps, `answer` what it has to say.
    """

    def __init__(self) -> None:
        self.shaft = 0
        self.answer = MotorAnswer()
        self._inputs = {name: limits.initial for name, limits in INPUTS.items()}
        self._set: set[str] = set()
        self._current = 0  # as last put out
        self._driver = DriverFlags(0)
        self._switches = Lines(0)  # switches at positions that the shaft has reached and not left

    # ---- what happens to it ------------------------------------------------------------------------------------------

    def power_on(self) -> None:
        """The module is powered: nothing is put out any more, and the driver has not measured anything yet."""
        self._current = 0
        self._driver = DriverFlags(0)
        self.answer = self.answer._replace(velocity=0, load=0, pwm_scale=0)

    def set(self, name: str, value: int) -> None:
        """Set an input. Raises KeyError for one that there is not, ValueError for a value out of its range."""
        limits = INPUTS[name]
        if not limits.low <= value <= limits.high:
            raise ValueError(f"{name} is {limits.low} to {limits.high}, not {value}")
        self._inputs[name] = value
        self._set.add(name)
        if name == "shaft":
            self.shaft = value
        self._look()

    def output(self, output: Output, value: int) -> None:
        """An output of the axis has changed."""
        if output is Output.CURRENT:
            self._current = value
        elif output is Output.DRIVER:
            self._driver = DriverFlags(value)

    def motor(self, demand: MotorDemand) -> MotorAnswer:
        """A tick is over."""
        if self._current and not self._inputs["blocked"]:
            self.shaft += demand.steps
        self._measure(demand.velocity)
        self._look()
        return self.answer

    # ---- what the hardware has to say --------------------------------------------------------------------------------

    def _measure(self, velocity: int) -> None:
        """What the driver measures in a tick at such a velocity."""
        blocked = self._inputs["blocked"]
        load = self.answer.load
        if velocity:
            load = 0 if blocked else _IDLE_LOAD - self._inputs["load"]
        pwm_scale = min(_PWM_MAX, abs(velocity) // _PWM_PPS) if DriverFlags.STEALTH_CHOP in self._driver else 0
        self.answer = self.answer._replace(velocity=0 if blocked else velocity, load=load, pwm_scale=pwm_scale)

    def _look(self) -> None:
        self._look_at_switches()
        encoder, index = self._look_at_encoder()
        lines = self._switches | self._pressed() | index
        self.answer = self.answer._replace(faults=self._faults(), encoder=encoder, lines=int(lines))

    def _look_at_switches(self) -> None:
        at = self._inputs
        if "left_at" in self._set:
            self._reach(Lines.LEFT, self.shaft - at["left_at"])
        if "right_at" in self._set:
            self._reach(Lines.RIGHT, at["right_at"] - self.shaft)
        if {"home_from", "home_to"} <= self._set:
            self._reach(Lines.HOME, max(at["home_from"] - self.shaft, self.shaft - at["home_to"]))

    def _reach(self, line: Lines, outside: int) -> None:
        """A switch at a position: the shaft is so many microsteps outside of it, or inside if that is not positive.

        Once active it takes the hysteresis to release it.
        """
        if outside <= (self._inputs["hysteresis"] if line in self._switches else 0):
            self._switches |= line
        else:
            self._switches &= ~line

    def _pressed(self) -> Lines:
        """The lines of the switches that a hand presses."""
        return (
            (Lines.LEFT if self._inputs["left"] else Lines(0))
            | (Lines.RIGHT if self._inputs["right"] else Lines(0))
            | (Lines.HOME if self._inputs["home"] else Lines(0))
        )

    def _look_at_encoder(self) -> tuple[int, Lines]:
        """The count of the encoder, rounded down, and its index, which lasts about as long as a count."""
        increments, revolution = self._inputs["increments"], self._inputs["revolution"]
        count = self.shaft * increments // revolution & 0xFFFFFFFF
        is_index = increments > 0 and self.shaft % revolution < max(1, revolution // increments)
        return count - (count >> 31 << 32), Lines.INDEX if is_index else Lines(0)

    def _faults(self) -> frozenset[str]:
        temperature, supply = self._inputs["temperature"], self._inputs[SUPPLY]
        faults = set(self.answer.faults)
        for condition, begins, ends in (
            (Condition.TEMPERATURE_WARNING, temperature >= _WARM, temperature <= _WARM - _COOLING),
            (Condition.OVERTEMPERATURE, temperature >= _HOT, temperature <= _HOT - _COOLING),
            (Condition.UNDERVOLTAGE, supply < _LOW_SUPPLY, supply >= _GOOD_SUPPLY),
        ):
            if begins:
                faults.add(condition)
            elif ends:
                faults.discard(condition)
        return frozenset(faults)
