"""Outputs reach the disk whole, only when they changed, and nothing that is not ours is touched."""

from __future__ import annotations

from pathlib import Path

import pytest

from odsmith import render
from odsmith.render import MARK, Output, compare, write


def _output(path: str, text: str) -> Output:
    return Output(path, f"/* {MARK} */\n{text}".encode())


def test_write_reports_and_writes_only_what_changed(tmp_path: Path) -> None:
    first = [_output("dev/c/a.h", "1"), _output("dev/c/b.h", "2")]
    assert write(first, tmp_path).missing == ("dev/c/a.h", "dev/c/b.h")
    before = (tmp_path / "dev/c/b.h").stat().st_mtime_ns
    differences = write([_output("dev/c/a.h", "new"), first[1]], tmp_path)
    assert differences.changed == ("dev/c/a.h",)
    assert (tmp_path / "dev/c/b.h").stat().st_mtime_ns == before
    assert not write([_output("dev/c/a.h", "new"), first[1]], tmp_path)


def test_what_pip_leaves_in_an_installed_package_is_no_output(tmp_path: Path) -> None:
    for place in ("build/lib/dev/a.py", "dev.egg-info/PKG-INFO"):
        path = tmp_path / "dev" / "python" / place
        path.parent.mkdir(parents=True)
        path.write_text(f"# {MARK}\n")
    outputs = [_output("dev/python/dev/a.py", "1")]
    assert write(outputs, tmp_path).left_over == ()
    assert not compare(outputs, tmp_path)


def test_left_over_outputs_go_and_foreign_files_stay(tmp_path: Path) -> None:
    write([_output("dev/c/a.h", "1"), _output("dev/c/old.h", "2")], tmp_path)
    (tmp_path / "dev/c/mine.h").write_text("/* written by hand */")
    assert compare([_output("dev/c/a.h", "1")], tmp_path).left_over == ("dev/c/old.h",)
    write([_output("dev/c/a.h", "1")], tmp_path)
    assert sorted(path.name for path in (tmp_path / "dev/c").iterdir()) == ["a.h", "mine.h"]


def test_compare_writes_nothing(tmp_path: Path) -> None:
    assert compare([_output("dev/c/a.h", "1")], tmp_path).missing == ("dev/c/a.h",)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write([_output("dev/c/a.h", "old")], tmp_path)

    def fail(self: Path, target: Path) -> Path:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OSError, match="No space"):
        write([_output("dev/c/a.h", "new")], tmp_path)
    assert [path.name for path in (tmp_path / "dev/c").iterdir()] == ["a.h"]
    assert (tmp_path / "dev/c/a.h").read_bytes().endswith(b"old")


def test_new_files_have_ordinary_permissions(tmp_path: Path) -> None:
    write([_output("dev/c/a.h", "1")], tmp_path)
    assert (tmp_path / "dev/c/a.h").stat().st_mode & 0o777 == 0o666 & ~render._umask()


def test_templates_hide_macros_and_demand_every_name(tmp_path: Path) -> None:
    folder = tmp_path / "c" / "device"
    folder.mkdir(parents=True)
    (folder / "_macros.j2").write_text("{% macro m() %}x{% endmacro %}")
    (folder / "__init__.py.j2").write_text("{{ name }}\n")
    templates = render.Templates(tmp_path, "c")
    assert templates.names("device") == ["c/device/__init__.py.j2"]
    assert templates.render("c/device/__init__.py.j2", {"name": "x"}) == "x\n"
    with pytest.raises(Exception, match="'name' is undefined"):
        templates.render("c/device/__init__.py.j2", {})
