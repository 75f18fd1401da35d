"""What mutants are told, and who judges the answers.

A talk is a dialogue with a device from the beginning: a scenario, perhaps interrupted, or a probe of the oracle. The
ramp generators are asked without a device. Dialogues at random are left out: a mutant that only they catch would be
caught today and not tomorrow.
"""

from __future__ import annotations

import random
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from tests.cross.oracle import Dialogue, Item
from tests.cross.scenario import Scenario, all_scenarios
from tests.mutants import ramps

from odsmith.canopen_types import DataType
from odsmith.model import Device

NODE_ID = 5

TOGETHER = 6
"""Objects that one probe looks at."""

EACH = 3
"""A reset interrupts one scenario in three, the same ones when others are added."""

Answers = Sequence[tuple[str, ...]]


@dataclass(frozen=True)
class Talk:
    """`accepts` tells whether `judge` has anything against the answers."""

    name: str
    device: str
    options: dict[str, int]
    lines: tuple[str, ...]
    judge: str
    accepts: Callable[[Answers], bool]

    def work(self, answers: Answers) -> int:
        """What there is to do: lines to read and to write, and milliseconds; the same on every machine."""
        passing = sum(int(line[2:]) // 1000 for line in self.lines if line.startswith("T "))
        return len(self.lines) + sum(map(len, answers)) + passing


def all_talks(devices: Sequence[Device]) -> list[Talk]:
    talks = [_scenario(scenario) for scenario in all_scenarios()]
    chosen = (scenario for scenario in all_scenarios() if not zlib.crc32(scenario.name.encode()) % EACH)
    talks += map(_interrupted, chosen)
    for device in devices:
        if device.object("error_register"):  # the oracle knows devices as complete as real ones
            talks += _probes(device)
    return [*talks, *_ramps()]


# ---- scenarios -------------------------------------------------------------------------------------------------------


def _scenario(scenario: Scenario) -> Talk:
    def accepts(answers: Answers) -> bool:
        return all(step.accepts(answer) for step, answer in zip(scenario.steps, answers, strict=True))

    return Talk(scenario.name, scenario.device, scenario.options, tuple(scenario.lines), "scenarios", accepts)


def _interrupted(scenario: Scenario) -> Talk:
    lines = (*scenario.interrupted, "DUMP 6040-6064")  # all objects would take ten times as long as all the rest
    return Talk(f"{scenario.name}, interrupted", scenario.device, scenario.options, lines, "", lambda _: True)


# ---- ramps -----------------------------------------------------------------------------------------------------------

SIZES = {"small": (4, 20), "middle": (20, 1000), "large": (1000, 10**6, 10**9), "huge": (10**9, 10**13, 10**15)}
"""Of the numbers: whether a tick is a little slower or not shows in small ones, what overflows in huge ones."""


def _ramps() -> Iterator[Talk]:
    for name, sizes in SIZES.items():
        lines = tuple(ramps.lines(sizes))
        yield Talk(f"{name} ramps", ramps.DEVICE, {}, lines, "", lambda _: True)
    for size in (10, 40, 300):
        lines = tuple(ramps.braking(size))
        yield Talk(f"braking from {size}", ramps.DEVICE, {}, lines, "", lambda _: True)


# ---- probes ----------------------------------------------------------------------------------------------------------


def _probes(device: Device) -> Iterator[Talk]:
    """Short dialogues that look at one object, one command of storage, or one PDO; the oracle judges them."""
    plain = Dialogue(device, NODE_ID)
    plain.dump()
    yield _probe(device, "power-on", plain)
    subjects: dict[int, list[Item]] = {}
    for item in plain.oracle.items.values():
        subjects.setdefault(item.address[0], []).append(item)
    chosen = [items for items in subjects.values() if items[0].object.axis in (None, 0, device.axes - 1)]
    for begin in range(0, len(chosen), TOGETHER):
        part = chosen[begin : begin + TOGETHER]
        name = f"objects {part[0][0].address[0]:04X}h to {part[-1][0].address[0]:04X}h"
        yield _probe(device, name, _told(device, partial(_objects, subjects=part)))
    yield _probe(device, "reset communication", _told(device, _reset_communication))
    for item in plain.oracle.items.values():
        if item.entry.groups:
            yield _probe(
                device, f"store {item.address[0]:04X}h:{item.address[1]}", _told(device, partial(_store, command=item))
            )


def _probe(device: Device, name: str, dialogue: Dialogue) -> Talk:
    def accepts(answers: Answers) -> bool:
        return not dialogue.difference(answers)

    return Talk(
        f"{device.identifier} {name}",
        device.identifier,
        {"node_id": dialogue.node_id},
        tuple(dialogue.lines),
        "oracle",
        accepts,
    )


def _told(device: Device, write: Callable[[Dialogue], None]) -> Dialogue:
    dialogue = Dialogue(device, NODE_ID)
    write(dialogue)
    return dialogue


def _objects(dialogue: Dialogue, subjects: Sequence[Sequence[Item]]) -> None:
    for items in subjects:
        _object(dialogue, items)
        if any(item.entry.signatures for item in items):  # a command may have led elsewhere
            dialogue.power()


def _reset_communication(dialogue: Dialogue) -> None:
    """Every parameter has another value than its default; the objects from 2000h on keep it."""
    _change_everything(dialogue, lambda item: item.entry.stored != "never" or item.entry.effect == "value")
    dialogue.nmt(0x82)
    dialogue.dump()


def _object(dialogue: Dialogue, items: Sequence[Item]) -> None:
    """Each entry is read, written at its limits and beside them, and mapped."""
    for item in items:
        dialogue.upload(item.address)
        for value in _values(item):
            dialogue.download(item.address, _octets(item, value))
            dialogue.upload(item.address)
        for length in (item.size - 1, item.size + 1):
            dialogue.download(item.address, bytes(length))
    if not items[0].object.object.pdo:
        for scope in (2, 3):
            _map(dialogue, items, scope)
    index = items[0].address[0]
    dialogue.upload((index, items[-1].address[1] + 1))
    dialogue.upload((index + 1, 0))


def _map(dialogue: Dialogue, items: Sequence[Item], scope: int) -> None:
    pdo = dialogue.oracle.pdos.get((scope, 1))
    if pdo is None:
        return
    cob_id, count, entry = (pdo[role][0] for role in ("pdo_cob_id", "pdo_mapped_count", "pdo_mapping"))
    dialogue.download(cob_id.address, _octets(cob_id, 0xC0000185))
    dialogue.download(count.address, b"\0")
    for item in items:
        index, sub = item.address
        value = index << 16 | sub << 8 | item.entry.bit_length & 0xFF
        dialogue.download(entry.address, _octets(entry, value))


def _store(dialogue: Dialogue, command: Item) -> None:
    """Everything that can be kept has another value than its default; a command is given; power goes and comes back."""
    items = dialogue.oracle.items
    save = next(item for item in items.values() if item.entry.groups and item.entry.effect == "store")
    _change_everything(dialogue, lambda item: item.entry.stored != "never")
    if command.entry.effect == "restore":
        dialogue.download(save.address, _octets(save, save.entry.signatures[0].value))
    dialogue.download(command.address, _octets(command, command.entry.signatures[0].value))
    dialogue.say("NVM")
    dialogue.power()
    dialogue.dump()


def _change_everything(dialogue: Dialogue, wanted: Callable[[Item], bool]) -> None:
    numbers = random.Random(1)
    for item in dialogue.oracle.items.values():
        if not (wanted(item) and item.entry.type.integer) or item.entry.role in ("node_id", "can_bit_rate"):
            continue
        now = int.from_bytes(dialogue.oracle.values[item.address], "little", signed=item.entry.type.signed)
        others = [value for value in _values(item) if value != now and _is_allowed(item, value)]
        if others:
            dialogue.download(item.address, _octets(item, numbers.choice(others)))


def _values(item: Item) -> list[int]:
    """Limits, what lies beside them, named values and signatures, as far as the type can hold them."""
    entry = item.entry
    if not entry.type.integer or not entry.access.writable:
        return [0] if entry.type is not DataType.VISIBLE_STRING else []
    intervals = entry.allowed.intervals if entry.allowed else ((entry.type.low, entry.type.high),)
    found = {value for low, high in intervals for value in (low - 1, low, high, high + 1)}
    found |= {signature.value for signature in entry.signatures}
    return sorted(value for value in found if entry.type.low <= value <= entry.type.high)


def _is_allowed(item: Item, value: int) -> bool:
    return item.entry.allowed is None or value in item.entry.allowed


def _octets(item: Item, value: int) -> bytes:
    return (value & ((1 << 8 * item.size) - 1)).to_bytes(item.size, "little")
