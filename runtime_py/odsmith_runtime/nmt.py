"""Network management: states and commands of a node (CiA 301, clauses 7.2.8 and 7.3.2)."""

from __future__ import annotations

from .rows import Row


class NmtStateInfo(Row):
    """A state; `code` as the heartbeat carries it, `services` are those that run in it."""

    name: str
    code: int
    title: str
    services: tuple[str, ...]
    text: str = ""
    source: str = ""


class NmtCommandInfo(Row):
    """A node control command and the state that it leads `to`."""

    name: str
    code: int
    to: str
    title: str
    text: str = ""
    source: str = ""
