"""One node of one device, in Python, behind the line protocol of PROTOCOL.md; the twin of `testee.c`.

    python testee.py PACKAGE [--node-id N] [--serial N] [--time HEX]

PACKAGE is the name of a generated package that can be imported.
"""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable, Container, Iterator, Sequence

from odsmith_cia import CONDITIONS, AbortCode

from odsmith_runtime.device import (
    Can,
    Config,
    Frame,
    Input,
    MemoryFailure,
    MotorAnswer,
    MotorDemand,
    Node,
    OsStatus,
    Output,
    Port,
    Tables,
)
from odsmith_runtime.device.simulation import SUPPLY, Simulation

LINE_SIZE = 250
MAX_STEP = 0x40000000
MASK = 0xFFFFFFFF

AXIS_CONDITIONS = {name for name, condition in CONDITIONS.items() if condition.scope == "axis"}

CAN_EVENTS = {
    "ok": Can.OK,
    "warning": Can.WARNING,
    "passive": Can.PASSIVE,
    "busoff": Can.BUS_OFF,
    "error": Can.ERROR,
    "overrun": Can.OVERRUN,
    "rxfull": Can.RX_FULL,
    "txfull": Can.TX_FULL,
}


class Nack(Exception):  # noqa: N818  (an answer, not an error)
    """Why a line is not obeyed."""


