"""Compares the tables that describe what the drive and the node do: states, commands, homing, ramp, messages."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from odsmith.coverage.cells import Cell, cell
from odsmith.coverage.manual_text import TextCell, TextTable
from odsmith.coverage.printed import alike, number
from odsmith.model import Device, Emergency, HomingMethod
from odsmith.vocabulary import AbortCode, PdsCommand

_RANGE = re.compile(r"0\.\.\.?(\d+)")
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "JUN", "JUL", "AUG", "SEP", "OCT", "NOV", "DEC")


# ---- state machine ---------------------------------------------------------------------------------------------------


def commands(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each command: bits of the controlword, and the transitions that it takes."""
    rows = table.body("Command")
    columns = [number(part.text.removeprefix("Bit ")) for part in rows[0]] if rows else []
    known = {command.title.casefold(): command for command in device.pds_commands}
    for row in rows[1:]:
        command = known.pop(row[0].text.replace("&", "and").casefold(), None)
        if command is None:
            yield cell(table, row[0], "command", "no such command", False, ["pds.commands"])
            continue
        path = f"pds.commands.{command.name}"
        yield cell(table, row[0], "command", command.title, True, [path])
        for printed, bit in zip(row, columns, strict=False):
            if bit is not None:
                modelled = _bit_of(command, bit)
                yield cell(table, printed, f"bit {bit}", modelled, printed.text == modelled, [f"{path}.control"])
        taken = {transition.number for transition in device.transitions if command.name in transition.by}
        shown = ", ".join(map(str, sorted(taken)))
        same = {number(part.strip()) for part in row[-1].text.split(",")} == taken
        yield cell(table, row[-1], "transitions", shown, same, [path])
    for command in known.values():
        yield cell(table, None, "command", command.title, False, [f"pds.commands.{command.name}"])


def _bit_of(command: PdsCommand, bit: int) -> str:
    if command.edge >> bit & 1:
        return "0-to-1"
    return str(command.value >> bit & 1) if command.mask >> bit & 1 else "x"


