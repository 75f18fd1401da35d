"""The engine in Python: the device runtime, with a simulation of each axis behind its port."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..device.node import Config, Node
from ..device.port import Frame, Input, MotorAnswer, MotorDemand, Output, Port
from ..device.simulation import Simulation
from ..device.tables import Tables
from ..device.timing import MASK
from .engine import LONGEST_STEP_US, Outputs, Sent

if TYPE_CHECKING:
    from types import ModuleType

    from odsmith_cia.codes import AbortCode

    from ..device.port import Can

_BLANK = 0xFF  # an octet of memory that was never written
_ANALOG_OUTPUTS = 8


class PythonEngine(Port):
    name = "python"

    def __init__(self, package: ModuleType, *, node_id: int, serial_number: int = 0) -> None:
        self._tables = Tables.of(package)
        self._config = Config(serial_number=serial_number, node_id=node_id)
        self._node = Node(self._tables, self, self._config)
        self._simulations = [Simulation() for _ in self._node.axes]
        self._memory = bytearray([_BLANK] * self._node.store.size)
        self._inputs: dict[tuple[Input, int], int] = {}  # as hands left them, whatever the power does
        self._sent: list[Sent] = []
        self._now = 0  # all 64 bits of the node's time
        self.is_on = False
        self.bit_rate = 0
        self.memory_writes = 0
        self.outputs = self._dark()

    def _dark(self) -> Outputs:
        axes = len(self._simulations)
        return Outputs(0, 0, 0, [0] * _ANALOG_OUTPUTS, [0] * axes, [0] * axes, [0] * axes, [0] * axes)

    # ---- what is known of it -----------------------------------------------------------------------------------------

    @property
    def node_id(self) -> int:
        return self._node.id

    @property
    def nmt_code(self) -> int:
        return int(self._node.nmt.code)

    @property
    def memory(self) -> bytes:
        return bytes(self._memory)

    def load_memory(self, image: bytes) -> None:
        if len(image) != len(self._memory):
            raise ValueError(f"an image of {len(image)} octets, not {len(self._memory)}")
        self._memory[:] = image

    def shaft(self, axis: int) -> int:
        return self._simulations[axis].shaft

    def read(self, index: int, sub: int) -> bytes | AbortCode:
        return self._node.read(index, sub)

    # ---- events ------------------------------------------------------------------------------------------------------

    def power_on(self, now: int) -> None:
        self._node = Node(self._tables, self, self._config)
        self._now = now
        self.is_on = True
        self.outputs = self._dark()
        for (input, channel), value in self._inputs.items():
            self._node.input(now, input, channel, value)
        for axis, simulation in enumerate(self._simulations):
            simulation.power_on()
            self._node.motor(now & MASK, axis, simulation.answer)
        self._node.power_on(now & MASK)

    def power_off(self) -> None:
        self.is_on = False
        self.outputs = self._dark()

    def receive(self, now: int, frame: Frame) -> None:
        if self.is_on:
            self._node.receive(self._reach(now), frame)

    def advance(self, now: int) -> None:
        if self.is_on:
            self._node.advance(self._reach(now))

    def next(self) -> int | None:
        at = self._node.next() if self.is_on else None
        return None if at is None else self._absolute(at)

    @property
    def has_sent(self) -> bool:
        return bool(self._sent)

    def take(self) -> list[Sent]:
        sent, self._sent = self._sent, []
        return sent

    def input(self, now: int, input: Input, channel: int, value: int) -> None:
        self._inputs[input, channel] = value
        if self.is_on:
            self._node.input(self._reach(now), input, channel, value)

    def fault(self, now: int, axis: int, condition: str, holds: bool) -> None:
        if self.is_on:
            self._node.fault(self._reach(now), axis, condition, holds)

    def set_hardware(self, now: int, axis: int, name: str, value: int) -> None:
        if self.is_on:
            self.advance(now)
        self._simulations[axis].set(name, value)
        if self.is_on:
            self._node.motor(now & MASK, axis, self._simulations[axis].answer)

    def report_can(self, now: int, event: Can) -> None:
        if self.is_on:
            self._node.report_can(self._reach(now), event)

    # ---- time --------------------------------------------------------------------------------------------------------

    def _reach(self, now: int) -> int:
        """Let time pass in steps that the node can tell apart; gives what it sees of this instant."""
        while now - self._now > LONGEST_STEP_US:
            self._now += LONGEST_STEP_US
            self._node.advance(self._now & MASK)
        self._now = max(now, self._now)
        return self._now & MASK

    def _absolute(self, at: int) -> int:
        """All 64 bits of an instant that is less than 2^31 us from now."""
        distance = (at - self._now) & MASK
        return self._now + distance - (distance >> 31 << 32)

    # ---- the port ----------------------------------------------------------------------------------------------------

    def send(self, frame: Frame) -> None:
        self._sent.append(Sent(self._absolute(self._node.timers.now), frame))

    def output(self, output: Output, channel: int, value: int) -> None:
        outputs = self.outputs
        match output:
            case Output.RUN_LED:
                outputs.run_led = value
            case Output.ERROR_LED:
                outputs.error_led = value
            case Output.DIGITAL:
                outputs.digital = value
            case Output.ANALOG:
                outputs.analog[channel] = value
            case Output.POWER:
                outputs.power[channel] = value
            case Output.BRAKE:
                outputs.brake[channel] = value
            case Output.CURRENT:
                outputs.current[channel] = value
            case Output.DRIVER:
                outputs.driver[channel] = value
        if output >= Output.POWER:
            self._simulations[channel].output(output, value)

    def bus(self, bit_rate: int, node_id: int) -> None:
        self.bit_rate = bit_rate

    def nvm_read(self, address: int) -> int:
        return self._memory[address]

    def nvm_write(self, address: int, octet: int) -> None:
        self._memory[address] = octet
        self.memory_writes += 1

    def motor(self, axis: int, demand: MotorDemand, answer: MotorAnswer) -> MotorAnswer:
        return self._simulations[axis].motor(demand)
