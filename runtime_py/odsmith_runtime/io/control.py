"""What a hand does to a virtual device, as words: `axis0 overtemperature on`, `axis2 left 1`, `lose 3`.

axisN CONDITION on|off        a fault of the hardware, by its name in the model
axisN SWITCH on|off           left, right, home: somebody presses it
axisN INPUT VALUE             the simulated motor: load, temperature, left_at, right_at, home_from, home_to, shaft ...
axisN stall on|off            the shaft is held
supply MILLIVOLTS             of all motors
enable on|off                 the enable input of the module
inN on|off, analogN VALUE     its digital and analog inputs
address VALUE                 its switches, read at power-on and reset
can STATE                     the CAN controller: ok, warning, passive, busoff, error, overrun, rxfull, txfull
lose FRAMES                   so many of the next frames to or from the device are lost
delay MILLISECONDS            its frames are so late
power on|off|cycle

Of an axis, what is on or off may be without `on`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeVar

from ..device.port import Can, Input
from ..device.simulation import INPUTS, SUPPLY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from .device import VirtualDevice

CAN_WORDS = {
    "ok": Can.OK,
    "warning": Can.WARNING,
    "passive": Can.PASSIVE,
    "busoff": Can.BUS_OFF,
    "error": Can.ERROR,
    "overrun": Can.OVERRUN,
    "rxfull": Can.RX_FULL,
    "txfull": Can.TX_FULL,
}

T = TypeVar("T")

UNITS = {
    **dict.fromkeys(("left_at", "right_at", "home_from", "home_to", "hysteresis", "shaft"), "microsteps"),
    "load": "parts of 1023",
    "temperature": "degrees Celsius",
    "revolution": "microsteps",
    "increments": "increments of the encoder in a revolution",
    "supply": "millivolts",
    "address": "the number that the switches show",
    "lose": "frames",
    "delay": "milliseconds",
}
"""What the values of commands are in, but for those that are on or off."""

_SWITCHED = {"on": 1, "off": 0, "1": 1, "0": 0}
_LONGEST_DELAY_MS = 60_000


class CommandError(ValueError):
    """A command is not understood, or not possible; the message says what would be."""


def obey(device: VirtualDevice, words: Sequence[str]) -> None:
    """Carry out a command. Raises CommandError."""
    if not words:
        raise CommandError("nothing to do: name an axis or a line of the device")
    name, *rest = words
    if axis := re.fullmatch(r"axis(\d{1,3})", name):
        _of_axis(device, int(axis[1]), rest)
    else:
        _of_device(device, name, rest)


def _of_axis(device: VirtualDevice, axis: int, words: Sequence[str]) -> None:
    if axis >= device.axis_count:
        raise CommandError(f"there is no axis {axis}, axes are 0 to {device.axis_count - 1}")
    if not 1 <= len(words) <= 2:
        raise CommandError("wanted: the name of a fault or of an input, then its value")
    name, *values = words
    if name == "stall":  # of the shaft, not the condition that follows from it
        name = "blocked"
    elif name in device.conditions:
        device.fault(axis, name, bool(_switched(*values)))
        return
    if name not in INPUTS or name == SUPPLY:
        known = sorted({*device.conditions, *INPUTS} - {SUPPLY})
        raise CommandError(f"there is no `{name}` of an axis, but {', '.join(known)}")
    try:
        device.set_hardware(axis, name, _number(name, *values) if name in UNITS else _switched(*values))
    except ValueError as error:
        raise CommandError(str(error)) from None


def _of_device(device: VirtualDevice, name: str, words: Sequence[str]) -> None:
    numbered = re.fullmatch(r"(in|analog)(\d{1,2})", name)
    if len(words) != 1:
        unit = f": {UNITS[name]}" if name in UNITS else ""
        raise CommandError(f"`{name}` wants one value{unit}")
    (value,) = words
    if name == SUPPLY:
        limits = INPUTS[SUPPLY]
        for axis in range(device.axis_count):
            device.set_hardware(axis, SUPPLY, _within(name, value, limits.low, limits.high))
    elif name == "enable":
        device.input(Input.ENABLE, 0, _switched(value))
    elif name == "address":
        device.input(Input.ADDRESS, 0, _within(name, value, 0, 0xFF))
    elif numbered:
        _channel(device, numbered[1], int(numbered[2]), value)
    elif name == "can":
        device.report_can(_one_of(value, CAN_WORDS))
    elif name == "lose":
        device.lose(_within(name, value, 0, 1_000_000))
    elif name == "delay":
        device.delay(_within(name, value, 0, _LONGEST_DELAY_MS))
    elif name == "power":
        _one_of(value, {"on": 1, "off": 0, "cycle": 2})
        if value in ("off", "cycle"):
            device.power_off()
        if value in ("on", "cycle"):
            device.power_on()
    else:
        known = "axisN, supply, enable, inN, analogN, address, can, lose, delay, power"
        raise CommandError(f"there is no `{name}`; known: {known}")


def _channel(device: VirtualDevice, kind: str, channel: int, value: str) -> None:
    identity = device.identity
    count = identity.digital_inputs if kind == "in" else identity.analog_inputs
    if channel >= count:
        raise CommandError(f"there is no {kind}{channel}, the device has {count}")
    if kind == "analog":
        device.input(Input.ANALOG, channel, _within(kind, value, 0, 0xFFFF))
    else:
        device.digital_input(channel, bool(_switched(value)))


def _switched(word: str = "on") -> int:
    if word not in _SWITCHED:
        raise CommandError(f"on or off, not `{word}`")
    return _SWITCHED[word]


def _number(name: str, word: str = "") -> int:
    if not re.fullmatch(r"-?\d{1,12}", word):
        unit = f" ({UNITS[name]})" if name in UNITS else ""
        raise CommandError(f"{name} wants a whole number{unit}" + (f", not `{word}`" if word else ""))
    return int(word)


def _within(name: str, word: str, low: int, high: int) -> int:
    value = _number(name, word)
    if not low <= value <= high:
        raise CommandError(f"{name} is {low} to {high}, not {value}")
    return value


def _one_of(word: str, known: Mapping[str, T]) -> T:
    if word not in known:
        raise CommandError(f"{', '.join(known)}, not `{word}`")
    return known[word]