def states(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each state: the bits of the statusword from 15 down, x for any."""
    known = {state.title.casefold(): state for state in device.pds_states}
    for row in table.body("Status word"):
        state = known.pop(row[1].text.casefold(), None)
        if state is None:
            yield cell(table, row[1], "state", "no such state", False, ["pds.states"])
            continue
        path = f"pds.states.{state.name}"
        pattern = "".join(str(state.value >> bit & 1) if state.mask >> bit & 1 else "x" for bit in reversed(range(16)))
        same = row[0].text.replace(" ", "").removesuffix("h") == pattern
        yield cell(table, row[1], "state", state.title, True, [path])
        yield cell(table, row[0], "statusword", pattern, same, [f"{path}.status"])
    for state in known.values():
        yield cell(table, None, "state", state.title, False, [f"pds.states.{state.name}"])


# ---- motion ----------------------------------------------------------------------------------------------------------


def homing_methods(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each homing method."""
    known: dict[int | None, HomingMethod] = {method.method: method for method in device.homing_methods}
    for row in table.body("Method"):
        method = known.pop(number(row[0].text), None)
        shown = str(method.method) if method else "no such method"
        path = f"homing_methods.{method.name}" if method else "homing_methods"
        yield cell(table, row[0], "method", shown, method is not None, [path])
    for method in known.values():
        yield cell(table, None, "method", str(method.method), False, [f"homing_methods.{method.name}"])


def ramp(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each parameter of the ramp: its name with its symbol, and its object."""
    known = {parameter.symbol: parameter for parameter in device.ramp}
    for row in table.body("Parameter Name"):
        words = re.findall(r"\w+", re.sub(r"_\{(\w+)\}", r"\1", row[0].text))
        parameter = next((known.pop(word) for word in words if word in known), None)
        if parameter is None:
            yield cell(table, row[0], "parameter", "no such parameter", False, ["ramp"])
            continue
        path = f"ramp.{parameter.name}"
        obj = device.object(parameter.object)
        index = f"{obj.index:04X}h" if obj else "none"
        yield cell(table, row[0], "parameter", parameter.symbol, True, [path])
        yield cell(table, row[1], "object", index, row[1].text == index, [f"{path}.object"])
    for parameter in known.values():
        yield cell(table, None, "parameter", parameter.symbol, False, [f"ramp.{parameter.name}"])


# ---- messages --------------------------------------------------------------------------------------------------------


def emergencies(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each message: code, five additional bytes, description. Rows of one code come in the same order."""
    printed: defaultdict[int | None, list[Sequence[TextCell]]] = defaultdict(list)
    for row in table.body("Error code", width=7):
        if row[0].text:  # the second line of the heading has none
            printed[number(row[0].text)].append(row)
    modelled: defaultdict[int | None, list[Emergency]] = defaultdict(list)
    for emergency in device.emergencies:
        modelled[emergency.code].append(emergency)
    for code in dict.fromkeys([*printed, *modelled]):
        for line, message in zip_longest(printed[code], modelled[code]):
            if line is None:
                shown = f"{message.code:04X}h {message.title}"
                yield cell(table, None, "message", shown, False, [f"emergencies.{message.name}"])
            elif message is None:
                yield cell(table, line[0], "message", "no such message", False, ["emergencies"])
            else:
                yield from _emergency(device, table, line, message)


def _emergency(device: Device, table: TextTable, row: Sequence[TextCell], message: Emergency) -> Iterator[Cell]:
    path = f"emergencies.{message.name}"
    yield cell(table, row[0], "code", f"{message.code:04X}h", True, [f"{path}.code"])
    for ordinal, (printed, byte) in enumerate(zip(row[1:6], message.bytes, strict=False), 1):
        axes = _RANGE.fullmatch(printed.text)
        same = axes is not None and int(axes[1]) + 1 == device.axes if byte == "axis" else number(printed.text) == byte
        yield cell(table, printed, f"additional byte {ordinal}", str(byte), same, [f"{path}.bytes"])
    yield cell(table, row[6], "title", message.title, alike(row[6].text, message.title), [f"{path}.title"])


def abort_codes(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each SDO abort code."""
    known: dict[int | None, AbortCode] = {code.code: code for code in device.abort_codes}
    for row in table.body("Abort code"):
        code = known.pop(number(row[0].text), None)
        if code is None:
            yield cell(table, row[0], "abort code", "no such code", False, ["abort_codes"])
            continue
        path = f"abort_codes.{code.name}"
        yield cell(table, row[0], "abort code", f"{code.code:08X}h", True, [f"{path}.code"])
        yield cell(table, row[1], "title", code.title, alike(row[1].text, code.title), [f"{path}.title"])
    for code in known.values():
        yield cell(table, None, "abort code", f"{code.code:08X}h", False, [f"abort_codes.{code.name}"])


def revisions(device: Device, table: TextTable) -> Iterator[Cell]:
    """A row for each version of the firmware, with its date."""
    known = {revision.version: revision for revision in device.identity.firmware}
    for row in table.body("Version", "Date"):
        revision = known.pop(row[0].text, None)
        if revision is None:
            yield cell(table, row[0], "version", "no such version", False, ["device.firmware"])
            continue
        year, _, rest = row[1].text.partition("-")
        month, _, day = rest.partition("-")
        month = f"{_MONTHS.index(month.upper()) + 1:02}" if month.upper() in _MONTHS else month
        same = revision.date == f"{year}-{month}-{day}"
        yield cell(table, row[0], "version", revision.version, True, ["device.firmware"])
        yield cell(table, row[1], "date", revision.date, same, ["device.firmware"])
    for revision in known.values():
        yield cell(table, None, "version", revision.version, False, ["device.firmware"])
