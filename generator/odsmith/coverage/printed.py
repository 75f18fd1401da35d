"""How a manual prints things, and what counts as the same: each tolerance is one function here.

A manual writes `80h` for 128, SIGNED8 for INTEGER8 and a dash where it states nothing. What no function here accepts
is a difference, and needs an erratum.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from odsmith.canopen_types import DataType, ObjectType, PdoDirection
from odsmith.fields import FieldError, parse_range
from odsmith.model import Allowed, Default, Entry

_NUMBER = r"-?[0-9]+|[0-9A-Fa-f]+h"
_HEX = re.compile(r"[0-9A-Fa-f]+h")
_INTERVAL = re.compile(rf"({_NUMBER})(?:\s*\.\.\.?\s*({_NUMBER}))?")
_UNIT = re.compile(r"\s*\[[^]]*\]$")
_REMARK = re.compile(r"\s*\([^)]*\)$")
_WITH_NODE_ID = re.compile(r"([0-9A-Fa-f]+h) \+ Node.ID")
_DASHES = frozenset({"", "-", "\u2013", "\u2014"})
_OBJECT_TYPES = {"variable": ObjectType.VAR, "array": ObjectType.ARRAY, "record": ObjectType.RECORD}


def number(text: str) -> int | None:
    """A number, decimal or with an h behind it; None for anything else."""
    if _HEX.fullmatch(text):
        return int(text[:-1], 16)
    return int(text) if re.fullmatch(r"-?[0-9]+", text) else None


def same_title(printed: str, modelled: str) -> bool:
    """Titles are the same whatever their capitals."""
    return _folded(printed) == _folded(modelled)


def same_object_type(printed: str, modelled: ObjectType) -> bool:
    """`Variable` is VAR."""
    return _OBJECT_TYPES.get(printed.casefold()) == modelled


def same_data_type(printed: str, modelled: Iterable[DataType]) -> bool:
    """`SIGNED8` is INTEGER8, `Visible String` is VISIBLE_STRING; all sub-indices of an object have the type printed."""
    name = re.sub(r"^SIGNED", "INTEGER", printed.upper().replace(" ", "_"))
    return set(modelled) == {name}


def same_mapping(printed: str, modelled: PdoDirection) -> bool:
    """`yes` is any direction."""
    return printed.casefold() == ("no" if modelled is PdoDirection.NO else "yes")


def intervals(text: str) -> Allowed | None:
    """The values that `0...63`, `0/1`, `0 / 2...15`, `20,50` or `2` allow, a unit in brackets left out; None for
    anything else."""
    pieces = []
    for piece in re.split(r"[/,]", _UNIT.sub("", text)):
        match = _INTERVAL.fullmatch(piece.strip())
        if not match:
            return None
        pieces.append("..".join(str(number(end)) for end in match.groups() if end))
    try:
        return parse_range(", ".join(pieces))
    except FieldError:  # the larger number first
        return None


def same_range(printed: str, entry: Entry) -> bool:
    """A range says which values are allowed, not how others are refused: `0...2` is the same as the values 0, 1 and 2.
    The name of the type, a dash or `see above` allow all that the type can hold."""
    if printed in _DASHES or printed.casefold().startswith("see ") or same_data_type(printed, [entry.type]):
        return entry.allowed is None
    found = intervals(printed)
    return found is not None and entry.allowed is not None and found.intervals == entry.allowed.intervals


def same_default(printed: str, modelled: Default | None) -> bool:
    """A dash, `no` or nothing states no default; a number may have a remark in brackets behind it, a sum with the
    node-ID has it in the model too."""
    if printed in _DASHES or printed == "no":
        return modelled is None
    if modelled is None:
        return False
    if modelled.text is not None:
        return printed == modelled.text
    with_node_id = _WITH_NODE_ID.fullmatch(printed)
    value = number(with_node_id[1] if with_node_id else _REMARK.sub("", printed))
    return value == modelled.number and bool(with_node_id) == modelled.node_id


def alike(printed: str, identifier: str, text: str = "") -> bool:
    """An identifier fits what is printed if half of its words occur there, or if each word that is printed occurs in
    it or in the text of our own. Numbers and words such as bit and of do not count; endings neither."""
    theirs, ours = _words(printed), _words(identifier)
    found = sum(any(_akin(ours_word, word) for word in theirs) for ours_word in ours)
    if ours and 2 * found >= len(ours):
        return True
    known = [*ours, *_words(text)]
    return bool(theirs) and all(any(_akin(word, other) for other in known) for word in theirs)


def _words(text: str) -> list[str]:
    return [word for word in re.findall(r"[a-z0-9]+", text.casefold()) if word not in _STOP and not word.isdigit()]


_STOP = frozenset({"a", "and", "bit", "i", "into", "not", "of", "on", "the", "to"})


def _akin(first: str, second: str) -> bool:
    """The same word, or one with another ending."""
    short, long = sorted((first, second), key=len)
    return short == long or (len(short) >= 4 and long.startswith(short))


def _folded(text: str) -> str:
    return " ".join(text.casefold().removesuffix(".").split())
