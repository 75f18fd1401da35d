"""The tables rule: a row that leaves the YAML leaves every artefact, with no edit elsewhere."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from odsmith.backends import BUILT_IN, backend
from odsmith.compile import compile_file
from odsmith.model import Device


def cut(path: Path, first_line: str) -> None:
    """Remove the one YAML element that begins with this line, and all that is indented below it."""
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    starts = [number for number, line in enumerate(lines) if line.strip().startswith(first_line)]
    assert len(starts) == 1, f"{first_line!r} stands {len(starts)} times in {path}"
    start = starts[0]
    depth = len(lines[start]) - len(lines[start].lstrip())
    end = start + 1
    while end < len(lines) and (not lines[end].strip() or len(lines[end]) - len(lines[end].lstrip()) > depth):
        end += 1
    path.write_text("".join(lines[:start] + lines[end:]), encoding="utf-8")


def artefacts(device: Device) -> dict[str, str]:
    """All text of each backend."""
    return {name: "\n".join(output.content.decode() for output in backend(name).render(device)) for name in BUILT_IN}


ROWS: dict[str, tuple[str, str, dict[str, str]]] = {
    # what: (file, first line of the element, for some backends a pattern that only this row brings)
    "a transition": (
        "cia/402.yaml",
        "- number: 16",
        {"c": r"ODS_PDS_STATE_OPERATION_ENABLED, 16 \}", "python": r"number=16,", "docs": "transition-16"},
    ),
    "an emergency": (
        "trinamic/emergency.yaml",
        "- name: undervoltage",
        {"c": "EMCY_UNDERVOLTAGE 0xFF00u", "python": r'"undervoltage"', "docs": "FF00h"},
    ),
    "a homing method": (
        "trinamic/homing.yaml",
        "positive_limit:",
        {"c": "HOMING_METHOD_POSITIVE_LIMIT", "python": "POSITIVE_LIMIT = 18", "docs": "Homing on the positive limit"},
    ),
    "a mode": (
        "trinamic/modes.yaml",
        "cyclic_synchronous_velocity:",
        {
            "c": "MODES_OF_OPERATION_CYCLIC_SYNCHRONOUS_VELOCITY",
            "python": "CYCLIC_SYNCHRONOUS_VELOCITY = 9",
            "eds": "0x000001A5",
        },
    ),
    "a bit": (
        "trinamic/motor.yaml",
        '"5": {name: home_inverted',
        {"c": "HOME_INVERTED", "python": "HOME_INVERTED", "docs": "home_inverted"},
    ),
}


@pytest.fixture(scope="module")
def whole(tmcm3230: Device) -> dict[str, str]:
    return artefacts(tmcm3230)


@pytest.mark.parametrize("what", ROWS)
def test_a_row_that_goes_is_gone_everywhere(what: str, whole: dict[str, str], root: Path, tmp_path: Path) -> None:
    file, first_line, words = ROWS[what]
    shutil.copytree(root / "spec", tmp_path / "spec")
    cut(tmp_path / "spec" / file, first_line)
    device = compile_file(tmp_path / "spec" / "tmcm3230.yaml")
    assert isinstance(device, Device)
    remaining = artefacts(device)
    for name in BUILT_IN:
        assert remaining[name] != whole[name], f"{name} did not change"
    for name, word in words.items():
        assert re.search(word, whole[name]), f"{name} never had {word}"
        assert not re.search(word, remaining[name]), f"{name} still has {word}"
