"""Every controlword in every state of an axis: what C and Python make of it is what the specification says.

The judge is the oracle (axis.py), which has states, commands and transitions from the model of the device, which is the
YAML; it has no code and no tables of a runtime. Of the eight states one is out of reach: no turn ends in NOT READY TO
SWITCH ON.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property

import pytest
from tests.cross.axis import Axis
from tests.cross.events import download
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.oracle import Address, Dialogue
from tests.cross.situations import OUT_OF_REACH, SITUATIONS, Situation
from tests.cross.testee import Bench

from odsmith.model import Device
from odsmith.vocabulary import Transition

NODE_ID = 5

each_situation = pytest.mark.parametrize("situation", SITUATIONS, ids=lambda situation: situation.name)

each_prompt_situation = pytest.mark.parametrize(
    "situation",
    [situation for situation in SITUATIONS if not situation.is_slow],
    ids=lambda situation: situation.name,
)


# ---- the judge -------------------------------------------------------------------------------------------------------

Outcome = tuple[str, bool]
"""A state, and whether there is power."""


class Judge:
    """What a word makes of an axis in a situation. `dialogue` leads there."""

    def __init__(self, device: Device, situation: Situation, axis: int = 0) -> None:
        self.dialogue = Dialogue(device, NODE_ID)
        self.dialogue.advance(1000)
        situation.play(self.dialogue, axis)
        self._axis = self.dialogue.oracle.axes[axis]
        assert self._axis.state == situation.state

    def outcome(self, word: int) -> Outcome:
        axis, _ = self._after(word)
        return axis.state, axis.has_power

    def taken(self, word: int) -> list[tuple[str, Transition]]:
        """The commands of a word that lead somewhere, one after the other, and where."""
        return self._after(word)[1]

    def _after(self, word: int) -> tuple[Axis, list[tuple[str, Transition]]]:
        axis = copy(self._axis)
        taken = axis.command(word)
        return axis, taken

    @cached_property
    def by_low_octet(self) -> list[Outcome]:
        """Outcomes of all words: what no command looks at makes no difference."""
        assert all(not (command.mask | command.edge) & ~0xFF for command in self._axis.device.pds_commands)
        return [self.outcome(octet) for octet in range(0x100)]

    def address(self, role: str) -> Address:
        return self.dialogue.oracle.parts[self._axis.number, role].address

    def decode(self, statusword: int) -> str:
        return self._axis.machine.decode(statusword)


# ---- testees ---------------------------------------------------------------------------------------------------------


class Rewind:
    """Brings an axis of a Python node back to where it was."""

    def __init__(self, bench: Bench, axis: int) -> None:
        parts = bench.node.axes[axis]
        self._fsa, *self._others = (
            (vars(part), dict(vars(part))) for part in (parts.fsa, parts.motor, parts.motion, parts.mode)
        )

    def __call__(self) -> None:
        variables, values = self._fsa
        if (variables["state"], variables["phase"]) != (values["state"], values["phase"]):
            for others, before in self._others:
                others.update(before)
        variables.update(values)


def arrive(answer: Callable[[str], list[str]], judge: Judge) -> None:
    difference = judge.dialogue.difference(map(answer, judge.dialogue.lines))
    assert not difference, difference
    assert not any(" 80 " in line for lines in judge.dialogue.expected for line in lines), "an abort"


def assert_all(judge: Judge, found: list[Outcome], shown: Callable[[int], str] = "{:04X}h".format) -> None:
    """Each of the 65,536 words has the outcome that the judge expects."""
    expected = judge.by_low_octet
    wrong = [word for word, outcome in enumerate(found) if outcome != expected[word & 0xFF]]
    assert not wrong, f"{len(wrong)} words, the first is {shown(wrong[0])}: {found[wrong[0]]}"
    assert len(found) == 0x10000


def test_situations_are_all_that_there_are(tmcm3230: Device) -> None:
    """All states but the one out of reach; all transitions of all commands, each by each of its commands."""
    states = {state.name for state in tmcm3230.pds_states}
    assert states == {situation.state for situation in SITUATIONS} | {OUT_OF_REACH}
    commands = {command.name for command in tmcm3230.pds_commands}
    assert not any(OUT_OF_REACH in each.start and commands & {*each.by} for each in tmcm3230.transitions)

    taken = {
        (transition.number, command)
        for judge in (Judge(tmcm3230, situation) for situation in SITUATIONS)
        for word in range(0x100)
        for command, transition in judge.taken(word)
    }
    assert taken == {(each.number, by) for each in tmcm3230.transitions for by in each.by if by in commands}


@pytest.mark.parametrize(("name", "axis"), [("tmcm3230", 0), ("tmcm6212", 5)])
@each_situation
def test_python_by_sdo(
    situation: Situation,
    name: str,
    axis: int,
    start_python: Callable[..., Bench],
    request: pytest.FixtureRequest,
) -> None:
    """All low octets, each with some high octet, over the bus."""
    device: Device = request.getfixturevalue(name)
    judge = Judge(device, situation, axis)
    bench = start_python(device, node_id=NODE_ID)
    arrive(bench.answer, judge)
    rewind = Rewind(bench, axis)
    (line,) = download(NODE_ID, *judge.address("controlword"), b"\x34\x12")
    for octet in range(0x100):
        word = octet | octet * 0x9D & 0xFF00 ^ 0xA500
        told = bench.answer(line.replace("34 12", word.to_bytes(2, "little").hex(" ").upper()))
        assert told[0].startswith(f"TX {0x580 + NODE_ID:03X} 60"), told
        statusword = bench.node.read(*judge.address("statusword"))
        assert isinstance(statusword, bytes)
        outcome = judge.decode(int.from_bytes(statusword, "little")), bench.node.axes[axis].motor.is_powered
        assert outcome == judge.outcome(word), f"{word:04X}h"
        resets = [frame for frame in told if frame.startswith(f"TX {0x80 + NODE_ID:03X} 00 00")]
        assert bool(resets) == any(transition.number == 15 for _, transition in judge.taken(word)), f"{word:04X}h"
        rewind()


@pytest.mark.slow
@each_prompt_situation
def test_python(situation: Situation, tmcm3230: Device, start_python: Callable[..., Bench]) -> None:
    """All words, handed to the state machine of the axis itself."""
    judge = Judge(tmcm3230, situation)
    bench = start_python(tmcm3230, node_id=NODE_ID)
    arrive(bench.answer, judge)
    rewind = Rewind(bench, 0)
    fsa, motor = bench.node.axes[0].fsa, bench.node.axes[0].motor
    found = []
    for word in range(0x10000):
        fsa.command(word)
        found.append((fsa.state, motor.is_powered))
        rewind()
    assert_all(judge, found)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "axis"), [("tmcm3230", 0), ("tmcm6212", 5)])
@each_situation
def test_c(situation: Situation, name: str, axis: int, start_c: StartC, request: pytest.FixtureRequest) -> None:
    """All words, by SDO."""
    device: Device = request.getfixturevalue(name)
    judge = Judge(device, situation, axis)
    bench = start_c(device, node_id=NODE_ID)
    arrive(bench.answer, judge)
    results = bench.controlwords(axis)
    outcomes = {result: (judge.decode(result & 0xFFFF), bool(result >> 16)) for result in set(results)}
    assert_all(judge, [outcomes[result] for result in results])
