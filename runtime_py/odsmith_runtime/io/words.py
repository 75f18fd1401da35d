"""Values of a device in words: numbers with their units, states, modes, bits and choices by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from ..choices import Bits
    from ..entries import Entry
    from ..state_machine import PdsCommandInfo, StateMachine
    from ..units import Unit

    Known = Callable[[str, int | None], int | None]
    """The value of the object of a name, on an axis, as it was last seen; None if it never was."""


def describe(package: ModuleType, entry: Entry[Any], octets: bytes, known: Known) -> str:
    """The value that octets stand for, as a reader wants it."""
    try:
        value = entry.decode(octets)
    except ValueError as error:
        return f"{octets.hex(' ') or 'nothing'} ({error})"
    if isinstance(value, (str, bytes)):
        return repr(value) if isinstance(value, str) else value.hex(" ")
    if not isinstance(value, int):
        return str(value)
    number = int(value)
    for name, signature in entry.signatures:
        if number == signature:
            return f"{name}, the signature {number:08X}h"
    if entry.role in ("statusword", "controlword"):
        return _word(package, entry, number, known)
    if entry.role == "pdo_mapping":
        return _mapped(package, number)
    if entry.bits:
        return _with_bits(number, entry.bits(number), len(octets))
    if entry.values:
        choice = entry.values._value2member_map_.get(number)
        return f"{number} ({choice.name.lower()})" if choice else str(number)
    unit = entry.unit
    return f"{number} {_chosen(package, unit, entry.axis, known).symbol}" if unit else str(number)


def set_bits(bits: Bits, without: int = 0) -> list[str]:
    """The names of the bits that are set, and of bit fields with their number; those of a mask are left out."""
    names = []
    for name, member in type(bits).__members__.items():
        if member & without or not member & bits:
            continue
        is_field = member & (member - 1)
        names.append(f"{name.lower()} {bits.field(member)}" if is_field else name.lower())
    return names


def _with_bits(number: int, bits: Bits, octets: int) -> str:
    names = ", ".join(set_bits(bits))
    return f"{number:0{2 * octets}X}h ({names})" if names else f"{number:0{2 * octets}X}h"


def _word(package: ModuleType, entry: Entry[Any], number: int, known: Known) -> str:
    """A controlword or statusword: what it commands or shows, then the bits that the present mode gives a meaning."""
    machine: StateMachine | None = getattr(package, "STATE_MACHINE", None)
    if machine is None:
        return f"{number:04X}h"
    mode = package.MODES.get(known("modes_of_operation_display", entry.axis) or 0)
    if entry.role == "statusword":
        state = machine.decode(number)
        meaning, mask = (state.title, state.mask) if state else ("no known state", 0)
        flags = mode.statusword if mode else entry.bits
    else:
        before = known("controlword", entry.axis) or 0
        commands = _acting(machine, number, before, known("statusword", entry.axis))
        meaning, mask = ", ".join(command.title for command in commands) or "no command", 0
        for command in machine.commands.values():
            mask |= command.mask | command.edge
        flags = mode.controlword if mode else entry.bits
    names = set_bits(flags(number), mask) if flags else []
    return f"{number:04X}h {'; '.join([meaning, *([', '.join(names)] if names else [])])}"


def _acting(machine: StateMachine, number: int, before: int, status: int | None) -> list[PdsCommandInfo]:
    """The commands that a controlword gives; where the state was seen, those of them that do something in it."""
    given = [command for command in machine.commands.values() if command.matches(number, before)]
    state = machine.decode(status) if status is not None else None
    names = {name for transition in machine.leaving(state.name) for name in transition.by} if state else set()
    return [command for command in given if command.name in names] or given


def _mapped(package: ModuleType, number: int) -> str:
    entry = mapped_entry(package, number)
    return f"{number:08X}h ({entry.label})" if entry else f"{number:08X}h"


def mapped_entry(package: ModuleType, number: int) -> Entry[Any] | None:
    """The entry that an entry of a PDO mapping names (CiA 301, 7.4.8.1.1)."""
    found = package.DICTIONARY.get(number >> 16)
    sub = number >> 8 & 0xFF
    return found[sub] if found is not None and sub in found else None


def _chosen(package: ModuleType, unit: Unit, axis: int | None, known: Known) -> Unit:
    """A unit that an object chooses, where that object was seen."""
    choice = known(unit.selected_by, axis) if unit.selected_by else None
    name = dict(unit.options).get(choice, "") if choice is not None else ""
    chosen: Unit = package.UNITS[name] if name else unit
    return chosen
