"""The state file: it is whole or it is refused, and nothing in it is ever lost."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from odsmith_runtime.io.state_file import StateError, StateFile


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state.json"


def test_what_is_saved_is_there(path: Path) -> None:
    state = StateFile(path, "tmcm6212")
    assert state.image(1) is None
    state.save(1, b"one")
    state.save(2, b"two")
    state.save(1, b"three")
    again = StateFile(path, "tmcm6212")
    assert [again.image(node) for node in (1, 2, 3)] == [b"three", b"two", None]
    assert [item.name for item in path.parent.iterdir()] == ["state.json"]


def test_what_has_not_changed_is_not_written(path: Path) -> None:
    state = StateFile(path, "tmcm6212")
    state.save(1, b"one")
    path.unlink()
    state.save(1, b"one")
    assert not path.exists()


Spoil = Callable[[Any], object]


@pytest.mark.parametrize(
    "spoil",
    [
        pytest.param(lambda content: "", id="empty"),
        pytest.param(lambda content: json.dumps(content)[:-9], id="cut"),
        pytest.param(lambda content: content | {"format": "other"}, id="other format"),
        pytest.param(lambda content: content | {"nodes": {"1": {"crc32": 0, "image": "00"}}}, id="wrong checksum"),
        pytest.param(lambda content: content | {"nodes": {"1": {"crc32": 0, "image": "xy"}}}, id="no octets"),
        pytest.param(lambda content: content | {"nodes": [1]}, id="no nodes"),
        pytest.param(lambda content: [], id="a list"),
        pytest.param(lambda content: "[" * 100_000, id="nested"),
    ],
)
def test_a_damaged_file_is_refused_and_kept(path: Path, spoil: Spoil) -> None:
    StateFile(path, "tmcm6212").save(1, b"one")
    spoiled = spoil(json.loads(path.read_text()))
    text = spoiled if isinstance(spoiled, str) else json.dumps(spoiled)
    path.write_text(text)
    with pytest.raises(StateError, match="is damaged") as raised:
        StateFile(path, "tmcm6212")
    assert raised.value.hint
    assert path.read_text() == text


def test_the_file_of_another_device_is_refused(path: Path) -> None:
    StateFile(path, "tmcm3230").save(1, b"one")
    with pytest.raises(StateError, match="of a tmcm3230, not of a tmcm6212"):
        StateFile(path, "tmcm6212")


@pytest.mark.parametrize(
    ("place", "message", "hint"),
    [
        ("gone/state.json", "cannot be written: .*gone: No such file or directory", "make this folder"),
        ("file/state.json", "cannot be read: Not a directory", "name another file"),
        ("folder", "cannot be read: Is a directory", "name another file"),
        ("dangling", "cannot be written: .*gone: No such file or directory", "make this folder"),
    ],
)
def test_a_place_that_cannot_be_used_is_refused_at_once(path: Path, place: str, message: str, hint: str) -> None:
    path.with_name("file").touch()
    path.with_name("folder").mkdir()
    path.with_name("dangling").symlink_to(path.with_name("gone") / "state.json")
    with pytest.raises(StateError, match=message) as raised:
        StateFile(path.parent / place, "tmcm6212")
    assert raised.value.hint.startswith(hint)


@pytest.mark.parametrize("call", ["os.open", "io.open"])
def test_a_folder_without_permission_is_refused_at_once(path: Path, monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    """As root one has every permission, so it is the system call that says no."""
    StateFile(path, "tmcm6212").save(1, b"one")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(call, refuse)
    with pytest.raises(StateError, match=r"cannot be (written|read): .*Permission denied"):
        StateFile(path, "tmcm6212")


def test_to_look_leaves_nothing_behind(path: Path) -> None:
    StateFile(path, "tmcm6212")
    assert [*path.parent.iterdir()] == []


def test_the_old_file_stays_where_the_new_one_cannot_be_written(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    state = StateFile(path, "tmcm6212")
    state.save(1, b"one")

    def fail(*_: object) -> None:
        raise OSError(28, "no space left on device")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(OSError, match="no space"):
        state.save(1, b"two")
    assert StateFile(path, "tmcm6212").image(1) == b"one"
    assert len(list(path.parent.iterdir())) == 1


def test_a_link_stays_a_link(path: Path) -> None:
    real = path.with_name("real.json")
    path.symlink_to(real)
    StateFile(path, "tmcm6212").save(1, b"one")
    assert path.is_symlink()
    assert StateFile(real, "tmcm6212").image(1) == b"one"
