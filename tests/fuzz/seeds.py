"""Dialogues for the fuzzer to begin with, written in the language of `fuzz_node.c`.

They lead it to where chance comes late: a mapping changed by its procedure, a stored set that survives a loss of power,
an axis that moves.
`seeds.py FOLDER` writes them.
"""

from __future__ import annotations

import struct
import sys
from pathlib import Path

# What happens, in the low bits of the first octet of an event.
SDO, NMT, SYNC, ERROR_CONTROL, FRAME, TIME, CAN, FAULT, OTHER = 0, 5, 7, 8, 9, 10, 13, 14, 15
ANY_SDO = 6
HARDWARE = 0x20
POWER_ON = 0x10

BEGIN = {0: bytes([4, 0, 0]), 1: bytes([8, 0, 0])}
"""By node: it is alone, time begins at 0, the port lacks nothing, no address switches."""

OF_MODES = {0: 0x3000, 1: 0x2700}
"""Where TMCL mode is switched on, by node; manufacturer mode comes next."""

MAKE = int.from_bytes(b"make", "little")
"""The signature that switches them on."""


class Dialogue:
    """Events of one node. Every method adds one."""

    def __init__(self, node: int) -> None:
        self.events = BEGIN[node]
        self.node = node

    def event(self, what: int, *details: int) -> Dialogue:
        self.events += bytes([self.node << 7 | what, *details])
        return self

    def sdo(self, command: int, index: int, sub: int, data: bytes = b"") -> Dialogue:
        request = struct.pack("<BHB4s", command, index, sub, data)
        return self.event(SDO, ANY_SDO, *request)

    def segment(self, octets: bytes) -> Dialogue:
        return self.event(SDO, ANY_SDO, *octets.ljust(8, b"\0"))

    def read(self, index: int, sub: int = 0) -> Dialogue:
        return self.sdo(0x40, index, sub)

    def write(self, index: int, sub: int, value: int, size: int) -> Dialogue:
        return self.sdo(0x23 | (4 - size) << 2, index, sub, value.to_bytes(size, "little"))

    def nmt(self, command: int) -> Dialogue:
        return self.event(NMT, 0x80, command)

    def frame(self, can_id: int, data: bytes) -> Dialogue:
        return self.event(FRAME, len(data), *can_id.to_bytes(2, "little"), *data)

    def words(self, *controlwords: int) -> Dialogue:
        for word in controlwords:
            self.write(0x6040, 0, word, 2)
        return self

    def enable(self, mode: int) -> Dialogue:
        """Axis 0, in a mode of operation, with a steep ramp and a fast one."""
        for index in (0x6083, 0x6084, 0x6085, 0x609A):
            self.write(index, 0, 10_000_000, 4)
        return self.write(0x6081, 0, 51_200, 4).write(0x6060, 0, mode, 1).milliseconds(1).words(6, 7, 15)

    def lines(self, levels: int) -> Dialogue:
        """The switches of axis 0."""
        return self.event(FAULT, HARDWARE, 0, levels)

    def milliseconds(self, count: int) -> Dialogue:
        """At most 63."""
        return self.event(TIME, count << 2)


