"""The border between a node and its hardware; the twin of `ods/port.h`.

A node never waits and never reads a clock. The program hands it frames, inputs and the time; what the node wants done
it asks of its port. Time is a count of microseconds in 32 bits, which wraps.
"""

from __future__ import annotations

from enum import IntEnum
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


class Input(IntEnum):
    """What comes in beside frames. All of it but the address acts at the next tick, as if it were sampled there."""

    ADDRESS = 0  # the address switches, 0 without any; read at power-on and reset node
    ENABLE = 1  # the enable input of the module, 1 at power-on
    DIGITAL = 2  # general purpose inputs: bit n is INn
    ANALOG = 3  # a reading of analog input `channel`, 16 bits; more counts as FFFFh


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

    def os_command(self, command: bytes) -> tuple[OsStatus, bytes]:
        """Carry out a command of 7 octets; gives its status and reply, which is cut or filled up to 7 octets."""
        return OsStatus.FAILED, b""
