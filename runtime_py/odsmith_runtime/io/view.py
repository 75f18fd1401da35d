"""What is to be seen of a virtual device: its state in numbers and words, read without a bus."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from types import ModuleType

    from ..entries import Entry
    from .engine import Engine

_LEDS = {(0, 0): "off", (1, 0): "green", (0, 1): "red", (1, 1): "green red"}


class AxisView(NamedTuple):
    """An axis: its PDS state and mode by title, numbers as the objects hold them, the shaft in microsteps."""

    state: str
    mode: str
    position: int
    velocity: int
    load: int
    shaft: int


class DeviceView(NamedTuple):
    """`leds` are those that are lit now; `state` is the NMT state by title."""

    node_id: int
    bit_rate: int
    is_on: bool
    state: str
    leds: str
    outputs: int
    axes: tuple[AxisView, ...]


class Viewer:
    """Looks at a device through its model."""

    def __init__(self, package: ModuleType, engine: Engine) -> None:
        self._package = package
        self._engine = engine
        self._modes = getattr(package, "MODES", {})
        self._machine = getattr(package, "STATE_MACHINE", None)
        self._entries = [self._of_axis(axis) for axis in range(package.IDENTITY.axes)]

    def look(self) -> DeviceView:
        engine, outputs = self._engine, self._engine.outputs
        states = self._package.NMT_STATES
        return DeviceView(
            node_id=engine.node_id,
            bit_rate=engine.bit_rate,
            is_on=engine.is_on,
            state=states[engine.nmt_code].title if engine.is_on else "no power",
            leds=_LEDS[bool(outputs.run_led), bool(outputs.error_led)],
            outputs=outputs.digital,
            axes=tuple(self._axis(axis) for axis in range(len(self._entries))),
        )

    def _of_axis(self, axis: int) -> dict[str, Entry[int]]:
        """The entries that show something, by their role."""
        wanted = (
            *("statusword", "modes_of_operation_display", "position_actual_value"),
            *("velocity_actual_value", "actual_load_value"),
        )
        dictionary = self._package.DICTIONARY
        found = {}
        for base_index, row in dictionary.object_rows.items():
            if row[4]:  # it repeats for each axis
                for entry in dictionary.at(base_index, axis):
                    if entry.role in wanted:
                        found[entry.role] = entry
        return found

    def _axis(self, axis: int) -> AxisView:
        value = {role: self._read(entry) for role, entry in self._entries[axis].items()}
        state = self._machine.decode(value.get("statusword", 0)) if self._machine else None
        mode = self._modes.get(value.get("modes_of_operation_display", 0))
        return AxisView(
            state=state.title if state and self._engine.is_on else "-",
            mode=mode.short if mode else "-",
            position=value.get("position_actual_value", 0),
            velocity=value.get("velocity_actual_value", 0),
            load=value.get("actual_load_value", 0),
            shaft=self._engine.shaft(axis),
        )

    def _read(self, entry: Entry[int]) -> int:
        octets = self._engine.read(entry.index, entry.sub)
        return int(entry.decode(octets)) if isinstance(octets, bytes) else 0
