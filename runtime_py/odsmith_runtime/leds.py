"""Indicator LEDs (CiA 303-3)."""

from __future__ import annotations

from .rows import Row


class LedPattern(Row):
    """What an LED does while one of `when` holds: `steady` on or off, or on and off times in ms in turn, on first.

    `when` names NMT states and what ails the bus. Where several patterns apply the one of highest `priority` shows.
    """

    name: str
    title: str
    steady: str
    phases: tuple[int, ...]
    when: tuple[str, ...]
    priority: int
    text: str = ""


class Led(Row):
    name: str
    title: str
    colour: str
    patterns: tuple[LedPattern, ...]
    source: str = ""
