"""Where specs are found, and what a build of them consists of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from odsmith.backends import BUILT_IN, UnknownBackendError
from odsmith.compile import compile_spec
from odsmith.errors import SpecError, UsageError
from odsmith.project import Root, compile_all, devices, render_all, roots, select

BROKEN = "format: 1\ninclude: [cia/301.yaml]\nvocabulary: {identifier: x}\n"


@pytest.fixture
def project(tmp_path: Path, root: Path) -> Path:
    """A project with a device, a vocabulary, and files that are neither."""
    folder = tmp_path / "project"
    (folder / "spec" / "cia").mkdir(parents=True)
    (folder / "spec" / "parts").mkdir()
    toy = (root / "tests" / "golden" / "toy.yaml").read_bytes()
    (folder / "spec" / "toy.yaml").write_bytes(toy)
    (folder / "spec" / "parts" / "hidden.yaml").write_bytes(toy)
    (folder / "spec" / "units.yaml").write_text("format: 1\nunits: {}\n# device: a remark\n")
    (folder / "spec" / "notes.txt").write_text("device:\n")
    (folder / "spec" / "cia" / "words.yaml").write_text(
        "format: 1\ninclude: [cia/301.yaml]\nvocabulary: {identifier: words, title: Words}\n"
    )
    return folder


def test_roots_have_a_section_that_makes_them_one(project: Path) -> None:
    """The vocabulary comes first; parts in folders of their own are no roots."""
    assert roots(project) == [
        Root("words", project / "spec" / "cia" / "words.yaml"),
        Root("toy", project / "spec" / "toy.yaml"),
    ]


def test_what_cannot_be_read_is_left_to_the_loader(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = Path.read_bytes

    def refuse(self: Path) -> Any:
        if self.name == "units.yaml":
            raise PermissionError(13, "Permission denied", str(self))
        return real(self)

    monkeypatch.setattr(Path, "read_bytes", refuse)
    assert "units" in [root.name for root in roots(project)]


def test_no_folder_no_project(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"there is no folder spec/ in") as caught:
        roots(tmp_path)
    assert "odsmith build my_drive.yaml" in caught.value.hint
    (tmp_path / "spec").mkdir()
    (tmp_path / "spec" / "units.yaml").write_text("format: 1\nunits: {}\n")
    with pytest.raises(UsageError, match=r"no file in .* has a `device:` section"):
        roots(tmp_path)


def test_select(project: Path, tmp_path: Path) -> None:
    toy = Root("toy", project / "spec" / "toy.yaml")
    assert select(project, []) == roots(project)
    assert select(project, ["toy"]) == [toy]
    assert select(project, ["toy", "words", "toy"]) == [toy, roots(project)[0]]  # each one once
    mine = tmp_path / "mine.yaml"
    assert select(project, [str(mine)]) == [Root("mine", mine)]  # whether it is there is the loader's business
    odd = tmp_path / "no_suffix"
    odd.write_text("format: 1\n")
    assert select(project, [str(odd)]) == [Root("no_suffix", odd)]


def test_select_from_the_packaged_library(tmp_path: Path, root: Path) -> None:
    """Needs no project; a project's own device of the same name goes before it."""
    (drive,) = select(tmp_path, ["tmcm3230"])
    (words,) = select(tmp_path, ["cia"])
    assert (drive.name, drive.path.samefile(root / "spec" / "tmcm3230.yaml")) == ("tmcm3230", True)
    assert (words.name, words.path.samefile(root / "spec" / "cia" / "cia.yaml")) == ("cia", True)
    (tmp_path / "spec").mkdir()
    (tmp_path / "spec" / "tmcm3230.yaml").write_text("device:\n")
    assert select(tmp_path, ["tmcm3230"]) == [Root("tmcm3230", tmp_path / "spec" / "tmcm3230.yaml")]


def test_select_what_is_not_there(project: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no device `tou`") as caught:
        select(project, ["toy", "tou"])
    assert caught.value.hint == "known: words, toy, tmcm3230, tmcm6212; or name a YAML file"
    with pytest.raises(UsageError) as caught:
        select(tmp_path, ["tou"])
    assert caught.value.hint == "known: tmcm3230, tmcm6212; or name a YAML file"


def test_errors_of_all_files_are_shown(project: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.yaml").write_text(BROKEN)
    with pytest.raises(SpecError) as caught:
        compile_all([*select(tmp_path, [str(tmp_path / "b.yaml"), str(tmp_path / "a.yaml")]), *roots(project)])
    paths = [Path(item.place.path).name for item in caught.value.diagnostics]
    assert sorted(set(paths)) == ["a.yaml", "b.yaml"]
    assert paths == sorted(paths)
    assert {Path(path).name for path in caught.value.texts} >= {"a.yaml", "b.yaml"}
    assert "vocabulary: {identifier: x}" in str(caught.value)


def test_devices_are_not_vocabularies(project: Path) -> None:
    compiled = compile_all(roots(project))
    assert [item.model.identifier for item in compiled] == ["words", "toy"]
    assert [device.identity.name for device in devices(compiled)] == ["TOY-2"]


def test_render_runs_the_backends_that_it_is_told_to(project: Path) -> None:
    compiled = compile_all(roots(project))
    (eds,) = render_all(compiled, ["eds"])
    assert eds.path == "toy/eds/TOY-2.eds"
    assert len(render_all(compiled, ["eds", "eds"])) == 1
    with pytest.raises(UnknownBackendError, match="pascal"):
        render_all(compiled, ["eds", "pascal"])


def test_render_runs_every_backend_if_told_nothing(project: Path) -> None:
    outputs = render_all(compile_all(roots(project)))
    assert {output.path.split("/")[1] for output in outputs if output.path.startswith("toy/")} == set(BUILT_IN)
    assert len({output.path for output in outputs}) == len(outputs)


def test_two_files_may_not_describe_one_device(spec_file: Callable[[str], Path], root: Path) -> None:
    """One would overwrite what the other wrote."""
    compiled = [compile_spec(spec_file("")), compile_spec(root / "tests" / "golden" / "toy.yaml")]
    with pytest.raises(UsageError, match="2 of these files describe `toy`"):
        render_all(compiled, ["eds"])
