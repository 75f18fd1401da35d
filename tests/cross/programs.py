"""The Python testee as a program of its own, for those who talk to testees of any language."""

from __future__ import annotations

import sys
from pathlib import Path

from odsmith.backends.python import PythonBackend
from odsmith.model import Device
from odsmith.render import write

PROGRAM = Path(__file__).parent / "testee.py"


def write_python_testee(device: Device, folder: Path) -> Path:
    """A script that runs `testee.py` on the device's generated package, made in `folder` unless it is there."""
    name = device.identity.identifier
    script = folder / f"testee-{name}"
    if script.exists():
        return script
    write(PythonBackend().render(device), folder)
    script.write_text(f'#!/bin/sh\nPYTHONPATH={folder / name / "python"} exec {sys.executable} {PROGRAM} {name} "$@"\n')
    script.chmod(0o755)
    return script
