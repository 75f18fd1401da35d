"""The package loads what is asked for and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import odsmith_runtime


def loaded(root: Path, code: str) -> set[str]:
    """The modules that a fresh interpreter loads for some code, the installation's own left out."""
    script = f"""
import sys
sys.path.insert(0, {str(root / "runtime_py")!r})
before = set(sys.modules)
{code}
print(*sorted(set(sys.modules) - before), sep="\\n")
"""
    run = subprocess.run([sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


def test_the_way_to_a_dictionary_loads_no_other_module(root: Path) -> None:
    code = "from odsmith_runtime.dictionary import ObjectDictionary"
    assert loaded(root, code) == {"odsmith_runtime", "odsmith_runtime.dictionary"}


def test_every_public_name_is_where_it_is_said_to_be() -> None:
    public = [name for name in dir(odsmith_runtime) if not name.startswith("_")]
    assert {"Entry", "StateMachine", "load_on_use", "errors", "RefusedError"} <= set(public)
    for name in public:
        assert getattr(odsmith_runtime, name) is not None


def test_an_unknown_name() -> None:
    with pytest.raises(AttributeError, match="module 'odsmith_runtime' has no attribute 'Nothing'"):
        _ = odsmith_runtime.Nothing  # type: ignore[attr-defined]


def test_no_module_needs_another_distribution(root: Path) -> None:
    modules = sorted(path.stem for path in (root / "runtime_py" / "odsmith_runtime").glob("*.py"))
    code = "\n".join(f"import odsmith_runtime.{name}" for name in modules if name != "__init__")
    foreign = {name.partition(".")[0] for name in loaded(root, code)} - set(sys.stdlib_module_names)
    assert foreign == {"odsmith_runtime"}
