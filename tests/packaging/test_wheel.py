"""The wheel is complete: an installed odsmith builds the same bytes as the checkout, and its client side is light."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import pytest

from odsmith.compile import compile_spec
from odsmith.export_c import project

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"  # a copy, so that no build folder appears in the checkout
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", root, source], check=True)
    _overlay_working_tree(root, source)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w", folder, source],
        check=True,
    )
    return next(folder.glob("odsmith-*.whl"))


def _overlay_working_tree(root: Path, source: Path) -> None:
    """Make the clone equal the working tree, uncommitted files included."""
    listed = subprocess.run(
        ["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    for name in filter(None, listed.split("\0")):
        if (root / name).is_file():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            (source / name).write_bytes((root / name).read_bytes())
        else:
            (source / name).unlink(missing_ok=True)


def _environment(folder: Path, wheel: Path, *requirements: str) -> Path:
    """A new environment with the wheel and nothing else but `requirements`, taken from the running one."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    python = folder / "bin" / "python"
    subprocess.run(
        [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", "--no-index", wheel],
        check=True,
    )
    site = next((folder / "lib").glob("python*/site-packages"))
    for name in _closure(requirements):
        distribution = metadata.distribution(name)
        for top in {Path(file).parts[0] for file in distribution.files or () if ".." not in Path(file).parts}:
            target = Path(str(distribution.locate_file(top)))
            if target.exists() and not (site / top).exists():
                (site / top).symlink_to(target)
    return python


def _closure(requirements: tuple[str, ...]) -> set[str]:
    found: set[str] = set()
    waiting = list(requirements)
    while waiting:
        name = re.split(r"[^A-Za-z0-9._-]", waiting.pop())[0]
        if name in found:
            continue
        found.add(name)
        waiting += [text for text in metadata.requires(name) or () if "extra ==" not in text and ";" not in text]
    return found


def _run(python: Path, *arguments: str | Path, cwd: Path, fine: bool = True) -> subprocess.CompletedProcess[str]:
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    result = subprocess.run([python, *arguments], cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert not fine or result.returncode == 0, result.stderr
    return result


def test_an_installed_wheel_builds_the_bytes_of_the_checkout(root: Path, wheel: Path, tmp_path: Path) -> None:
    python = _environment(tmp_path / "env", wheel, "jinja2", "jsonschema-rs", "pyyaml", "rich")
    _run(python, "-m", "odsmith.cli", "build", "cia", "tmcm3230", "tmcm6212", "--out", tmp_path / "out", cwd=tmp_path)
    for device in ("cia", "tmcm3230", "tmcm6212"):
        built = {
            path.relative_to(tmp_path / "out"): path.read_bytes()
            for path in (tmp_path / "out" / device).rglob("*")
            if path.is_file()
        }
        assert len(built) > 5
        for path, content in built.items():
            assert content == (root / "generated" / path).read_bytes(), path


def test_an_installed_wheel_exports_a_project(
    root: Path, wheel: Path, tool: Callable[[str], str], tmp_path: Path
) -> None:
    """The same bytes as the checkout exports, which build with CMake and without it."""
    python = _environment(tmp_path / "env", wheel, "jinja2", "jsonschema-rs", "pyyaml", "rich")
    _run(python, "-m", "odsmith.cli", "export-c", "node", "tmcm6212", cwd=tmp_path)
    node = tmp_path / "node"
    exported = {path.relative_to(node).as_posix(): path.read_bytes() for path in node.rglob("*") if path.is_file()}
    compiled = compile_spec(root / "spec" / "tmcm6212.yaml")
    assert exported == {output.path: output.content for output in project(compiled)}

    compiler = tool("cc")
    sources = [path for folder in ("src", "device", "port/host") for path in sorted((node / folder).glob("*.c"))]
    subprocess.run(
        [compiler, "-std=c99", "-Wall", "-Wextra", "-Werror", "-Iinclude", "-Idevice", *sources, "-o", "plain"],
        cwd=node,
        check=True,
    )
    assert _boots(node / "plain")
    cmake = tool("cmake")
    subprocess.run([cmake, "-B", "build", "-DCMAKE_C_FLAGS=-Werror"], cwd=node, check=True, capture_output=True)
    subprocess.run([cmake, "--build", "build"], cwd=node, check=True, capture_output=True)
    assert _boots(node / "build" / "tmcm6212_host")


def _boots(program: Path) -> bool:
    done = subprocess.run([program], input="601#4000100000000000\n", capture_output=True, text=True, check=True)
    return [line.split()[-1] for line in done.stdout.splitlines()] == ["701#00", "581#430010009201FCFF"]


def test_the_packaged_library_serves_includes(root: Path, wheel: Path, tmp_path: Path) -> None:
    python = _environment(tmp_path / "env", wheel, "jinja2", "jsonschema-rs", "pyyaml", "rich")
    (tmp_path / "my_drive.yaml").write_bytes((root / "tests" / "golden" / "toy.yaml").read_bytes())
    _run(python, "-m", "odsmith.cli", "build", "my_drive.yaml", "--out", "build", cwd=tmp_path)
    assert (tmp_path / "build" / "toy" / "eds" / "TOY-2.eds").is_file()


def test_the_client_side_needs_nothing_else(root: Path, wheel: Path, tmp_path: Path) -> None:
    python = _environment(tmp_path / "env", wheel)
    package = root / "generated" / "tmcm3230" / "python"
    program = (
        f"import sys; sys.path.insert(0, {str(package)!r}); import tmcm3230; print(tmcm3230.HomingMethod.__name__)"
    )
    assert _run(python, "-c", program, cwd=tmp_path).stdout == "HomingMethod\n"
    refused = _run(python, "-m", "odsmith.cli", "build", "tmcm3230", cwd=tmp_path, fine=False)
    assert refused.returncode == 2
    assert "pip install 'odsmith[generator]'" in refused.stderr
    assert "Traceback" not in refused.stderr


def test_the_wheel_has_no_file_too_many(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert not [name for name in names if "__pycache__" in name or name.endswith((".pyc", ".egg-info", ".keep"))]
    for needed in (
        "odsmith/py.typed",
        "odsmith_cia/py.typed",
        "odsmith_runtime/py.typed",
        "odsmith/runtime_c/README.md",
        "odsmith/runtime_c/include/ods/node.h",
        "odsmith/spec/schema.json",
        "odsmith/spec/trinamic/motor.yaml",
    ):
        assert needed in names
    assert any(name.startswith("odsmith/templates/c/") for name in names)


def test_a_device_package_is_a_distribution_of_its_own(root: Path, wheel: Path, tmp_path: Path) -> None:
    source = tmp_path / "source"
    shutil.copytree(root / "generated" / "tmcm3230" / "python", source)
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w", tmp_path, source],
        check=True,
    )
    python = _environment(tmp_path / "env", wheel)
    package = next(tmp_path.glob("tmcm3230-*.whl"))
    subprocess.run(
        [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", "--no-index", package],
        check=True,
    )
    program = "import tmcm3230; print(tmcm3230.__spec_version__, tmcm3230.DICTIONARY['Controlword 2'].index)"
    version = package.name.split("-")[1]
    assert _run(python, "-c", program, cwd=tmp_path).stdout == f"{version} {0x6840}\n"

    typed = tmp_path / "typed.py"  # without py.typed, both would be unknown to type checkers
    typed.write_text(
        "from typing import assert_type\n"
        "from odsmith_runtime.client import Value\n"
        "from tmcm3230 import TMCM3230\n"
        "def program(drive: TMCM3230) -> None:\n"
        "    assert_type(drive.axes[0].homing_speeds.fast, Value[int])\n"
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "", "--cache-dir", str(tmp_path / "cache")]
    checked = subprocess.run(
        [*command, "--python-executable", str(python), str(typed)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
