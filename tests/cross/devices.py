"""The devices of the tests: two real ones, an example, and two that are made up."""

from __future__ import annotations

from pathlib import Path

from odsmith.compile import compile_file
from odsmith.model import Device

ROOT = Path(__file__).parent.parent.parent

SPECIFICATIONS = {
    "tmcm3230": ROOT / "spec" / "tmcm3230.yaml",
    "tmcm6212": ROOT / "spec" / "tmcm6212.yaml",
    "io_module": ROOT / "spec" / "examples" / "io_module.yaml",
    "toy": ROOT / "tests" / "golden" / "toy.yaml",
    "every_type": ROOT / "tests" / "cross" / "every_type.yaml",
}


def device(name: str) -> Device:
    """The model of a device, by its identifier."""
    model = compile_file(SPECIFICATIONS[name])
    assert isinstance(model, Device)
    return model