class Bench(Port):
    """What the node stands on, and what is told of it."""

    def __init__(self, tables: Tables, config: Config, now: int) -> None:
        self.tables = tables
        self.config = config
        self.power = "off"  # not yet; then on, cut
        self.now = now  # the end of this line
        self.begin = now
        self.told = now  # the instant that the reader knows of
        self.lines: list[str] = []
        self.writes_left = 0  # until power is lost; 0: it is not
        self.dead: Container[int] = ()  # octets of the memory that fail
        self.address = 0
        self.os_answer: tuple[OsStatus, bytes] | None = None
        self.tells_driver = False  # what the driver of each axis is told
        self.node = Node(tables, self, config)
        self.hardware = [Simulation() for _ in self.node.axes]
        self.image = bytearray(b"\xff" * self.node.store.size)

    # ---- what the device does ----------------------------------------------------------------------------------------

    def say(self, text: str, octets: bytes = b"") -> None:
        """Tell what the device does, and the instant where it is a new one."""
        if self.power != "on":
            return
        now = self.node.timers.now
        if now != self.told:
            self.lines.append(f"AT {now - self.begin & MASK}")
            self.told = now
        self.lines.append(_with_octets(text, octets))

    def send(self, frame: Frame) -> None:
        self.say(f"TX {frame.id:03X}", frame.data)

    def output(self, output: Output, channel: int, value: int) -> None:
        if output >= Output.POWER:
            self._axis_output(output, channel, value)
        elif output is Output.ANALOG:
            self.say(f"OUT analog{channel} {(value & 0x7FFF) - (value & 0x8000)}")
        else:
            self.say(f"OUT {output.name.lower()} {value}")

    def _axis_output(self, output: Output, axis: int, value: int) -> None:
        if self.power == "on":
            self.hardware[axis].output(output, value)
        if output is not Output.DRIVER or self.tells_driver:
            self.say(f"OUT axis{axis}.{output.name.lower()} {value}")

    def motor_set(self, axis: int, parameter: int, value: int) -> None:
        if self.tells_driver:
            self.say(f"OUT axis{axis}.parameter {parameter:04X} {value}")

    def motor(self, axis: int, demand: MotorDemand, answer: MotorAnswer) -> MotorAnswer:
        return self.hardware[axis].motor(demand) if self.power == "on" else answer

    def bus(self, bit_rate: int, node_id: int) -> None:
        self.say(f"BUS {bit_rate} {node_id}")

    def os_command(self, command: bytes) -> tuple[OsStatus, bytes]:
        if self.os_answer is None:
            return super().os_command(command)
        self.say("OS", command)
        return self.os_answer

    def nvm_read(self, address: int) -> int:
        if address in self.dead:
            raise MemoryFailure
        return self.image[address]

    def nvm_write(self, address: int, octet: int) -> None:
        if address in self.dead:
            raise MemoryFailure
        if self.writes_left:
            self.writes_left -= 1
            if not self.writes_left:
                self.power = "cut"
        if self.power == "on":
            self.image[address] = octet

    # ---- lines -------------------------------------------------------------------------------------------------------

    def answer(self, line: str) -> list[str]:
        """Obey a line; gives its answer."""
        self.lines = []
        self.begin = self.told = self.now
        try:
            self._obey(line.split(" ") if len(line) <= LINE_SIZE and "\0" not in line else [])
        except Nack as nack:
            return [f"NACK {nack}"]
        next_at = self.node.next() if self.power == "on" else None
        return [*self.lines, "NEXT -" if next_at is None else f"NEXT {next_at - self.now & MASK}"]

    def _obey(self, words: list[str]) -> None:
        handlers: dict[str, Callable[[list[str]], None]] = {
            "RX": self._rx,
            "T": self._time,
            "IN": self._input,
            "FAULT": self._fault,
            "CAN": self._can,
            "NVM": self._memory,
            "OS": self._os,
            "TELL": self._tell,
            "POWER": self._power,
            "DUMP": self._dump,
        }
        if not words or len(words) > 40 or words[0] not in handlers:
            raise Nack("malformed")
        handlers[words[0]](words[1:])

    def _has_power(self) -> bool:
        """False where an event happens to nobody."""
        if self.power == "off":
            raise Nack("off")
        return self.power == "on"

    def _rx(self, words: list[str]) -> None:
        identifier = _hex(words, 0, 1, 3)
        if words[1:2] == ["R"]:
            _require(len(words) <= 3)
            frame = Frame(identifier, remote=True, length=_decimal(words[2], 1) if len(words) == 3 else 0)
        else:
            frame = Frame(identifier, _octets(words[1:], 8))
        if identifier > 0x7FF or frame.dlc > 8:
            raise Nack("range")
        if self._has_power():
            self.node.receive(self.now, frame)

    def _time(self, words: list[str]) -> None:
        _require(len(words) == 1)
        step = _decimal(words[0], 10)
        if step > MAX_STEP:
            raise Nack("range")
        self.now = self.now + step & MASK
        if self.power == "on":
            self.node.advance(self.now)

    def _input(self, words: list[str]) -> None:
        _require(len(words) == 2 and _is_name(words[0]))
        value = _signed(words[1], 10)
        found = self._find_input(words[0])
        if found is None:
            self._set_hardware(words[0], value)
            return
        input, channel, highest = found
        if not 0 <= value <= highest:
            raise Nack("range")
        if input is Input.ADDRESS:
            self.address = value
        elif not self._has_power():
            return
        if self.power == "on":
            self.node.input(self.now, input, channel, value)

    def _find_input(self, name: str) -> tuple[Input, int, int] | None:
        """The input, its channel, and the highest value that it takes; None if the device itself has none."""
        match re.fullmatch(r"(address|enable|digital)|analog([0-9])", name):
            case None:
                return None
            case found if found[2]:
                channel = int(found[2])
                return (Input.ANALOG, channel, MASK) if channel < self.tables.identity.analog_inputs else None
            case found:
                return Input[name.upper()], 0, {"address": 255, "enable": 1}.get(name, MASK)

    def _set_hardware(self, name: str, value: int) -> None:
        """An input of the simulated hardware."""
        found = re.fullmatch(r"axis([0-9]{1,10})\.([^.]+)", name)
        axes = [axis for axis in range(len(self.hardware)) if not found or axis == int(found[1])]
        if not axes or (name != SUPPLY if not found else found[2] == SUPPLY):
            raise Nack("range")
        for axis in axes:
            try:
                self.hardware[axis].set(found[2] if found else SUPPLY, value)
            except (KeyError, ValueError):
                raise Nack("range") from None
            if self.power == "on":
                self.node.motor(self.now, axis, self.hardware[axis].answer)

    def _fault(self, words: list[str]) -> None:
        _require(len(words) == 3 and words[0].startswith("axis"))
        axis = _decimal(words[0].removeprefix("axis"), 10)
        _require(_is_name(words[1]) and words[2] in ("on", "off"))
        if axis >= len(self.node.axes) or words[1] not in AXIS_CONDITIONS:
            raise Nack("range")
        if self._has_power():
            self.node.fault(self.now, axis, words[1], words[2] == "on")

    def _can(self, words: list[str]) -> None:
        _require(len(words) == 1 and words[0] in CAN_EVENTS)
        if self._has_power():
            self.node.report_can(self.now, CAN_EVENTS[words[0]])

    def _memory(self, words: list[str]) -> None:
        if not words:
            for address in range(0, len(self.image), 32):
                self.lines.append(_with_octets(f"NVM {address:04X}", self.image[address : address + 32]))
        elif words in (["ok"], ["fail"]):
            self.dead = range(len(self.image)) if words == ["fail"] else ()
        elif words[0] == "fail":
            _require(len(words) == 2)
            address = _hex(words, 1, 1, 4)
            if address >= len(self.image):
                raise Nack("range")
            self.dead = (address,)
        elif words[0] == "set":
            _require(len(words) >= 3)
            address = _hex(words, 1, 1, 4)
            octets = _octets(words[2:], 32)
            if address + len(octets) > len(self.image):
                raise Nack("range")
            self.image[address : address + len(octets)] = octets
        else:
            raise Nack("malformed")

    def _os(self, words: list[str]) -> None:
        if words == ["none"]:
            self.os_answer = None
            return
        _require(bool(words))
        status = _decimal(words[0], 1)
        reply = _octets(words[1:], 7)
        if status > OsStatus.FAILED_WITH_REPLY:
            raise Nack("range")
        self.os_answer = OsStatus(status), reply

    def _tell(self, words: list[str]) -> None:
        _require(words in (["driver", "on"], ["driver", "off"]))
        self.tells_driver = words[1] == "on"

    def _power(self, words: list[str]) -> None:
        if words == ["on"]:
            if self.power == "on":
                raise Nack("on")
            if self.power == "cut":
                self.node = Node(self.tables, self, self.config)
            self.power = "on"
            self.writes_left = 0
            self.node.input(self.now, Input.ADDRESS, 0, self.address)
            for axis, hardware in enumerate(self.hardware):
                hardware.power_on()
                self.node.motor(self.now, axis, hardware.answer)
            self.node.power_on(self.now)
            return
        _require(words[:1] == ["cut"] and len(words) <= 2)
        writes = _decimal(words[1], 10) if len(words) == 2 else 0
        if len(words) == 2 and not 0 < writes <= MASK:
            raise Nack("range")
        if self._has_power():
            self.writes_left = writes
            if len(words) == 1:
                self.power = "cut"

    def _dump(self, words: list[str]) -> None:
        _require(len(words) == 1 and re.fullmatch("[0-9A-Fa-f]{4}-[0-9A-Fa-f]{4}", words[0]) is not None)
        first, last = (int(word, 16) for word in words[0].split("-"))
        if first > last:
            raise Nack("range")
        if self._has_power():
            self.lines += self._entries(first, last)

    def _entries(self, first: int, last: int) -> Iterator[str]:
        for index in self.tables.dictionary:
            if first <= index <= last:
                for entry in self.tables.dictionary[index]:
                    value = self.node.read(index, entry.sub)
                    address = f"OD {index:04X}:{entry.sub:02X}"
                    yield (
                        f"{address} ABORT {value:08X}" if isinstance(value, AbortCode) else _with_octets(address, value)
                    )


