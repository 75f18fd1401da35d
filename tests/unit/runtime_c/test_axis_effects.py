"""What writing to an axis does, once more for C: programs of every compiler, which sanitizers watch."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from tests.cross.driver import Testee
from tests.cross.test_axis_effects import *  # noqa: F403  (the cases)
from tests.cross.test_axis_effects import Drives, drives_on


@pytest.fixture  # type: ignore[no-redef]
def drives(start: Callable[..., Testee]) -> Drives:
    return drives_on(start)
