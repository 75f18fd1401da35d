"""Clocks with which a testee may begin, in microseconds of 32 bits."""

from __future__ import annotations

PLAIN = 0

WRAPPING = 0xFFFFFF00
"""It wraps before the first tick."""

CLOCKS = (PLAIN, WRAPPING, 0xFFFE0000, 0xFFF00000)
"""Those that wrap do so at once, or when an axis may have begun to move."""