# ---- words -----------------------------------------------------------------------------------------------------------


def _require(condition: bool) -> None:
    if not condition:
        raise Nack("malformed")


def _with_octets(text: str, octets: bytes | bytearray) -> str:
    return f"{text} {octets.hex(' ').upper()}" if octets else text


def _hex(words: Sequence[str], at: int, min_digits: int, max_digits: int) -> int:
    word = words[at] if at < len(words) else ""
    _require(re.fullmatch(f"[0-9A-Fa-f]{{{min_digits},{max_digits}}}", word) is not None)
    return int(word, 16)


def _decimal(word: str, max_digits: int) -> int:
    _require(re.fullmatch(f"[0-9]{{1,{max_digits}}}", word) is not None)
    return int(word)


def _signed(word: str, max_digits: int) -> int:
    return -_decimal(word[1:], max_digits) if word.startswith("-") else _decimal(word, max_digits)


def _octets(words: Sequence[str], most: int) -> bytes:
    _require(len(words) <= most)
    return bytes(_hex(words, at, 2, 2) for at in range(len(words)))


def _is_name(word: str) -> bool:
    return re.fullmatch("[a-z0-9_.]+", word) is not None


# ---- the program -----------------------------------------------------------------------------------------------------


def read_options(words: Sequence[str]) -> tuple[Config, int]:
    """Configuration and clock. Raises SystemExit."""
    numbers = {"--node-id": 0, "--serial": 0, "--time": 0}
    highest = {"--node-id": 127, "--serial": MASK, "--time": MASK}
    for name, value in zip(words[::2], [*words[1::2], ""], strict=False):
        try:
            numbers[name] = _hex([value], 0, 1, 8) if name == "--time" else _decimal(value, 10)
            if name not in highest or numbers[name] > highest[name]:
                raise Nack("range")
        except Nack:
            print(f"usage: testee [--node-id N] [--serial N] [--time HEX], not {name} {value}", file=sys.stderr)
            raise SystemExit(2) from None
    return Config(serial_number=numbers["--serial"], node_id=numbers["--node-id"]), numbers["--time"]


def main(arguments: Sequence[str]) -> None:
    config, now = read_options(arguments[1:])
    bench = Bench(Tables.of(importlib.import_module(arguments[0])), config, now)
    for line in sys.stdin:
        print("\n".join(bench.answer(line.removesuffix("\n"))), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
