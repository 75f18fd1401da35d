"""Each `NAME.yaml` here is broken in one way; `NAME.txt` has the exact message that the user gets.

After a deliberate change of messages: `pytest tests/errors --accept`, then read the diff.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from odsmith.cli import main
from odsmith.rules import RULES

HERE = Path(__file__).parent
BROKEN = sorted(path.stem for path in HERE.glob("*.yaml") if path.stem != "hostile")


@pytest.mark.parametrize("name", BROKEN)
def test_broken_spec(
    name: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    accept: bool,
) -> None:
    monkeypatch.chdir(HERE)
    out = tmp_path / "out"
    status = main(["build", f"{name}.yaml", "--out", str(out)])
    message = capsys.readouterr().err.replace(str(HERE.parent.parent), "<checkout>")
    expected = HERE / f"{name}.txt"
    if accept:
        expected.write_text(message, encoding="utf-8")
    assert message == expected.read_text(encoding="utf-8")
    assert status == 2
    assert not out.exists()


def test_every_broken_spec_is_broken_in_its_own_way() -> None:
    messages = [(HERE / f"{name}.txt").read_text(encoding="utf-8") for name in BROKEN]
    assert all("error[E" in message and "Traceback" not in message for message in messages)
    assert len(BROKEN) >= 40


def test_json_has_the_same_findings(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(HERE)
    assert main(["build", "several_at_once.yaml", "--json"]) == 2
    findings = json.loads(capsys.readouterr().out)
    assert [finding["rule"] for finding in findings] == ["E407", "E408", "E406"]
    assert all(finding["path"] == "several_at_once.yaml" and finding["line"] > 2 for finding in findings)


def test_lint_prints_what_build_refuses(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(HERE)
    assert main(["lint", "default_outside_range.yaml"]) == 2
    assert (HERE / "default_outside_range.txt").read_text(encoding="utf-8") in capsys.readouterr().out


def test_ten_megabytes(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("large.yaml").write_text("format: 1\n" + "# and so on and so on\n" * 480_000)
    assert main(["build", "large.yaml", "--out", "out"]) == 2
    assert capsys.readouterr().err == (
        "large.yaml: error[E102]: `large.yaml` is larger than 4 MB\nhint: split the file and include the parts\n"
    )


def test_unreadable_file(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("secret.yaml").write_text("format: 1\n")

    real_open = Path.open

    def refuse(self: Path, *arguments: Any, **options: Any) -> Any:  # root may read everything: the refusal is made up
        if self.name == "secret.yaml":
            raise PermissionError(13, "Permission denied", str(self))
        return real_open(self, *arguments, **options)

    monkeypatch.setattr(Path, "open", refuse)
    assert main(["build", "secret.yaml", "--out", "out"]) == 2
    assert "secret.yaml: error[E101]: " in (message := capsys.readouterr().err)
    assert "Permission denied" in message or "permission" in message


def test_missing_file_and_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder.yaml").mkdir()
    for name in ("missing.yaml", "folder.yaml"):
        assert main(["build", name, "--out", "out"]) == 2
        assert f"{name}: error[E101]: " in capsys.readouterr().err


def test_output_folder_that_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(HERE)
    taken = tmp_path / "taken"
    taken.write_text("a file, not a folder")
    assert main(["build", "../golden/toy.yaml", "--out", str(taken)]) == 2
    assert capsys.readouterr().err.startswith(f"odsmith: error: {taken}")
    assert taken.read_text() == "a file, not a folder"


def test_every_rule_of_the_passes_has_a_broken_spec() -> None:
    """A rule that no example breaks might as well not exist."""
    shown = "\n".join((HERE / f"{name}.txt").read_text(encoding="utf-8") for name in BROKEN)
    elsewhere = {
        "E101": "missing, unreadable: tests above",
        "E102": "too large: a test above",
        "E122": "too many errors: tests/unit/generator/test_load.py",
        "E471": "values too large for the C tables: tests/unit/generator/backends/test_c.py",
        "E472": "too many rows for the C tables: tests/unit/generator/backends/test_c.py",
    }
    elsewhere |= {rule: "coverage: tests/unit/generator/coverage" for rule in RULES if rule.startswith("E7")}
    unshown = {rule for rule in RULES if rule.startswith("E") and f"[{rule}]" not in shown}
    assert unshown == set(elsewhere)