def dialogues(node: int) -> dict[str, Dialogue]:
    """By name."""
    return {
        "expedited": Dialogue(node).read(0x1000).read(0x1018, 4).write(0x6040, 0, 6, 2).read(0x6041).read(0x5FFF),
        "upload": Dialogue(node).read(0x1008).segment(b"\x60").segment(b"\x70").segment(b"\x60").read(0x1009),
        "wrong_toggle": Dialogue(node).read(0x1008).segment(b"\x70").read(0x1009).segment(b"\x60"),
        "octet_by_octet": Dialogue(node)
        .sdo(0x20, 0x607D, 1)
        .segment(b"\x0c\x78")
        .segment(b"\x1c\x56")
        .segment(b"\x0c\x34")
        .segment(b"\x1d\x12")
        .read(0x607D, 1),
        "os_command": Dialogue(node)
        .write(OF_MODES[node], 0, MAKE, 4)
        .sdo(0x21, 0x1023, 1, struct.pack("<I", 7))
        .segment(b"\x01TMCL 12")
        .read(0x1023, 2)
        .read(0x1023, 3)
        .segment(b"\x60"),
        "pdos": Dialogue(node).nmt(1).frame(0x201, b"\x06\0").event(SYNC).frame(0x301, bytes(8)).milliseconds(20),
        "mapping": Dialogue(node)
        .write(0x1800, 1, 0xC0000181, 4)
        .write(0x1A00, 0, 0, 1)
        .write(0x1A00, 1, 0x60640020, 4)
        .write(0x1A00, 2, 0x60410010, 4)
        .write(0x1A00, 0, 2, 1)
        .write(0x1800, 2, 1, 1)
        .write(0x1800, 1, 0x40000181, 4)
        .nmt(1)
        .event(SYNC),
        "manufacturer_mode": Dialogue(node)
        .write(OF_MODES[node] + 1, 0, MAKE, 4)
        .write(0x1A00, 1, 0x60410010, 4)
        .write(0x1A00, 0, 1, 1)
        .write(0x1800, 1, 0x00000181, 4)
        .nmt(1)
        .frame(0x201, b"\x06\0"),
        "store": Dialogue(node)
        .write(0x607D, 1, 0xFFFFFF00, 4)
        .sdo(0x23, 0x1010, 1, b"save")
        .event(OTHER | POWER_ON, 0)
        .read(0x607D, 1)
        .sdo(0x23, 0x1011, 1, b"load")
        .nmt(129),
        "heartbeat": Dialogue(node)
        .write(0x1017, 0, 5, 2)
        .write(0x1016, 1, 0x0002000A, 4)
        .nmt(1)
        .event(ERROR_CONTROL, 0x42)
        .milliseconds(30)
        .event(ERROR_CONTROL, 0x42),
        "guarding": Dialogue(node)
        .write(0x100C, 0, 10, 2)
        .write(0x100D, 0, 2, 1)
        .event(ERROR_CONTROL, 0x80)
        .event(ERROR_CONTROL, 0x80)
        .milliseconds(40),
        "position": Dialogue(node)
        .enable(1)
        .write(0x607A, 0, 1000, 4)
        .words(0x1F)
        .milliseconds(10)
        .lines(2)
        .milliseconds(10)
        .lines(0)
        .milliseconds(63)
        .words(0x5F, 7)
        .milliseconds(63),
        "velocity": Dialogue(node)
        .enable(3)
        .write(0x60FF, 0, 51_200, 4)
        .milliseconds(20)
        .words(0x10F)
        .milliseconds(20)
        .words(0x0F, 0x02)
        .milliseconds(63),
        "homing": Dialogue(node)
        .write(0x6098, 0, 17, 1)
        .write(0x6099, 1, 51_200, 4)
        .write(0x6099, 2, 10_000, 4)
        .enable(6)
        .words(0x1F)
        .milliseconds(20)
        .lines(1)
        .milliseconds(20)
        .lines(0)
        .milliseconds(5),
        "cyclic": Dialogue(node)
        .nmt(1)
        .enable(8)
        .write(0x607A, 0, 100, 4)
        .milliseconds(5)
        .write(0x6060, 0, 9, 1)
        .write(0x60FF, 0, 1000, 4)
        .milliseconds(5)
        .nmt(2)
        .milliseconds(63),
        "errors": Dialogue(node)
        .nmt(1)
        .event(FAULT, 0x11, 8)
        .milliseconds(3)
        .event(CAN, 3)
        .event(CAN, 0)
        .event(FAULT, 0x01, 8)
        .milliseconds(3)
        .write(0x6840, 0, 0x80, 2)
        .milliseconds(1),
    }


def write_seeds(folder: Path) -> None:
    """A file for each dialogue with each node."""
    folder.mkdir(parents=True, exist_ok=True)
    for node in OF_MODES:
        for name, dialogue in dialogues(node).items():
            (folder / f"{name}{node}").write_bytes(dialogue.events)


if __name__ == "__main__":
    write_seeds(Path(sys.argv[1]))
