"""What the generated classes add: names and types, without a cost for who wants no client."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

from odsmith.backends.python.client import AXIS_NAMES, DRIVE_NAMES
from odsmith_runtime.client import AsyncAxis, AsyncDrive, Axis, Drive


def public(*classes: type) -> set[str]:
    return {name for found in classes for name in dir(found) if not name.startswith("_")}


def test_the_generator_knows_what_a_client_can_do() -> None:
    assert public(Axis) == public(AsyncAxis) == AXIS_NAMES
    assert public(Drive, AsyncDrive) | {"axes", "objects"} == DRIVE_NAMES


def test_both_faces_have_the_same_names_and_words() -> None:
    for blocking, asynchronous in ((Axis, AsyncAxis), (Drive, AsyncDrive)):
        for name in public(blocking):
            assert getattr(asynchronous, name).__doc__ == getattr(blocking, name).__doc__, name


def test_a_hidden_object_is_still_there(package: ModuleType) -> None:
    from odsmith_runtime.client.virtual import VirtualNetwork

    network = VirtualNetwork(package)
    drive = package.TMCM6212(network, waiter=network.waiter())
    assert callable(drive.store)
    assert drive.objects.store.save.raw == 1


def loaded(root: Path, code: str, *flags: str) -> str:
    folders = [str(root / "runtime_py"), *(str(root / "generated" / name / "python") for name in ("cia", "tmcm6212"))]
    script = f"import sys\nsys.path[:0] = {folders!r}\n{code}"
    run = subprocess.run([sys.executable, *flags, "-c", script], capture_output=True, text=True, check=False)
    return run.stdout + run.stderr


def test_the_package_loads_no_client(root: Path) -> None:
    code = 'import tmcm6212; tmcm6212.DICTIONARY; print("canopen" in sys.modules, "tmcm6212.client" in sys.modules)'
    assert loaded(root, code) == "False False\n"


def test_the_class_alone_loads_no_canopen(root: Path) -> None:
    assert loaded(root, 'from tmcm6212 import TMCM6212; print("canopen" in sys.modules)') == "False\n"


def test_without_canopen_it_says_what_to_install(root: Path) -> None:
    code = 'from tmcm6212 import TMCM6212; TMCM6212.connect(interface="virtual", channel="0")'
    said = loaded(root, code, "-I", "-S").splitlines()[-1]
    assert said.endswith("MissingPackageError: the client stands on python-canopen: pip install 'odsmith[client]'")
