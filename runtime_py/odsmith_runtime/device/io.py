"""Inputs and outputs of the whole module; the twin of `ods_io.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from odsmith_cia.words import Condition

from .port import Input, Output

if TYPE_CHECKING:
    from ..identity import Identity
    from .node import Node

_FIRST_BIT = 16  # INn and OUTn are bit 16 + n of their objects
_ANALOG_CHANNELS = 8


class Io:
    """Inputs as they are, which a tick samples, and outputs as they were last told."""

    def __init__(self, node: Node, identity: Identity) -> None:
        self._node = node
        self._input_lines = (1 << identity.digital_inputs) - 1
        self._output_lines = (1 << identity.digital_outputs) - 1
        self._analog_inputs = min(identity.analog_inputs, _ANALOG_CHANNELS)
        self._analog_outputs = min(identity.analog_outputs, _ANALOG_CHANNELS)
        self.address = 0
        self.enable = True
        self.digital = 0
        self.analog = [0] * _ANALOG_CHANNELS
        self._masked = 0  # of outputs with a mask: the state that is kept while the mask leaves one out
        self._told_digital = 0
        self._told_analog = [0] * _ANALOG_CHANNELS

    def reset(self) -> None:
        """As at power-on: no output is set."""
        self._masked = 0

    def set(self, input: Input, channel: int, value: int) -> None:
        """An input has a new value."""
        match input:
            case Input.ADDRESS:
                self.address = value if value <= 0xFF else 0
            case Input.ENABLE:
                self.enable = value != 0
            case Input.DIGITAL:
                self.digital = value & self._input_lines
            case Input.ANALOG:
                if channel < self._analog_inputs:
                    self.analog[channel] = min(value, 0xFFFF)

    def tick(self) -> None:
        """Sample the inputs."""
        values = self._node.values
        before = (values.general_inputs, *values.input_blocks, *values.analog_inputs)
        values.general_inputs = self.digital << _FIRST_BIT & 0xFFFFFFFF
        values.input_blocks[:] = [self.digital >> 8 * n & 0xFF for n in range(len(values.input_blocks))]
        values.analog_inputs[:] = self.analog
        values.analog_input_values[:] = [_signed_16(value) for value in self.analog]
        if before != (values.general_inputs, *values.input_blocks, *values.analog_inputs):
            self._node.value_changed(self._node.od.instances[0])
        self._node.emcy.set(Condition.SHUTDOWN_SWITCH, not self.enable)

    def put(self, *, all: bool) -> None:
        """Tell the port the outputs that have changed; at power-on all of them."""
        port, values = self._node.port, self._node.values
        outputs = self._digital_outputs()
        if all or outputs != self._told_digital:
            self._told_digital = outputs
            port.output(Output.DIGITAL, 0, outputs)
        for channel in range(self._analog_outputs):
            value = values.analog_output_values[channel]
            if all or value != self._told_analog[channel]:
                self._told_analog[channel] = value
                port.output(Output.ANALOG, channel, value & 0xFFFF)

    def _digital_outputs(self) -> int:
        """Outputs with a mask (2703h, 3003h): those that it includes follow, the others stay.

        Outputs in blocks of eight (CiA 401) have none. What a device lacks is 0.
        """
        values = self._node.values
        mask: int = values.output_mask >> _FIRST_BIT
        self._masked = self._masked & ~mask | values.digital_outputs >> _FIRST_BIT & mask
        blocks: int = sum(block << 8 * n for n, block in enumerate(values.output_blocks))
        outputs: int = (self._masked | blocks) & self._output_lines & ~self._brakes()
        return outputs

    def _brakes(self) -> int:
        """Outputs that feed brakes: OUTn that of axis n, while it is controlled automatically (200Ch)."""
        return sum(1 << axis.number for axis in self._node.axes if axis.motor.has_brake)


def _signed_16(value: int) -> int:
    return (value & 0x7FFF) - (value & 0x8000)
