"""Compiling the C engine."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from odsmith import engine
from odsmith.compile import Compiled, compile_spec
from odsmith.errors import UsageError
from odsmith.render import Output


@pytest.fixture(scope="module")
def compiled() -> Compiled:
    return compile_spec(Path(__file__).parents[3] / "spec" / "examples" / "io_module.yaml")


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The compiler, which only counts how often it was called."""
    made: list[int] = []

    def compile_nothing(outputs: list[Output], path: Path) -> None:
        made.append(len(outputs))
        path.write_bytes(b"library")

    monkeypatch.setattr(engine, "_compile", compile_nothing)
    return made


def test_it_is_compiled_when_a_source_has_changed(
    compiled: Compiled, calls: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = engine.build(compiled)
    assert engine.build(compiled) == path
    assert len(calls) == 1
    engine.build(compiled, force=True)
    path.unlink()
    engine.build(compiled)
    path.with_suffix(".sources").write_text("of another runtime")
    engine.build(compiled)
    assert len(calls) == 4


@pytest.mark.slow
def test_a_device_without_axes(compiled: Compiled, tool: Callable[[str], str], root: Path, tmp_path: Path) -> None:
    from odsmith.commands.common import load
    from odsmith_runtime.io.c_engine import CEngine

    tool("cc")
    path = engine.build(compiled)
    (loaded,) = load(root, ["spec/examples/io_module.yaml"])
    device = CEngine(loaded.package, path, node_id=3)
    device.power_on(0)
    assert [frame.id for _, frame in device.take()] == [0x703]


def test_without_a_compiler(compiled: Compiled, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(UsageError, match="needs a C compiler") as raised:
        engine.build(compiled)
    assert "apt-get" in raised.value.hint


def test_a_compiler_that_refuses(compiled: Compiled, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "cc"
    program.write_text("#!/bin/sh\necho 'no, thanks' >&2\nexit 1\n")
    program.chmod(0o755)
    monkeypatch.setenv("CC", str(program))
    with pytest.raises(UsageError, match="no, thanks"):
        engine.build(compiled)


def test_a_vocabulary_has_no_engine(root: Path) -> None:
    with pytest.raises(UsageError, match="is no device"):
        engine.build(compile_spec(root / "spec" / "cia" / "cia.yaml"))
