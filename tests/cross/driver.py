"""Drive a testee, a program around one node that speaks the protocol of PROTOCOL.md.

    with Testee([program]) as testee:
        testee.power()
        assert testee.sdo_read(0x1000, 0) == bytes.fromhex("9201FCFF")

    InProcess(bench.answer)  # the same with one that runs in this process

Time is virtual: it passes only in `advance`, in microseconds. Instants count from the start of the program, whatever
its clock says.
"""

from __future__ import annotations

import os
import select
import subprocess
import tempfile
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import TracebackType

PATIENCE = 60
"""Seconds after which a testee that says nothing counts as hung."""

LONGEST_STEP = 1 << 30
"""Microseconds that may pass in one line."""


class TesteeError(AssertionError):
    """A testee that died, hangs, or says what is not in the protocol."""

    __test__ = False


@dataclass(frozen=True)
class Frame:
    """A frame that the device sent: when (us), its CAN-ID and its octets."""

    at: int
    id: int
    data: bytes

    def __str__(self) -> str:
        return f"{self.id:03X} {self.data.hex(' ').upper()}".rstrip()


@dataclass(frozen=True)
class Answer:
    """What a testee said to one line that was sent at the instant `begin`."""

    begin: int
    lines: tuple[str, ...]

    @property
    def nack(self) -> str:
        """Why the line was refused, or nothing."""
        return self.lines[-1].removeprefix("NACK ") if self.lines[-1].startswith("NACK ") else ""

    @property
    def next(self) -> int | None:
        """Microseconds until the device has something to do; None if it waits for an event."""
        word = self.lines[-1].removeprefix("NEXT ")
        return None if word == "-" else int(word)

    @cached_property
    def events(self) -> list[tuple[int, str]]:
        """Everything that happened, with its instant."""
        at = self.begin
        events = []
        for line in self.lines[:-1]:
            if line.startswith("AT "):
                at = self.begin + int(line.removeprefix("AT "))
            else:
                events.append((at, line))
        return events

    @cached_property
    def frames(self) -> list[Frame]:
        frames = []
        for at, line in self.events:
            word, *rest = line.split(" ")
            if word == "TX":
                frames.append(Frame(at, int(rest[0], 16), bytes.fromhex("".join(rest[1:]))))
        return frames

    @cached_property
    def outputs(self) -> list[tuple[int, str, int]]:
        """Changes of outputs: when, which, to what."""
        words = [(at, line.split(" ")) for at, line in self.events]
        return [(at, word[1], int(word[2])) for at, word in words if word[0] == "OUT" and len(word) == 3]

    @cached_property
    def parameters(self) -> list[tuple[int, int, int, int]]:
        """What the motor drivers were told, after `TELL driver on`: when, axis, index on axis 0, value."""
        words = [(at, line.split(" ")) for at, line in self.events]
        return [
            (at, int(word[1].removeprefix("axis").removesuffix(".parameter")), int(word[2], 16), int(word[3]))
            for at, word in words
            if word[0] == "OUT" and len(word) == 4
        ]

    def sent(self, can_id: int) -> list[bytes]:
        """The data of all frames with this CAN-ID."""
        return [frame.data for frame in self.frames if frame.id == can_id]


