"""Worked examples as data: the steps that lead to a move, written for axis 0 and good for any axis.

Entries are named as `ObjectDictionary.entry` takes them. `added` names the erratum that made a step necessary where
the manual forgets it.
"""

from __future__ import annotations

from .rows import Row

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias


class Write(Row):
    """Write values to entries, in order: (name of the entry, value)."""

    values: tuple[tuple[str, int | str], ...]
    text: str = ""
    added: str = ""


class Command(Row):
    """Give a command of the state machine."""

    name: str
    text: str = ""
    added: str = ""


class Expect(Row):
    """Wait until all of it holds: a PDS state, bits of the statusword, values of entries."""

    state: str = ""
    status_bits: tuple[str, ...] = ()
    values: tuple[tuple[str, int | str], ...] = ()
    text: str = ""
    added: str = ""


class Wait(Row):
    """Let time pass."""

    milliseconds: int
    text: str = ""
    added: str = ""


class Input(Row):
    """Set inputs of the axis from outside: (name, 0 or 1)."""

    levels: tuple[tuple[str, int], ...]
    text: str = ""
    added: str = ""


if TYPE_CHECKING:
    Step: TypeAlias = Write | Command | Expect | Wait | Input


class Recipe(Row):
    """A worked example of a mode."""

    name: str
    mode: str
    title: str
    steps: tuple[Step, ...]
    text: str = ""
    source: str = ""
