"""Where the C engines of devices are kept after they were compiled: in the user's cache, one library for each model."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType


def cache_folder() -> Path:
    """The folder of this tool in the user's cache. Raises RuntimeError for a user without a home."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "odsmith"


def library_path(identifier: str, digest: str) -> Path:
    """Where the library of a model is, or would be. Another version of this tool has another one."""
    try:
        release = version("odsmith")
    except PackageNotFoundError:
        release = "unknown"
    return cache_folder() / "engine" / release / f"{identifier}-{digest}.so"


def find(package: ModuleType) -> Path | None:
    """The library of a generated package, if it was built. One that somebody else owns does not count."""
    try:
        path = library_path(package.__name__, package.__spec_digest__)
        owner = path.stat().st_uid
    except (OSError, RuntimeError):
        return None
    return path if not hasattr(os, "getuid") or owner == os.getuid() else None
