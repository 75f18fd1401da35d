"""The enumerations of a package: named values, bits, and the words of the vocabulary."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from odsmith import names
from odsmith.backends.python.names import (
    MODE_WORDS,
    bits_class,
    has_mode_bits,
    mode_bits_class,
    values_class,
    word_bits,
)
from odsmith.backends.python.source import Code, Hex, assignment, docstring
from odsmith.model import Bit, Device, Entry, NamedValue, Object
from odsmith.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class Enumeration:
    """A class of members `NAME = value, "text"`, and other names for it."""

    name: str
    doc: str
    members: tuple[str, ...]
    aliases: tuple[str, ...] = ()
    base: str = "Word"
    """The class of `odsmith_runtime.choices` that words are made of."""


def value_tables(device: Device) -> Iterator[Enumeration]:
    """One class for each value table; entries with the same one share it under each of their names."""
    tables_found: dict[tuple[NamedValue, ...], list[tuple[Object, Entry]]] = {}
    for obj in device.objects:
        for entry in obj.entries:
            if entry.values:
                tables_found.setdefault(entry.values, []).append((obj, entry))
    for values, found in tables_found.items():
        name, *aliases = (values_class(obj, entry) for obj, entry in found)
        members = ((value.name, (value.value, value.text)) for value in values)
        yield _enumeration(name, f"Values of {_called(*found[0])}.", members, aliases)


def bit_tables(device: Device) -> Iterator[Enumeration]:
    """The same for bit tables, and the words whose bits depend on the mode, once for each mode."""
    tables_found: dict[tuple[Bit, ...], list[tuple[Object, Entry]]] = {}
    for obj in device.objects:
        for entry in obj.entries:
            if entry.bits:
                tables_found.setdefault(entry.bits, []).append((obj, entry))
    for bits, found in tables_found.items():
        name, *aliases = (bits_class(obj, entry) for obj, entry in found)
        yield _enumeration(name, f"Bits of {_called(*found[0])}.", _bit_members(bits), aliases)
    for mode in device.modes:
        for word in MODE_WORDS:
            if has_mode_bits(device, mode, word):
                doc = f"Bits of the {word} in {mode.title}."
                yield _enumeration(mode_bits_class(mode, word), doc, _bit_members(word_bits(device, mode, word)))


def _bit_members(bits: Iterable[Bit]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    for bit in bits:
        value = Code(f"1 << {bit.low}") if bit.low == bit.high else Hex(bit.mask, 2)
        yield bit.name, (value, bit.text) if bit.supported else (value, bit.text, False)


def _enumeration(
    name: str, doc: str, members: Iterable[tuple[str, tuple[Any, ...]]], aliases: Iterable[str] = ()
) -> Enumeration:
    lines = (assignment(names.constant(member), values, 4) for member, values in members)
    return Enumeration(name, docstring(doc, 4), tuple(lines), tuple(aliases))


def _called(obj: Object, entry: Entry) -> str:
    """`Chopper mode (2093h)`; with the title of the entry where the object has several."""
    title = obj.title.replace("{number}", "n")
    if len(obj.entries) == 1:
        return f"{title} ({obj.index:04X}h)"
    return f"{title}: {entry.title} ({obj.index:04X}h:{entry.sub:02X})"


def codes(vocabulary: Vocabulary) -> Iterator[Enumeration]:
    """Numbers of the standards by name."""
    yield _enumeration(
        "AbortCode",
        "SDO abort codes (CiA 301, table 22).",
        ((item.name, (Hex(item.code, 8), item.title)) for item in vocabulary.abort_codes),
    )
    yield _enumeration(
        "ModeCode",
        "Modes of operation as 6060h takes them (CiA 402).",
        ((item.name, (item.code, item.title)) for item in vocabulary.mode_codes),
    )
    yield _enumeration(
        "NmtCommand",
        "NMT node control commands (CiA 301, clause 7.2.8.3.1).",
        ((item.name, (item.code, item.text)) for item in vocabulary.nmt_commands),
    )
    yield _enumeration(
        "NmtState",
        "NMT states as the heartbeat carries them (CiA 301, clause 7.2.8.3.2).",
        ((item.name, (item.code, item.text)) for item in vocabulary.nmt_states),
    )
    yield _enumeration(
        "Signature",
        "Numbers that command objects want before they act.",
        ((item.name, (Hex(item.value, 8), item.text)) for item in vocabulary.signatures.values()),
    )


def register_bits(vocabulary: Vocabulary) -> Iterator[Enumeration]:
    yield _enumeration(
        "ErrorRegister",
        "Bits of the error register 1001h (CiA 301, clause 7.5.2.2).",
        ((item.name, (Code(f"1 << {item.bit}"), item.text)) for item in vocabulary.register_bits.values()),
    )


def words(vocabulary: Vocabulary) -> Iterator[Enumeration]:
    """Names that the rows of devices use."""
    yield _word_list("Condition", "What raises an emergency.", vocabulary.conditions.values())
    yield _effects(vocabulary)
    yield _word_list("PdsCommand", "Commands of the state machine (CiA 402).", vocabulary.pds_commands)
    yield _word_list("PdsEvent", "Events of the state machine.", vocabulary.pds_events)
    yield _word_list("PdsState", "States of the state machine (CiA 402).", vocabulary.pds_states)
    yield _word_list("Reaction", "What an axis does about an emergency.", vocabulary.reactions.values())


def _effects(vocabulary: Vocabulary) -> Enumeration:
    members = (
        (effect.name, (effect.name, effect.text, True) if effect.to_driver else (effect.name, effect.text))
        for effect in vocabulary.effects.values()
    )
    return replace(_enumeration("Effect", "What writing an entry does.", members), base="EffectWord")


def _word_list(name: str, doc: str, words: Iterable[Any]) -> Enumeration:
    return _enumeration(name, doc, ((word.name, (word.name, word.text)) for word in words))
