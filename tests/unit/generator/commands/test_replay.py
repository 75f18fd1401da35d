"""`odsmith replay`, where the log is none."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.unit.generator.commands.conftest import Run


@pytest.mark.parametrize(
    ("text", "message"), [("", "has no frames"), ("hello\n", "run.log:1: this is no line of candump")]
)
def test_no_log(run: Run, tmp_path: Path, text: str, message: str) -> None:
    log = tmp_path / "run.log"
    log.write_text(text)
    failed = run("replay", log, "tmcm6212")
    assert failed.status == 2
    assert message in failed.err
