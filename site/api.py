"""Makes HTML pages of the Python API from its docstrings, with pdoc: what a program imports, and nothing behind it.

python site/api.py DIRECTORY
"""

from __future__ import annotations

import functools
import importlib
import sys
import typing
from collections.abc import Iterable
from pathlib import Path

import pdoc

ROOT = Path(__file__).parent.parent
sys.path[:0] = [str(ROOT / "generated" / folder / "python") for folder in ("cia", "tmcm6212")]

PACKAGES = ("odsmith_runtime.client", "odsmith_runtime.io", "tmcm6212")
OBJECTS = "tmcm6212.objects"


def see_like_a_type_checker() -> None:
    """The runtime has stand-ins that are quick to import and forget their parameters; pages need the real things."""
    vars(importlib.import_module("odsmith_runtime"))["lazy_property"] = functools.cached_property
    vars(importlib.import_module("odsmith_runtime.typing_support")).update(
        Generic=typing.Generic, TypeVar=typing.TypeVar
    )


def declare_only(names: type) -> None:
    """Leave the declarations of entries alone: what makes them looks like a method."""
    for name in names.__annotations__:
        if not name.startswith("_"):
            delattr(names, name)


def with_bases(found: Iterable[object]) -> set[type]:
    """The classes of ours among these, and all that they inherit from: pdoc is silent about what it has no page for."""
    classes = {base for each in found if isinstance(each, type) for base in each.__mro__}
    return {each for each in classes if each.__module__.partition(".")[0] in ("odsmith_runtime", "tmcm6212")}


def main(folder: Path) -> None:
    see_like_a_type_checker()
    packages = [importlib.import_module(name) for name in PACKAGES]
    # packages load their names when asked for them, and pdoc shows what is there
    public = [getattr(package, name) for package in packages for name in package.__all__]
    classes = with_bases([*public, *vars(importlib.import_module(OBJECTS)).values()])
    homes: dict[str, list[str]] = {}
    for each in classes:
        homes.setdefault(each.__module__, []).append(each.__name__)
        if each.__module__ == OBJECTS:
            declare_only(each)
    for home, names in homes.items():
        vars(sys.modules[home])["__all__"] = sorted(names)
    pdoc.render.configure(docformat="markdown", show_source=False)
    behind = [rf"!{package}\..+" for package in PACKAGES]  # what follows these is taken all the same
    pdoc.pdoc(*PACKAGES, *behind, *sorted(homes), output_directory=folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
