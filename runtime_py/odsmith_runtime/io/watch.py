"""What changes on a virtual device, as lines for people who look at a pipe."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..emergencies import Emergency
    from .device import VirtualDevice
    from .view import DeviceView


class Watcher:
    """Tells what is different from the last time that somebody asked."""

    def __init__(self, device: VirtualDevice) -> None:
        self._device = device
        self._seen: DeviceView | None = None
        self._told = 0  # emergencies

    def changes(self) -> list[str]:
        """A line for each change of a state, a mode or the node-ID, and for each emergency; at first the NMT states."""
        view, before = self._device.view(), self._seen
        self._seen = view
        return [*self._of_node(view, before), *self._emergencies()]

    def _of_node(self, view: DeviceView, before: DeviceView | None) -> Iterator[str]:
        if before is None or (view.state, view.node_id) != (before.state, before.node_id):
            yield f"node {view.node_id}: {view.state}"
        for number, (axis, was) in enumerate(zip(view.axes, before.axes if before else (), strict=False)):
            if (axis.state, axis.mode) != (was.state, was.mode):
                yield f"node {view.node_id} axis {number}: {axis.state}, mode {axis.mode}"

    def _emergencies(self) -> Iterator[str]:
        with self._device.simulator.lock:
            total, kept = self._device.emergency_count, list(self._device.emergencies)
        for _, frame, row in kept[len(kept) - min(total - self._told, len(kept)) :]:
            yield f"node {frame.id & 0x7F}: EMCY {emergency_text(frame.data, row)}"
        self._told = total


def emergency_text(data: bytes, row: Emergency | None) -> str:
    """An emergency in a few words."""
    code = int.from_bytes(data[:2], "little")
    if row is None:
        return f"{code:04X}h"
    return f"{code:04X}h {row.title}" + ("" if row.axis is None else f", axis {row.axis}")
