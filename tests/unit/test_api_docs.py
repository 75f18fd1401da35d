"""The pages of the Python API: made without a warning, and whatever a program can call has its words there."""

from __future__ import annotations

import importlib
import inspect
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from odsmith_runtime import client
from odsmith_runtime.names import _Attribute


class Member(NamedTuple):
    """A name of a public class: the package that offers the class, and the class that the name comes from."""

    package: str
    owner: type
    home: type
    name: str


@pytest.fixture
def packages(root: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    """The packages that have pages; they can be imported."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    packages: tuple[str, ...] = runpy.run_path(str(root / "site" / "api.py"))["PACKAGES"]
    return packages


def public(package: str) -> dict[str, object]:
    module = importlib.import_module(package)
    return {name: getattr(module, name) for name in module.__all__}


def members(package: str) -> Iterator[Member]:
    """Methods, properties and entries of the public classes, inherited ones too if they are ours."""
    for owner in public(package).values():
        if not isinstance(owner, type):
            continue
        homes = {name: base for base in reversed(owner.__mro__) for name in vars(base)}
        for name, home in homes.items():
            if name.startswith("_") or not home.__module__.startswith(("odsmith_runtime", "tmcm6212")):
                continue
            found = vars(home)[name]
            if callable(found) or isinstance(found, (property, classmethod, _Attribute)):
                yield Member(package, owner, home, name)


def words(found: object) -> str:
    """The docstring of its own, none that it inherits."""
    return getattr(found, "__doc__", None) or ""


def test_what_can_be_called_has_a_docstring(packages: tuple[str, ...]) -> None:
    assert [name for name in packages if not words(importlib.import_module(name))] == []
    offered = [(package, name, found) for package in packages for name, found in public(package).items()]
    called = [(package, name) for package, name, found in offered if callable(found) and not words(found)]
    assert called == []
    found = [member for package in packages for member in members(package)]
    assert len(found) > 500
    undocumented = [
        f"{member.home.__module__}.{member.home.__name__}.{member.name}"
        for member in found
        if not isinstance(vars(member.home)[member.name], _Attribute) and not words(vars(member.home)[member.name])
    ]
    assert sorted(set(undocumented)) == []


def test_classes_say_in_what_they_count_time(packages: tuple[str, ...]) -> None:
    waiting = {
        member.owner
        for package in packages
        for member in members(package)
        if callable(method := getattr(member.owner, member.name))
        and not isinstance(vars(member.home)[member.name], _Attribute)
        and {"timeout", "period"} & set(inspect.signature(method).parameters)
    }
    assert {client.Axis, client.AsyncDrive} <= waiting
    assert [owner.__name__ for owner in waiting if "seconds" not in words(owner)] == []


def test_every_error_of_the_client_is_named_where_it_is_raised() -> None:
    errors = {
        name
        for name, found in public("odsmith_runtime.client").items()
        if "Error" in name or found is client.SdoAborted
    }
    told = " ".join(
        words(member.owner) + words(vars(member.home)[member.name])
        for member in members("odsmith_runtime.client")
        if not issubclass(member.owner, Exception)
    )
    assert len(errors) > 5
    assert sorted(name for name in errors if not re.search(rf"\b{name}\b", told)) == []


@pytest.mark.slow
def test_the_pages_show_it_all(packages: tuple[str, ...], root: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-W", "error", str(root / "site" / "api.py"), str(tmp_path)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (made.returncode, made.stderr) == (0, "")
    anchors: dict[str, set[str]] = {}
    explained: dict[str, set[str]] = {}
    for path in tmp_path.rglob("*.html"):
        module = ".".join(path.relative_to(tmp_path).with_suffix("").parts)
        parts = re.findall(r'\bid="([^"]+)"(.*?)(?=\bid="|\Z)', path.read_text(encoding="utf-8"), re.DOTALL)
        anchors[module] = {name for name, _ in parts}
        explained[module] = {name for name, text in parts if 'class="docstring"' in text}
    for package in packages:
        assert set(public(package)) <= anchors[package]
        for member in members(package):
            assert f"{member.owner.__name__}.{member.name}" in anchors[package]
            assert f"{member.home.__name__}.{member.name}" in explained[member.home.__module__], member
