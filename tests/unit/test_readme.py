"""The examples of the README run, and print what their comments say."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest


def blocks(root: Path) -> list[str]:
    text = (root / "README.md").read_text(encoding="utf-8")
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


@pytest.mark.parametrize("number", range(2))
def test_a_python_example_runs(number: int, root: Path) -> None:
    found = blocks(root)
    assert len(found) == 2
    code = found[number]
    packages = [str(root / "generated" / device / "python") for device in ("tmcm3230", "tmcm6212")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(packages)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    printed = [
        comment for comment in re.findall(r"\)  # (.*)", code) if re.fullmatch(r"[0-9a-f]{3}( [0-9a-f]{2})+", comment)
    ]
    assert done.stdout.splitlines() == printed
