"""The emergency table of a device: what an EMCY frame means, and what to do about it (CiA 301, clause 7.2.7)."""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Literal


class ConditionInfo(Row):
    """A hardware condition or an event of the bus that raises emergencies; `scope` is axis or device."""

    name: str
    scope: str
    text: str = ""


class Emergency(Row):
    """A row of the emergency table.

    `bytes` are the five manufacturer bytes of the frame, where "axis" stands for the number of the axis. `register`
    names the bits of the error register 1001h that the row sets, `register_mask` is their value. `momentary` rows show
    in the register only while their frame is sent. `driver_flag` is the bit of the driver error flags (2102h) that is
    set while the condition holds, or 0. `axis` is set in what `EmergencyTable.find` returns.
    """

    name: str
    code: int
    title: str
    bytes: tuple[int | Literal["axis"], ...]
    register: tuple[str, ...]
    register_mask: int
    condition: str
    reaction: str
    momentary: bool
    driver_flag: int
    cause: str
    remedy: str
    source: str = ""
    axis: int | None = None

    @property
    def per_axis(self) -> bool:
        """True where a byte of the frame tells the axis."""
        return "axis" in self.bytes


class EmergencyTable:
    """All rows, in the order of the model."""

    def __init__(self, axis_count: int, rows: tuple[Emergency, ...]) -> None:
        self.axis_count = axis_count
        self.rows = rows

    def __iter__(self) -> Iterator[Emergency]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def find(self, code: int, additional: bytes) -> Emergency | None:
        """What a frame says: its error code and its bytes 3..7. None for what the table does not have.

        The row comes with the axis that the frame tells. Where two rows fit, the one that names no axis wins.
        A row for an axis also answers for the whole device (255 instead of an axis), as the message does that the last
        error of the device is over.
        """
        fitting = [row for row in self.of_code(code) if self._fits(row, additional)]
        if not fitting:
            return None
        row = min(fitting, key=lambda row: row.per_axis)
        axis = additional[row.bytes.index("axis")] if row.per_axis else _WHOLE_DEVICE
        return row if axis == _WHOLE_DEVICE else Emergency(**{**vars(row), "axis": axis})

    def of_code(self, code: int) -> tuple[Emergency, ...]:
        """All rows with an error code, whatever their additional bytes."""
        return tuple(row for row in self.rows if row.code == code)

    def _fits(self, row: Emergency, additional: bytes) -> bool:
        if len(additional) != len(row.bytes):
            return False
        axes = (*range(self.axis_count), _WHOLE_DEVICE)
        return all(
            actual in axes if expected == "axis" else actual == expected
            for expected, actual in zip(row.bytes, additional, strict=True)
        )


_WHOLE_DEVICE = 255
"""Stands in the axis byte of a message that concerns no single axis."""
