"""SDO abort codes (CiA 301, clause 7.2.4.3.17)."""

from __future__ import annotations

from .rows import Row


class AbortCodeInfo(Row):
    """An abort code; `used` says whether this device gives it, `why` when, or why never."""

    name: str
    code: int
    title: str
    used: bool
    why: str
    source: str = ""
