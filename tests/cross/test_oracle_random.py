"""SDO dialogues that nobody wrote, PDOs set up in any order and axes driven by anybody among them.

C, Python and the oracle, which knows no clock, agree on each answer, and on every value in the end, also if the clock
wraps in between.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.cross.clocks import CLOCKS
from tests.cross.events import octets
from tests.cross.library import StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.oracle import PRE_OPERATIONAL, RESET_COMMUNICATION, RESET_NODE, START, STOP, Address, Dialogue, Item
from tests.cross.set_points import RAMP, SET_POINTS, STARTS, WORDS
from tests.cross.testee import Bench

from odsmith.canopen_types import PdoDirection
from odsmith.model import Device

pytestmark = pytest.mark.slow

Step = Callable[[Dialogue], None]
Steps = st.SearchStrategy[Step]

CAN_IDS = (0, 0x7F, 0x80, 0x100, 0x101, 0x180, 0x181, 0x201, 0x205, 0x580, 0x581, 0x601, 0x680, 0x6DF, 0x6E0, 0x7FF)

COB_IDS = st.builds(
    lambda can_id, flags, odd: can_id | flags << 30 | odd,
    st.sampled_from(CAN_IDS),
    st.sampled_from([3, 3, 1, 1, 1, 2, 0]),
    st.sampled_from([0, 0, 0, 0, 0, 1 << 29, 1 << 11]),
)


def download(at: Address, data: bytes, *, segmented: bool = False, sized: bool = True) -> Step:
    return lambda dialogue: dialogue.download(at, data, segmented=segmented, sized=sized)


def write(item: Item, value: int) -> Step:
    return download(item.address, (value & ((1 << 8 * item.size) - 1)).to_bytes(item.size, "little"))


def put(axis: int, role: str, value: int) -> Step:
    """Nothing where the device has no such entry."""

    def play(dialogue: Dialogue) -> None:
        item = dialogue.oracle.parts.get((axis, role))
        if item is not None:
            dialogue.download(item.address, octets(value, item.size))

    return play


def wait(us: int) -> Step:
    return lambda dialogue: dialogue.advance(us)


def send(frame: bytes) -> Step:
    def play(dialogue: Dialogue) -> None:
        dialogue.sdo(frame)

    return play


class Words:
    """What steps are made of, for one device."""

    def __init__(self, device: Device) -> None:
        oracle = Dialogue(device).oracle
        self.axes, self.conditions = device.axes, device.conditions
        self.items = list(oracle.items.values())
        self.pdos = list(oracle.pdos.values())
        signatures = [signature.value for signature in device.signatures.values()]
        mappable = [item for item in self.items if item.entry.mapping is not PdoDirection.NO]
        mapped = st.one_of(st.sampled_from(mappable), st.sampled_from(mappable), st.sampled_from(self.items))
        self.mappings = st.one_of(
            st.just(0),
            st.builds(
                lambda item, wrong: (
                    item.address[0] << 16 | item.address[1] << 8 | (item.entry.bit_length ^ wrong) & 0xFF
                ),
                mapped,
                st.sampled_from([0, 0, 0, 0, 8, 1]),
            ),
        )
        numbers = st.one_of(st.integers(0, 12), st.integers(0, 0xFFFFFFFF), st.integers(-5, -1))
        self.values = st.one_of(numbers, numbers, COB_IDS, self.mappings, st.sampled_from(signatures))
        commands = [item for item in self.items if item.entry.signatures]
        communication = [item for item in self.items if item.address[0] < 0x2000]
        self.some_item = st.one_of(*(st.sampled_from(pool) for pool in (self.items, communication, commands)))

    def step(self) -> Steps:
        return st.one_of(self._pdo(), self._write(), self._write(), self._odd_write(), self._other(), *self.axis())

    def axis(self) -> list[Steps]:
        """Axes up and down their state machine, in any mode, with set-points, delays, faults, and time."""
        axes = st.sampled_from([0, 0, 0, self.axes - 1])
        waits = st.one_of(st.sampled_from([1000, 1000, 1000, 5000]), st.integers(1, 500_000)).map(wait)

        def some(role: str) -> Steps:
            return st.builds(put, axes, st.just(role), SET_POINTS[role])

        def begin(axis: int, start: tuple[int, ...], values: dict[str, int]) -> list[Step]:
            """In the order in which a master does it."""
            given = [put(axis, role, value) for role, value in values.items()]
            words = [put(axis, "controlword", word) for word in start[1:]]
            return [put(axis, "modes_of_operation", start[0]), wait(1000), *up(axis), *given, *words, wait(1000)]

        def up(axis: int) -> list[Step]:
            return [put(axis, "controlword", word) for word in (0x80, 6, 0xF)]

        roles = (*RAMP, "homing_method", "target_position", "target_velocity")
        values = st.fixed_dictionaries({role: SET_POINTS[role] for role in roles})
        starts = st.builds(begin, axes, st.sampled_from(STARTS), values)
        faults = st.builds(
            lambda axis, name, holds: lambda told: told.fault(axis, name, holds=holds),
            axes,
            st.sampled_from([name for name, condition in self.conditions.items() if condition.scope == "axis"]),
            st.sampled_from([True, False, False]),
        )
        word = st.builds(put, axes, st.just("controlword"), st.sampled_from(WORDS))
        value = st.sampled_from(sorted(SET_POINTS)).flatmap(some)
        module = st.one_of(
            faults,
            st.sampled_from([True, True, False]).map(lambda holds: lambda told: told.enable(holds)),
            st.sampled_from([0, 1, 2]).map(lambda state: download((0x1029, 2), bytes([state]))),
            st.sampled_from([START, START, STOP]).map(lambda code: lambda told: told.nmt(code)),
        )
        several = st.lists(st.one_of(word, value, some("modes_of_operation"), waits), min_size=2, max_size=6)
        return [st.one_of(axes.map(up), several, starts).map(_all), word, value, waits, module]

    def _write(self) -> Steps:
        """Any entry, with a value that may be in order; commands mostly with their signature."""
        limits = self.some_item.flatmap(
            lambda item: st.builds(write, st.just(item), st.one_of(*_limits(item), self.values))
        )
        orders = st.sampled_from([item for item in self.items if item.entry.signatures])
        return st.one_of(
            limits,
            st.builds(write, self.some_item, self.values),
            orders.map(lambda i: write(i, i.entry.signatures[0].value)),
        )

    def _odd_write(self) -> Steps:
        anywhere = st.tuples(st.integers(0, 0xFFFF), st.integers(0, 255))
        beside = self.some_item.map(lambda item: (item.address[0], item.address[1] + 1))
        address = st.one_of(self.some_item.map(lambda item: item.address), beside, anywhere)
        writes = st.builds(
            lambda at, data, segmented, sized: download(at, data, segmented=segmented, sized=sized),
            address,
            st.binary(max_size=16),
            st.booleans(),
            st.booleans(),
        )
        reads = address.map(lambda at: lambda dialogue: dialogue.upload(at))
        return st.one_of(writes, reads)

    def _pdo(self) -> Steps:
        """The procedure of a new mapping, perhaps without one of its steps, or with one of them twice; or one step."""

        def procedure(
            pdo: dict[str, list[Item]], cob_ids: list[int], mapping: list[int], count: int, left_out: int, twice: int
        ) -> Step:
            cob_id, mapped_count = pdo["pdo_cob_id"][0], pdo["pdo_mapped_count"][0]
            steps = [write(cob_id, cob_ids[0]), write(mapped_count, 0)]
            steps += [write(item, value) for item, value in zip(pdo["pdo_mapping"], mapping, strict=False)]
            steps += [write(mapped_count, count), write(cob_id, cob_ids[1])]
            if left_out < len(steps):
                del steps[left_out]
            if twice < len(steps):
                steps.insert(twice, steps[-1])

            return _all(steps)

        pdo = st.sampled_from(self.pdos[:2] + self.pdos)
        off = st.one_of(st.just(0xC0000201), COB_IDS)
        on = st.one_of(st.just(0x40000201), COB_IDS)
        whole = st.builds(
            procedure,
            pdo,
            st.tuples(off, on).map(list),
            st.lists(self.mappings, max_size=3),
            st.integers(0, 4),
            st.integers(0, 16),
            st.integers(0, 16),
        )
        entry = pdo.flatmap(lambda found: st.sampled_from([item for items in found.values() for item in items]))
        single = st.builds(write, entry, st.one_of(st.integers(0, 4), COB_IDS, self.mappings, self.values))
        return st.one_of(whole, single)

    def _other(self) -> Steps:
        """Frames that no master sends, resets, time, a memory that fails, power that goes."""
        usual = st.sampled_from([0x40, 0x21, 0x23, 0x60, 0x70, 0x00, 0x10, 0x01, 0x11, 0x80, 0xA0, 0xC0])
        at = self.some_item.map(lambda item: bytes([item.address[0] & 0xFF, item.address[0] >> 8, item.address[1]]))
        frames = st.builds(
            lambda command, address, data: bytes([command]) + address + data,
            st.one_of(usual, usual, st.integers(0, 255)),
            at,
            st.binary(min_size=4, max_size=4),
        )
        codes = st.sampled_from([START, START, STOP, PRE_OPERATIONAL, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION])
        return st.one_of(
            st.one_of(frames, frames, st.binary(max_size=8)).map(send),
            codes.map(lambda code: lambda told: told.nmt(code)),
            st.sampled_from([1, 999_999, 1_000_000]).map(lambda us: lambda told: told.advance(us)),
            st.sampled_from([False, False, True]).map(lambda fails: lambda told: told.memory(fails=fails)),
            st.builds(lambda s, reply: lambda told: told.callback(s, reply), st.integers(0, 3), st.binary(max_size=7)),
            st.just(Dialogue.power),
        )


def _all(steps: list[Step]) -> Step:
    def play(dialogue: Dialogue) -> None:
        for step in steps:
            step(dialogue)

    return play


def _limits(item: Item) -> list[st.SearchStrategy[int]]:
    entry = item.entry
    intervals = entry.allowed.intervals if entry.allowed else ((entry.type.low, entry.type.high),)
    if not entry.type.integer:
        return [st.integers(0, 255)]
    return [st.integers(low, high) for low, high in intervals[:4]] + [
        st.sampled_from([intervals[0][0] - 1, intervals[-1][1] + 1])
    ]


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_sdo(name: str, start_c: StartC, start_python: Callable[..., Bench], request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    steps = st.lists(Words(device).step(), min_size=5, max_size=40)

    @settings(suppress_health_check=[HealthCheck.too_slow])
    @given(node_id=st.sampled_from([0, 5, 127]), clock=st.sampled_from(CLOCKS), steps=steps)
    def agree(node_id: int, clock: int, steps: list[Step]) -> None:
        dialogue = Dialogue(device, node_id)
        for step in steps:
            step(dialogue)
        dialogue.nmt(PRE_OPERATIONAL)
        dialogue.dump()
        for runtime, start in (("C", start_c), ("Python", start_python)):
            difference = dialogue.difference(map(start(device, node_id=node_id, time=clock).answer, dialogue.lines))
            assert not difference, f"{runtime}:\n{difference}"

    agree()
