"""Single keys from a terminal, without waiting for any."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_MOST = 64


@contextmanager
def keys() -> Iterator[Callable[[], str]]:
    """A function that gives what was pressed since its last call; nothing, where there is no keyboard."""
    try:
        import termios
        import tty

        number = sys.stdin.fileno()
        before = termios.tcgetattr(number)
    except (ImportError, OSError, ValueError, termios.error):
        yield lambda: ""
        return
    try:
        tty.setcbreak(number)
        yield lambda: _pressed(number)
    finally:
        termios.tcsetattr(number, termios.TCSADRAIN, before)


def _pressed(number: int) -> str:
    if not select.select([number], [], [], 0)[0]:
        return ""
    return os.read(number, _MOST).decode("ascii", "replace")
