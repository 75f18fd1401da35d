"""The border between a node and its hardware; the twin of `ods/port.h`.

A node never waits and never reads a clock. The program hands it frames, inputs and the time; what the node wants done
it asks of its port. Time is a count of microseconds in 32 bits, which wraps.
"""

from __future__ import annotations

from enum import IntEnum, IntFlag
from typing import NamedTuple


class Frame(NamedTuple):
    """A CAN frame with an 11 bit CAN-ID. Of a remote frame, which has no data, `length` is the DLC."""

    id: int
    data: bytes = b""
    remote: bool = False
    length: int = 0

    @property
    def dlc(self) -> int:
        return self.length if self.remote else len(self.data)


class Output(IntEnum):
    """What a device puts out beside frames, in the order in which changes are told."""

    RUN_LED = 0  # 0 or 1
    ERROR_LED = 1  # 0 or 1
    DIGITAL = 2  # general purpose outputs: bit n is OUTn
    ANALOG = 3  # analog output `channel`, 16 bits
    POWER = 4  # power stage of axis `channel`, 0 or 1; from here on 0 at power-on without being told
    BRAKE = 5  # current into the brake of axis `channel`, 0 to 255 as in 200Ch
    CURRENT = 6  # current of motor `channel` in 32nds of the full one; 0: the motor turns freely
    DRIVER = 7  # how driver `channel` runs its motor: the bits of DriverFlags


class DriverFlags(IntFlag):
    """What the driver of a motor does at the present speed."""

    COOL_STEP = 1  # faster than 20A5h: the current follows the load
    STEALTH_CHOP = 2  # slower than 20B0h
    DC_STEP = 4  # not slower than 20B3h, unless that is 0
    HIGH_SPEED = 8  # faster than 20B6h: what 20B7h and 20B8h ask for


class Input(IntEnum):
    """What comes in beside frames. All of it but the address acts at the next tick, as if it were sampled there."""

    ADDRESS = 0  # the address switches, 0 without any; read at power-on and reset node
    ENABLE = 1  # the enable input of the module, 1 at power-on
    DIGITAL = 2  # general purpose inputs: bit n is INn
    ANALOG = 3  # a reading of analog input `channel`, 16 bits; more counts as FFFFh


class Lines(IntFlag):
    """Lines of an axis, as they are: what 2005h says of them is the business of the node."""

    LEFT = 1  # limit switch of the negative direction
    RIGHT = 2  # limit switch of the positive direction
    HOME = 4
    INDEX = 8  # N channel of the encoder


class MotorDemand(NamedTuple):
    """What an axis asks of its motor in a tick."""

    steps: int = 0  # microsteps to make in this tick, negative backwards
    velocity: int = 0  # at its end, in microsteps per second


class MotorAnswer(NamedTuple):
    """What the hardware of an axis has to say, sampled by the next tick."""

    faults: frozenset[str] = frozenset()  # conditions that hold, by their names in the vocabulary
    encoder: int = 0  # count of increments, which wraps as an INTEGER32
    velocity: int = 0  # measured by the driver, in microsteps per second (2122h)
    load: int = 0  # measured by the driver: 1023 idle, 0 stalled (2101h)
    pwm_scale: int = 0  # of the driver in stealthChop (2121h)
    lines: int = 0  # Lines


class Can(IntEnum):
    """States of the CAN controller, each worse than the one before, and what can happen to it."""

    OK = 0  # error active
    WARNING = 1  # an error counter is at 96 or above
    PASSIVE = 2  # error passive
    BUS_OFF = 3  # nothing is received, nothing can be sent
    ERROR = 4  # an event: the controller reports an error of the bus
    OVERRUN = 5  # an event: a frame was lost in the controller
    TX_FULL = 6  # an event: a frame was lost because the transmit queue was full
    RX_FULL = 7  # an event: a frame was lost because the receive queue was full


class OsStatus(IntEnum):
    """How an OS command ended, as 1023h:02 shows it (CiA 301, 7.5.2.26)."""

    DONE = 0
    DONE_WITH_REPLY = 1
    FAILED = 2
    FAILED_WITH_REPLY = 3


OS_COMMAND_SIZE = 7
"""Octets of an OS command, and of its reply."""


class MemoryFailure(Exception):  # noqa: N818  # it is an event of the hardware, not a mistake of the caller
    """Non-volatile memory does not take or give an octet."""


class Port:
    """Hardware that a node stands on. A subclass replaces what it has; what it lacks stays as it is here."""

    def send(self, frame: Frame) -> None:
        """Take a frame for sending. Frames leave in the order of the calls."""

    def output(self, output: Output, channel: int, value: int) -> None:
        """Set an output. Called only when the value changes, and for every output at power-on."""

    def bus(self, bit_rate: int, node_id: int) -> None:
        """Join the bus at a bit rate in kbit/s: at power-on and reset node, before the boot-up frame."""

    def nvm_read(self, address: int) -> int:
        """An octet of non-volatile memory. Raises MemoryFailure."""
        raise MemoryFailure

    def nvm_write(self, address: int, octet: int) -> None:
        """Write an octet. It is complete when the call returns. Raises MemoryFailure."""
        raise MemoryFailure

    def motor_set(self, axis: int, parameter: int, value: int) -> None:
        """Set a parameter of the motor driver of an axis, which is the value of the object with this index in axis 0.

        Called when it is written, and for all of them at power-on and reset node.
        """

    def motor(self, axis: int, demand: MotorDemand, answer: MotorAnswer) -> MotorAnswer:
        """A tick of an axis is over: make its steps; gives what the hardware has to say to the next tick.

        `answer` is what it said last. Called in each tick for every axis, in ascending order, after all axes have been
        worked off; not called while nothing moves.
        """
        return answer

    def os_command(self, command: bytes) -> tuple[OsStatus, bytes]:
        """Carry out a command of 7 octets; gives its status and reply, which is cut or filled up to 7 octets."""
        return OsStatus.FAILED, b""
