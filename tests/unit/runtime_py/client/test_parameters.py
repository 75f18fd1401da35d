"""Parameter files, apart from what `test_async_drive` tells."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml
from tests.unit.runtime_py.client.faces import Bench

from odsmith_runtime import OutOfRangeError
from odsmith_runtime.client import MissingPackageError


def test_without_yaml_it_says_what_to_install(blocking: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "yaml", None)
    path = tmp_path / "x.yaml"
    path.write_text("device: TMCM-6212\n")
    with pytest.raises(MissingPackageError, match=r"parameter files need PyYAML: pip install 'odsmith\[client\]'"):
        blocking.drive.load_parameters(path)


def test_a_file_has_names_and_numbers(blocking: Bench, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    blocking.drive.axes[4].profile_velocity.raw = 77
    blocking.drive.save_parameters(path)
    content = yaml.safe_load(path.read_text())
    assert list(content) == ["device", "whole_device", *(f"axis_{axis}" for axis in range(6))]
    assert content["axis_4"]["profile_velocity"] == 77
    assert content["axis_0"]["rpdo_communication.1.cob_id"] == 0x40000201
    assert "statusword" not in content["axis_0"]


def test_nothing_is_written_if_a_value_is_wrong(blocking: Bench, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text("device: TMCM-6212\naxis_0: {profile_velocity: 5, maximum_current: 256}\n")
    with pytest.raises(OutOfRangeError, match="maximum_current of axis 0"):
        blocking.drive.load_parameters(path)
    assert blocking.drive.axes[0].profile_velocity.raw == 0


def test_a_pdo_is_written_as_a_whole(blocking: Bench, tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text(
        "device: TMCM-6212\n"
        "axis_1:\n"
        "  tpdo_communication.1.cob_id: 0x40000690\n"
        "  tpdo_mapping.1.mapped_count: 1\n"
        "  tpdo_mapping.1.mapping_1: 0x68640020\n"
    )
    report = blocking.drive.load_parameters(path)
    assert len(report.differences) == 2
    assert blocking.device.read(0x1A40, 1) == bytes.fromhex("20006468")
    assert blocking.device.read(0x1840, 1) == bytes.fromhex("90060040")
