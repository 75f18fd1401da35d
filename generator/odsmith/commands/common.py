"""What the commands of a bus share: their options, the models they speak by, and errors as the user shall see them."""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from odsmith.errors import UsageError
from odsmith_runtime.io.can_link import BIT_RATES, LinkError, open_bus
from odsmith_runtime.io.control import CommandError
from odsmith_runtime.io.engine import EngineError
from odsmith_runtime.io.library import cache_folder
from odsmith_runtime.io.log import LogLineError
from odsmith_runtime.io.socketcand import DEFAULT_ADDRESS, parse_address
from odsmith_runtime.io.state_file import StateError
from odsmith_runtime.io.transport import BusTransport

if TYPE_CHECKING:
    from odsmith.compile import Compiled


# ---- options ---------------------------------------------------------------------------------------------------------


def add_interface(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--interface", metavar="NAME", help="a kind of bus that python-can knows: socketcan, pcan ...")
    parser.add_argument("--channel", metavar="NAME", help="which bus of this kind: can0, PCAN_USBBUS1 ...")
    parser.add_argument(
        "--bitrate", type=bit_rate, metavar="BIT/S", help="bit rate in bit/s, such as 500000, if the bus wants one"
    )


def add_bus(parser: argparse.ArgumentParser) -> None:
    """Where the bus is: a socketcand server, or what python-can knows."""
    parser.add_argument(
        "--connect", metavar="HOST:PORT", help=f"a server of socketcand's protocol (default: {DEFAULT_ADDRESS})"
    )
    add_interface(parser)


def node_id(word: str) -> int:
    if not word.isdecimal() or not 1 <= int(word) <= 127:
        raise argparse.ArgumentTypeError(f"a node-ID is 1 to 127, not {word}")
    return int(word)


def bit_rate(word: str) -> int:
    if not word.isdecimal() or int(word) not in BIT_RATES:
        raise argparse.ArgumentTypeError(f"in bit/s one of {', '.join(map(str, BIT_RATES))}, not {word}")
    return int(word)


def check_interface(options: argparse.Namespace) -> None:
    """What belongs to an interface is not passed over in silence. Raises UsageError."""
    if options.bitrate and not options.interface:
        raise UsageError("--bitrate without an --interface that has one", "such as --interface socketcan")


def factor(word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = 0.0
    if not 0.001 <= value <= 1000:
        raise argparse.ArgumentTypeError(f"0.001 to 1000, not {word}")
    return value


@contextmanager
def bus_of(options: argparse.Namespace) -> Iterator[BusTransport]:
    """The bus that the options name. Raises UsageError."""
    check_interface(options)
    with explained():
        if options.interface:
            if options.connect:
                raise UsageError("--connect and --interface are two buses", "name one of them")
            bus = open_bus(options.interface, options.channel, options.bitrate)
        else:
            host, port = parse_address(options.connect or DEFAULT_ADDRESS)
            probe(host, port)
            bus = open_bus("socketcand", options.channel or "can0", host=host, port=port)
        transport = BusTransport(bus)
        try:
            yield transport
        finally:
            transport.close()


def probe(host: str, port: int) -> None:
    """Whether somebody listens there: python-can would try for ten seconds. Raises UsageError."""
    import socket

    try:
        socket.create_connection((host, port), 3).close()
    except OSError as error:
        reason = error.strerror or str(error)
        raise UsageError(
            f"nobody answers at {host}:{port}: {reason}", "start a device there: odsmith simulate tmcm6212"
        ) from None


# ---- errors ----------------------------------------------------------------------------------------------------------


@contextmanager
def explained() -> Iterator[None]:
    """What goes wrong below becomes a UsageError with a hint."""
    try:
        yield
    except (EngineError, LinkError, StateError) as error:
        raise UsageError(str(error), error.hint) from None
    except (LogLineError, CommandError) as error:
        raise UsageError(str(error)) from None


# ---- models ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Loaded:
    """The package of a device, and the model that it was made of; without one it was installed."""

    package: ModuleType
    compiled: Compiled | None


def load(folder: Path, names: Sequence[str]) -> list[Loaded]:
    """The packages of devices: YAML files, devices of the project, installed packages, devices of the library.

    All devices of the project if there are no names. Raises UsageError and SpecError.
    """
    if not names:
        names = known_devices(folder)
    return [_load_one(folder, name) for name in dict.fromkeys(names)]


def known_devices(folder: Path) -> list[str]:
    """The devices of the project, else those that odsmith brings along."""
    from odsmith.project import packaged_names, roots

    if not (folder / "spec").is_dir():
        return packaged_names()
    return [root.name for root in roots(folder) if _is_device(root.path)]


def _is_device(file: Path) -> bool:
    return any(line.startswith(b"device:") for line in file.read_bytes().splitlines())


def _load_one(folder: Path, name: str) -> Loaded:
    from odsmith.project import known_hint, packaged_names, select

    is_own = name.endswith((".yaml", ".yml")) or (folder / "spec" / f"{name}.yaml").is_file()
    if not is_own and (installed := _installed(name)) is not None:
        return Loaded(installed, None)
    try:
        (root,) = select(folder, [name])
    except UsageError as error:
        raise UsageError(str(error), known_hint([*known_devices(folder), *packaged_names(), *_importable()])) from None
    return _generate(root.path)


def _installed(name: str) -> ModuleType | None:
    if not name.isidentifier():
        return None
    try:
        module = importlib.import_module(name)
    except ImportError:
        return None
    return module if hasattr(module, "__spec_digest__") and hasattr(module, "IDENTITY") else None


def _importable() -> list[str]:
    """The generated packages that Python finds, told by their files: to import everything would take its time."""
    found = []
    for module in pkgutil.iter_modules():
        folder = Path(getattr(module.module_finder, "path", "")) / module.name
        if module.ispkg and (folder / "identity.py").is_file():
            with suppress(OSError):
                if b"__spec_digest__" in (folder / "__init__.py").read_bytes():
                    found.append(module.name)
    return found


def specification(loaded: Loaded) -> Compiled:
    """What a package was made of: its model, or for an installed one the same that odsmith brings along.

    Raises UsageError if there is none, SpecError.
    """
    from odsmith.compile import compile_spec
    from odsmith.project import packaged_spec

    if loaded.compiled is not None:
        return loaded.compiled
    name = loaded.package.__name__
    path = packaged_spec(name)
    if path is None:
        raise UsageError(
            f"odsmith brings no specification of the installed {name} along", f"name yours: odsmith engine {name}.yaml"
        )
    compiled = compile_spec(path)
    if compiled.model.digest != loaded.package.__spec_digest__:
        raise UsageError(
            f"the installed {name} was made of another specification than the one that odsmith brings along",
            f"install both of one version, or name the other one: odsmith engine {name}.yaml",
        )
    return compiled


def _generate(path: Path) -> Loaded:
    """The package of a specification, generated into the cache and imported."""
    from odsmith.compile import compile_spec
    from odsmith.model import Device
    from odsmith.project import render_all
    from odsmith.render import write

    compiled = compile_spec(path)
    if not isinstance(compiled.model, Device):
        raise UsageError(f"`{path}` describes no device", "`odsmith list` names devices")
    identifier, digest = compiled.model.identity.identifier, compiled.model.digest
    outputs = render_all([compiled], ["python"])
    try:
        place = cache_folder() / "python" / f"{identifier}-{digest}"
        write(outputs, place)
    except (OSError, RuntimeError):  # no home, or one that cannot be written to
        place = Path(tempfile.mkdtemp(prefix="odsmith-"))
        write(outputs, place)
    loaded = sys.modules.get(identifier)
    if loaded is None or getattr(loaded, "__spec_digest__", "") != digest:
        for name in [name for name in sys.modules if name == identifier or name.startswith(f"{identifier}.")]:
            del sys.modules[name]
        sys.path.insert(0, str(place / identifier / "python"))
        importlib.invalidate_caches()
        loaded = importlib.import_module(identifier)
    return Loaded(loaded, compiled)
