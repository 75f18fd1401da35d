"""What virtual devices do, in a terminal, and keys that do something to them."""

from __future__ import annotations

import threading
from collections import deque

from rich.console import Group
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from odsmith.commands.keys import keys
from odsmith_runtime.io.control import CommandError
from odsmith_runtime.io.device import VirtualDevice
from odsmith_runtime.io.simulator import Simulator
from odsmith_runtime.io.view import DeviceView
from odsmith_runtime.io.watch import emergency_text

_LOOK_S = 0.1
_LINES = 5
_FRAME_LINES = 3  # of a panel, beside those of its axes
_HELP = (
    "0-9 axis   n node   l r h switches   s stall   t too hot   e enable input   x lose a frame   d delay   p power   "
    "q quit"
)
_TOGGLED = {
    "l": "axis{axis} left",
    "r": "axis{axis} right",
    "h": "axis{axis} home",
    "s": "axis{axis} stall",
    "t": "axis{axis} overtemperature",
}
_MODULE = {"e": ("enable off", "enable on"), "d": ("delay 50", "delay 0"), "p": ("power off", "power on")}


class Desk:
    """Whoever sits at the keyboard: the node and axis that keys are for, and what has been pressed."""

    def __init__(self, devices: list[VirtualDevice]) -> None:
        self.devices = devices
        self.chosen = 0
        self.axis = 0
        self.lines: deque[str] = deque(maxlen=_LINES)
        self._held: set[tuple[int, str]] = set()

    @property
    def device(self) -> VirtualDevice:
        return self.devices[self.chosen]

    def press(self, key: str) -> bool:
        """Obey a key. Returns False for the one that ends."""
        if key in ("q", "\x03", "\x04"):
            return False
        if key == "n":
            self.chosen = (self.chosen + 1) % len(self.devices)
            self.axis = 0
        elif key.isdecimal() and key.isascii() and int(key) < self.device.axis_count:
            self.axis = int(key)
        elif key == "x":
            self._do("lose 1")
        elif key in _TOGGLED and self.device.axis_count:
            command = _TOGGLED[key].format(axis=self.axis)
            self._do(f"{command} {'on' if self._toggle(command) else 'off'}")
        elif key in _MODULE:
            self._do(_MODULE[key][0 if self._toggle(key) else 1])
        return True

    def _toggle(self, what: str) -> bool:
        """Whether it holds now, after it did not, or the other way round."""
        self._held ^= {(self.chosen, what)}
        return (self.chosen, what) in self._held

    def _do(self, command: str) -> None:
        try:
            self.device.inject(command)
            self.lines.append(f"node {self.device.node_id}: {command}")
        except CommandError as error:
            self.lines.append(str(error))


def show(simulator: Simulator, devices: list[VirtualDevice], places: list[str], stopped: threading.Event) -> None:
    """Show them until somebody ends it."""
    desk = Desk(devices)
    simulator.log = desk.lines.append
    with keys() as pressed, Live(auto_refresh=False, screen=True) as live:
        while not stopped.wait(_LOOK_S):
            if not all(desk.press(key) for key in pressed()):
                return
            live.update(picture(simulator, desk, places, live.console.height), refresh=True)


def picture(simulator: Simulator, desk: Desk, places: list[str], height: int) -> Group:
    """Everything that is to be seen now. Where the lines are too few, nodes but the chosen one are a line each."""
    late = f", {simulator.given_up_us / 1_000_000:.1f} s too slow" if simulator.given_up_us else ""
    first = desk.devices[0]
    title = f"{first.identity.name} on {', '.join(places)}   engine {first.engine.name}   "
    heading = Text(f"{title}{simulator.wire.now / 1_000_000:.1f} s{late}", style="bold")
    room = height - 2 - _LINES
    short = sum(device.axis_count + _FRAME_LINES for device in desk.devices) > room
    devices = [
        _device(device, desk.axis if device is desk.device else None)
        if device is desk.device or not short
        else Text(f"  {_title(device, device.view())}", no_wrap=True, overflow="ellipsis")
        for device in desk.devices
    ]
    return Group(heading, *devices, *(Text(line) for line in desk.lines), Text(_HELP, style="dim"))


def _title(device: VirtualDevice, view: DeviceView) -> str:
    last = device.emergencies[-1] if device.emergencies else None
    emergency = f"   last EMCY {emergency_text(last[1].data, last[2])}" if last else ""
    return f"node {view.node_id}   {view.state}   LEDs {view.leds}   {view.bit_rate} kbit/s{emergency}"


def _device(device: VirtualDevice, chosen: int | None) -> Panel:
    view = device.view()
    table = Table(box=None, expand=True)
    for name in ("axis", "state", "mode", "position", "velocity", "load", "shaft"):
        table.add_column(name, justify="left" if name in ("axis", "state", "mode") else "right")
    for number, axis in enumerate(view.axes):
        style = "reverse" if number == chosen else "red" if "ault" in axis.state else ""
        numbers = (axis.position, axis.velocity, axis.load, axis.shaft)
        table.add_row(str(number), axis.state, axis.mode, *map(str, numbers), style=style)
    return Panel(
        table, title=Text(_title(device, view)), title_align="left", border_style="" if chosen is None else "cyan"
    )
