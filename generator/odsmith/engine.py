"""Compiling the C engine of a device: the C runtime, its tables and the simulation as one shared library.

The library goes into the user's cache, where a virtual device finds it. It is compiled anew when any source differs
from those that it was made of.
"""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from odsmith.compile import Compiled
from odsmith.errors import UsageError
from odsmith.model import Device
from odsmith.render import Output

SOURCES = ("src/", "device/", "port/simulation/", "port/engine/")
HEADERS = ("include", "device", "port/simulation", "port/engine")
OPTIONS = ("-std=c99", "-O2", "-fPIC", "-shared")


def compiler() -> str | None:
    """The C compiler: what CC names, or cc, gcc or clang; None if there is none."""
    wanted = shlex.split(os.environ.get("CC", ""))[:1]
    return next((path for name in (*wanted, "cc", "gcc", "clang") if (path := shutil.which(name))), None)


def build(compiled: Compiled, *, force: bool = False, announce: Callable[[], None] = lambda: None) -> Path:
    """The library of a device, compiled if there is none of these sources; `announce` is called before it takes time.

    Raises UsageError if there is no compiler or it refuses, OSError if the cache cannot be written.
    """
    from odsmith.export_c import project
    from odsmith_runtime.io.library import library_path

    if not isinstance(compiled.model, Device):
        raise UsageError(f"`{compiled.model.identifier}` is no device but a vocabulary")
    device = compiled.model
    outputs = [output for output in project(compiled) if output.path.endswith((".c", ".h"))]
    digest = hashlib.sha256(b"".join(part for item in outputs for part in (item.path.encode(), item.content)))
    path = library_path(device.identity.identifier, device.digest)
    stamp = path.with_suffix(".sources")
    if not force and path.is_file() and stamp.is_file() and stamp.read_text() == digest.hexdigest():
        return path
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    announce()
    _compile(outputs, path)
    stamp.write_text(digest.hexdigest())
    return path


def _compile(outputs: Sequence[Output], path: Path) -> None:
    program = compiler()
    if program is None:
        raise UsageError(
            "the C engine needs a C compiler", "install one (Debian: apt-get install gcc), or use Python's"
        )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for output in outputs:
            (folder / output.path).parent.mkdir(parents=True, exist_ok=True)
            (folder / output.path).write_bytes(output.content)
        sources = [item.path for item in outputs if item.path.endswith(".c") and item.path.startswith(SOURCES)]
        made = path.with_suffix(f".{os.getpid()}")  # in the same folder, so that it takes its place in one step
        command = [program, *OPTIONS, *(f"-I{header}" for header in HEADERS), *sources, "-o", str(made)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            made.unlink(missing_ok=True)
            raise UsageError(f"{program} does not compile the C engine:\n{done.stderr.strip()[-2000:]}")
        made.replace(path)
