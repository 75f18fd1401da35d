"""lely's dcf-tools, the strictest open readers of EDS files, take ours without a word."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.model import Device

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=["tmcm3230", "io_module"])
def device(request: pytest.FixtureRequest) -> Device:
    """Every device that we ship."""
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(scope="module")
def eds(device: Device, tmp_path_factory: pytest.TempPathFactory) -> Path:
    (output,) = EdsBackend().render(device)
    path = tmp_path_factory.mktemp("eds") / Path(output.path).name
    path.write_bytes(output.content)
    return path


def run(module: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    """Run a tool of dcf-tools. Its use of pkg_resources is deprecated: that is not about our file."""
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-W", "ignore:pkg_resources:UserWarning"]
    command += ["-m", module, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)


@pytest.mark.parametrize("node_id", [1, 127])
def test_dcfchk_has_nothing_to_say(eds: Path, node_id: int) -> None:
    result = run("dcf.cli", "-n", node_id, eds)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_dcf2dev_makes_c_of_every_object(device: Device, eds: Path) -> None:
    result = run("dcf2dev.cli", eds, "toy")
    assert (result.returncode, result.stderr) == (0, "")
    assert [obj.index for obj in device.expanded if f".idx = 0x{obj.index:04X}" not in result.stdout] == []


def test_dcfgen_makes_a_master_for_it(eds: Path, tmp_path: Path) -> None:
    bus = tmp_path / "bus.yml"
    bus.write_text(f"master: {{node_id: 127}}\ntoy: {{node_id: 1, dcf: '{eds}'}}\n", encoding="utf-8")
    result = run("dcfgen.cli", "-S", "-d", tmp_path, bus)
    assert (result.returncode, result.stderr) == (0, "")
    assert (tmp_path / "master.dcf").stat().st_size > 0
