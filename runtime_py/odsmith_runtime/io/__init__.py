"""A virtual device: the device runtime with a clock, simulated motors, and a bus that real programs talk to.

    import tmcm6212
    from odsmith_runtime.io import VirtualDevice

    with VirtualDevice(tmcm6212, node_id=1, listen="127.0.0.1:29536"):
        ...  # any program on this machine: python-can's interface "socketcand"

Everything below the sockets is sans-I/O: an `Engine` is one device, a `Wire` is the bus between several, both driven by
a time that somebody tells them. A `Simulator` is that somebody: it owns the clock and the thread.
"""

from __future__ import annotations

from .. import load_on_use

TYPE_CHECKING = False
if TYPE_CHECKING:
    from .control import CommandError as CommandError
    from .device import VirtualDevice as VirtualDevice
    from .engine import Engine as Engine
    from .engine import EngineError as EngineError
    from .simulator import Simulator as Simulator
    from .state_file import StateError as StateError
    from .wire import Wire as Wire
else:
    __getattr__, __dir__, __all__ = load_on_use(
        __name__,
        {
            "control": ("CommandError",),
            "device": ("VirtualDevice",),
            "engine": ("Engine", "EngineError"),
            "simulator": ("Simulator",),
            "state_file": ("StateError",),
            "wire": ("Wire",),
        },
    )