class Driver:
    """What can be done with any testee.

    `now` is in microseconds since the start, `last` the last answer, `node_id` the one under which the device joined
    the bus, `abort_codes` all that it has given so far.
    """

    def __init__(self, node_id: int = 0) -> None:
        self.node_id = node_id or 1
        self.now = 0
        self.last = Answer(0, ("NEXT -",))
        self.abort_codes: set[int] = set()
        self._dialogue: deque[str] = deque(maxlen=40)

    def _ask(self, text: str) -> list[str]:
        """The answer to a line."""
        raise NotImplementedError

    def line(self, text: str) -> Answer:
        """Send a line and read its answer, a refusal included."""
        self._dialogue.append(f"> {text}")
        self.last = Answer(self.now, tuple(self._ask(text)))
        self._dialogue.extend(self.last.lines)
        for _, event in self.last.events:
            if event.startswith("BUS "):
                self.node_id = int(event.split(" ")[2])
        for frame in self.last.frames:
            if frame.id == 0x580 + self.node_id and frame.data[0] == 0x80:
                self.abort_codes.add(int.from_bytes(frame.data[4:], "little"))
        return self.last

    def do(self, text: str) -> Answer:
        """Send a line that must be obeyed."""
        answer = self.line(text)
        if answer.nack:
            raise TesteeError(self._report(f"refused: {answer.nack}", ""))
        return answer

    def _report(self, what: str, errors: str) -> str:
        return "\n".join([what, errors, "the dialogue ended with", *self._dialogue])

    # ---- events ------------------------------------------------------------------------------------------------------

    def power(self) -> Answer:
        return self.do("POWER on")

    def cut(self, writes: int = 0) -> Answer:
        """Power goes now, or at the n-th next octet written to the memory."""
        return self.do(f"POWER cut {writes}" if writes else "POWER cut")

    def rx(self, can_id: int, data: bytes | Sequence[int] = b"") -> Answer:
        """The device receives a data frame."""
        return self.do(" ".join([f"RX {can_id:X}", *(f"{octet:02X}" for octet in data)]))

    def remote(self, can_id: int, length: int = 0) -> Answer:
        """The device receives a remote frame."""
        return self.do(f"RX {can_id:X} R {length}")

    def advance(self, us: int) -> Answer:
        """Time passes; the answers of long times are joined."""
        begin = self.now
        lines: list[str] = []
        while True:
            step = min(us, LONGEST_STEP)
            answer = self.do(f"T {step}")
            for at, event in answer.events:
                lines += [f"AT {at - begin}", event]
            self.now += step
            us -= step
            if not us:
                self.last = Answer(begin, (*lines, answer.lines[-1]))
                return self.last

    def input(self, name: str, value: int) -> Answer:
        return self.do(f"IN {name} {value}")

    def fault(self, axis: int, condition: str, holds: bool = True) -> Answer:
        return self.do(f"FAULT axis{axis} {condition} {'on' if holds else 'off'}")

    def can(self, event: str) -> Answer:
        return self.do(f"CAN {event}")

    # ---- services ----------------------------------------------------------------------------------------------------

    def nmt(self, command: int, node_id: int | None = None) -> Answer:
        """Send an NMT command to this node, to another one, or to all (0)."""
        return self.rx(0, [command, self.node_id if node_id is None else node_id])

    def request(self, data: bytes | Sequence[int]) -> bytes | None:
        """Send a frame to the SDO server and give the one that it answers with, if any."""
        answers = self.rx(0x600 + self.node_id, data).sent(0x580 + self.node_id)
        if len(answers) > 1:
            raise TesteeError(self._report("more than one answer to an SDO request", ""))
        return answers[0] if answers else None

    def sdo_read(self, index: int, sub: int) -> bytes | int:
        """The octets of an entry, or an abort code."""
        address = _address(index, sub)
        answer = self._answer([0x40, *address, 0, 0, 0, 0])
        if answer[0] == 0x80:
            return _abort_code(answer)
        self._expect(answer[0] >> 5 == 2 and list(answer[1:4]) == address, "an answer to an initiate upload")
        if answer[0] & 2:
            self._expect(bool(answer[0] & 1), "an expedited upload that tells its size")
            return answer[4 : 8 - (answer[0] >> 2 & 3)]
        size = int.from_bytes(answer[4:], "little")
        value = b""
        toggle = 0
        while True:
            answer = self._answer([0x60 | toggle, 0, 0, 0, 0, 0, 0, 0])
            if answer[0] == 0x80:
                return _abort_code(answer)
            self._expect(answer[0] & 0xF0 == toggle, "a segment")
            value += answer[1 : 8 - (answer[0] >> 1 & 7)]
            toggle ^= 0x10
            if answer[0] & 1:
                self._expect(len(value) == size, f"{size} octets")
                return value

    def sdo_write(self, index: int, sub: int, value: bytes, *, segmented: bool = False, sized: bool = True) -> int:
        """Write an entry, expedited where it fits and `segmented` does not say otherwise. Returns 0 or an abort code.

        Without `sized` the request does not tell the size; expedited it then has four octets.
        """
        address = _address(index, sub)
        if len(value) <= 4 and value and not segmented:
            command = (0x23 | (4 - len(value)) << 2) if sized else 0x22
            return self._done([command, *address, *value.ljust(4, b"\0")], 0x60, address)
        announced = len(value).to_bytes(4, "little") if sized else bytes(4)
        status = self._done([0x21 if sized else 0x20, *address, *announced], 0x60, address)
        toggle = 0
        while not status:
            segment, value = value[:7], value[7:]
            command = toggle | (7 - len(segment)) << 1 | (not value)
            status = self._done([command, *segment.ljust(7, b"\0")], 0x20 | toggle, [0, 0, 0])
            toggle ^= 0x10
            if not value:
                break
        return status

    def _done(self, request: Sequence[int], command: int, address: list[int]) -> int:
        answer = self._answer(request)
        if answer[0] == 0x80:
            return _abort_code(answer)
        self._expect(answer == bytes([command, *address, 0, 0, 0, 0]), f"command {command:02X}h and nothing else")
        return 0

    def _answer(self, request: Sequence[int]) -> bytes:
        answer = self.request(request)
        self._expect(answer is not None and len(answer) == 8, "an answer of 8 octets")
        assert answer
        return answer

    def _expect(self, holds: bool, what: str) -> None:
        if not holds:
            raise TesteeError(self._report(f"expected {what}", ""))

    # ---- looking inside ----------------------------------------------------------------------------------------------

    def dump(self, first: int = 0, last: int = 0xFFFF) -> dict[tuple[int, int], bytes | int]:
        """All entries of a range of indices by index and sub-index: octets, or an abort code."""
        entries: dict[tuple[int, int], bytes | int] = {}
        for _, line in self.do(f"DUMP {first:04X}-{last:04X}").events:
            _, address, *words = line.split(" ")
            index, sub = (int(part, 16) for part in address.split(":"))
            entries[index, sub] = int(words[1], 16) if words[:1] == ["ABORT"] else bytes.fromhex("".join(words))
        return entries

    def image(self) -> bytes:
        """The non-volatile memory."""
        return b"".join(bytes.fromhex("".join(line.split(" ")[2:])) for _, line in self.do("NVM").events)

    def set_image(self, address: int, octets: bytes) -> None:
        for offset in range(0, len(octets), 32):
            self.do(f"NVM set {address + offset:X} {octets[offset : offset + 32].hex(' ')}")


