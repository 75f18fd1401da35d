"""Specs for the tests of the generator: one drive with everything, and whatever a test writes on top of the toy."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from textwrap import dedent

import pytest

from odsmith.compile import compile_file, compile_spec
from odsmith.errors import Diagnostic, SpecError
from odsmith.model import Device


@pytest.fixture(scope="session")
def drive() -> Device:
    """`drive.yaml`: one of everything that the format knows."""
    model = compile_file(Path(__file__).with_name("drive.yaml"))
    assert isinstance(model, Device)
    return model


@pytest.fixture
def copies(tmp_path: Path, root: Path) -> Path:
    """A folder with copies of `drive.yaml` and of the toy that it builds on."""
    folder = tmp_path / "tests" / "unit" / "generator"
    folder.mkdir(parents=True)
    (tmp_path / "tests" / "golden").mkdir()
    for name in ("golden/toy.yaml", "unit/generator/drive.yaml"):
        (tmp_path / "tests" / name).write_bytes((root / "tests" / name).read_bytes())
    return folder


@pytest.fixture
def spec_file(copies: Path) -> Callable[[str], Path]:
    """`spec_file(text)` writes a spec that includes the toy drive, or `drive.yaml` if its first line says so."""

    def write(text: str) -> Path:
        text = dedent(text).lstrip("\n")
        include = "" if text.startswith("include:") else "include: [../../golden/toy.yaml]\n"
        path = copies / "spec.yaml"
        path.write_text(f"format: 1\n{include}{text}", encoding="utf-8")
        return path

    return write


@pytest.fixture
def device_of(spec_file: Callable[[str], Path]) -> Callable[[str], Device]:
    """`device_of(text)` compiles such a spec."""

    def compile_text(text: str) -> Device:
        model = compile_file(spec_file(text))
        assert isinstance(model, Device)
        return model

    return compile_text


@pytest.fixture
def findings_of(spec_file: Callable[[str], Path]) -> Callable[[str], tuple[Diagnostic, ...]]:
    """`findings_of(text)` gives the errors of such a spec, or its warnings if it compiles."""

    def compile_text(text: str) -> tuple[Diagnostic, ...]:
        try:
            return compile_spec(spec_file(text)).warnings
        except SpecError as error:
            return error.diagnostics

    return compile_text
