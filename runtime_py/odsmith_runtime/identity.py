"""The name plate of a device: who made it, how fast its bus may be, how much of everything it has."""

from __future__ import annotations

from .rows import Row


class Identity(Row):
    """What the identity object (1018h) says of every such device, and how many channels and axes there are.

    `bit_rates` in kbit/s, ascending. The serial number is missing: each single device has its own.
    """

    name: str
    title: str
    vendor_id: int
    product_code: int
    revision_number: int
    bit_rates: tuple[int, ...]
    digital_inputs: int
    digital_outputs: int
    analog_inputs: int
    analog_outputs: int
    axes: int
