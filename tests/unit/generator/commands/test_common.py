"""Where the models of the commands come from, and how they start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from tests.unit.runtime_py.io.conftest import generated

from odsmith.cli import BUS_COMMANDS
from odsmith.commands.common import Loaded, known_devices, load, specification
from odsmith.errors import UsageError


def test_devices_of_the_project_and_of_the_library(root: Path, tmp_path: Path) -> None:
    assert known_devices(root) == known_devices(tmp_path) == ["tmcm3230", "tmcm6212"]


def test_a_device_is_generated_from_its_specification(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(str(tmp_path))
    (loaded,) = load(root, ["spec/examples/io_module.yaml"])
    assert loaded.package.IDENTITY.axes == 0
    assert loaded.compiled is not None
    (again,) = load(root, ["spec/examples/io_module.yaml"])
    assert again.package is loaded.package


def test_an_installed_package_will_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_drive.py").write_text("IDENTITY = 1\n__spec_digest__ = 'x'\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    (loaded,) = load(tmp_path, ["my_drive"])
    assert (loaded.package.__name__, loaded.compiled) == ("my_drive", None)


def test_an_unknown_device_is_answered_with_those_that_can_be_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, content in (("my_drive", "__spec_digest__ = 'x'"), ("other", "")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(content)
        (tmp_path / name / "identity.py").touch()
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(UsageError, match="there is no device `tmcm9999`") as raised:
        load(tmp_path, ["tmcm9999"])
    known = raised.value.hint.removeprefix("known: ").removesuffix("; or name a YAML file").split(", ")
    assert known[:2] == ["tmcm3230", "tmcm6212"]
    assert "my_drive" in known
    assert "other" not in known


def test_the_specification_of_an_installed_package() -> None:
    """It is the one that odsmith brings along, if it is the same."""
    package = ModuleType("tmcm6212")
    package.__dict__["__spec_digest__"] = "0"
    with pytest.raises(UsageError, match="the installed tmcm6212 was made of another specification") as raised:
        specification(Loaded(package, None))
    assert "odsmith engine tmcm6212.yaml" in raised.value.hint
    package.__dict__["__spec_digest__"] = generated("tmcm6212").__spec_digest__
    assert specification(Loaded(package, None)).model.identifier == "tmcm6212"
    with pytest.raises(UsageError, match="no specification of the installed my_drive") as raised:
        specification(Loaded(ModuleType("my_drive"), None))
    assert "odsmith engine my_drive.yaml" in raised.value.hint


def test_no_device(root: Path) -> None:
    with pytest.raises(UsageError, match="describes no device"):
        load(root, ["spec/cia/cia.yaml"])


def test_commands_are_loaded_when_they_are_given() -> None:
    program = "import sys, odsmith.cli as cli; cli._parser(); print(*(m for m in sys.modules if m[:7] == 'odsmith'))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert {*done.stdout.split()} <= {"odsmith", "odsmith.cli", "odsmith.errors", "odsmith.canopen_types"}


@pytest.mark.parametrize("name", sorted(BUS_COMMANDS))
def test_each_command_has_its_module(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    from odsmith.cli import main

    with pytest.raises(SystemExit) as left:
        main([name, "--help"])
    assert left.value.code == 0
    assert f"usage: odsmith {name}" in capsys.readouterr().out
