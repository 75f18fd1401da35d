"""The pictures of site/motion are what the device does now."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_the_pictures_are_fresh(root: Path, tmp_path: Path) -> None:
    folder = root / "site" / "motion"
    subprocess.run([sys.executable, folder / "draw.py", tmp_path], check=True)
    drawn = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.glob("*.svg")}
    assert drawn == {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.svg")}


def test_the_page_shows_every_picture(root: Path) -> None:
    folder = root / "site" / "motion"
    shown = re.findall(r"\((\w+\.svg)\)", (folder / "README.md").read_text(encoding="utf-8"))
    assert sorted(shown) == sorted(path.name for path in folder.glob("*.svg"))
