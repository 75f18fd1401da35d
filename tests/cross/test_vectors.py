"""Dialogues that other makers have printed are those of our devices too, in both runtimes."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.cross.driver import Frame, Testee

from odsmith.model import Device

pytestmark = pytest.mark.slow

VECTORS: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("vectors.yaml").read_text())


@pytest.fixture(params=["c", "python"])
def testee_program(request: pytest.FixtureRequest) -> Callable[[Device], Path]:
    program: Callable[[Device], Path] = request.getfixturevalue(f"{request.param}_testee")
    return program


def sent(testee: Testee, what: str) -> list[Frame]:
    """What the device sends when this is done to it: a frame, or `250 ms`."""
    if what.endswith(" ms"):
        return testee.advance(1000 * int(what.removesuffix(" ms"))).frames
    return testee.do(f"RX {what}").frames


@pytest.mark.parametrize("device", ["tmcm3230", "tmcm6212"])
@pytest.mark.parametrize("vector", VECTORS, ids=lambda vector: vector["name"])
def test_dialogue(
    vector: dict[str, Any], device: str, start: Callable[..., Testee], request: pytest.FixtureRequest
) -> None:
    testee = start(request.getfixturevalue(device), node_id=vector["node_id"])
    expected = vector["dialogue"].splitlines()
    ids = {line.split(" ")[1] for line in expected if line.startswith("<")}

    def heard(frames: list[Frame]) -> list[str]:
        return [f"< {frame}" for frame in frames if f"{frame.id:03X}" in ids]

    boot_up = heard(testee.power().frames)
    for frame in vector.get("before", "").splitlines():
        assert sent(testee, frame)
    dialogue = boot_up if expected[0].startswith("<") else []
    for line in expected:
        if line.startswith(">"):
            dialogue += [line, *heard(sent(testee, line[2:]))]
    assert len(dialogue) == len(expected), dialogue
    for pattern, line in zip(expected, dialogue, strict=True):
        assert re.fullmatch(pattern, line), dialogue