class InProcess(Driver):
    """A testee that runs in this process."""

    def __init__(self, answer: Callable[[str], list[str]], *, node_id: int = 0) -> None:
        super().__init__(node_id)
        self._ask_it = answer

    def _ask(self, text: str) -> list[str]:
        return self._ask_it(text)


class Testee(Driver):
    """A program that is a testee, running."""

    __test__ = False

    def __init__(self, command: Sequence[str], *, node_id: int = 0, serial: int = 0, time: int = 0) -> None:
        super().__init__(node_id)
        self._pending = b""
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  (closed with the testee)
        options = ["--node-id", str(node_id), "--serial", str(serial), "--time", f"{time:X}"]
        self._process = subprocess.Popen(
            [*command, *options], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, bufsize=0
        )

    def __enter__(self) -> Testee:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the program; sanitizers may complain only now."""
        if self._errors.closed:
            return
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.close()
        try:
            status = self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            status = self._process.wait()
        self._process.stdout.close()
        errors = self._complaints()
        self._errors.close()
        if status:
            raise TesteeError(self._report(f"the testee ended with status {status}", errors))

    def _ask(self, text: str) -> list[str]:
        assert self._process.stdin
        try:
            self._process.stdin.write(f"{text}\n".encode())
        except BrokenPipeError:
            self._fail("the testee died")
        lines: list[str] = []
        while not lines or not lines[-1].startswith(("NEXT ", "NACK ")):
            lines.append(self._read_line())
        return lines

    def _read_line(self) -> str:
        assert self._process.stdout
        while b"\n" not in self._pending:
            if not select.select([self._process.stdout], [], [], PATIENCE)[0]:
                self._process.kill()
                self._fail(f"the testee has not answered for {PATIENCE} s")
            octets = os.read(self._process.stdout.fileno(), 1 << 16)
            if not octets:
                self._fail("the testee died")
            self._pending += octets
        line, _, self._pending = self._pending.partition(b"\n")
        return line.decode("ascii")

    def _fail(self, what: str) -> None:
        self._process.wait(PATIENCE)
        raise TesteeError(self._report(f"{what}, status {self._process.returncode}", self._complaints()))

    def _complaints(self) -> str:
        self._errors.seek(0)
        return self._errors.read().decode(errors="replace")[:6000]


def _address(index: int, sub: int) -> list[int]:
    return [index & 0xFF, index >> 8, sub]


def _abort_code(frame: bytes) -> int:
    return int.from_bytes(frame[4:], "little")
