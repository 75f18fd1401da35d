"""Rows, units, emergencies and the state machine."""

from __future__ import annotations

import pickle
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime.emergencies import Emergency, EmergencyTable
from odsmith_runtime.rows import Named, Row
from odsmith_runtime.state_machine import PdsCommandInfo, PdsStateInfo, StateMachine, Transition
from odsmith_runtime.units import Unit

# ---- rows ------------------------------------------------------------------------------------------------------------


def test_a_row_has_its_columns_and_defaults() -> None:
    row = Named(name="x", text="What it is.")
    assert (row.name, row.title, row.text) == ("x", "", "What it is.")
    assert repr(row) == "Named(name='x', title='', text='What it is.')"


def test_a_row_cannot_be_changed() -> None:
    row = Named(name="x")
    with pytest.raises(AttributeError, match="name: a Named cannot be changed"):
        row.name = "y"  # type: ignore[misc]
    with pytest.raises(AttributeError, match="cannot be changed"):
        del row.name
    assert row.name == "x"


def test_columns_are_checked() -> None:
    with pytest.raises(TypeError, match="Named has no column 'colour'"):
        Named(name="x", colour="red")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="Named lacks the column 'name'"):
        Named(title="x")  # type: ignore[call-arg]


def test_rows_are_equal_by_identity_and_can_be_copied() -> None:
    row = Named(name="x")
    assert row != Named(name="x")
    assert {row: 1}[row] == 1
    assert vars(pickle.loads(pickle.dumps(row))) == vars(row)


def test_a_row_without_columns() -> None:
    class Empty(Row):
        pass

    assert repr(Empty()) == "Empty()"


# ---- units -----------------------------------------------------------------------------------------------------------

TICK = Unit(name="tick", symbol="tick", quantity="time", base="s", numerator=1, denominator=3)


def test_scales_are_exact() -> None:
    assert TICK.scale == Fraction(1, 3)
    assert TICK.to_base(2) == Fraction(2, 3)
    assert TICK.from_base(Fraction(2, 3)) == 2


@given(st.integers(), st.integers(1, 10**6), st.integers(1, 10**6))
def test_counts_come_back(count: int, numerator: int, denominator: int) -> None:
    unit = Unit(name="u", symbol="u", quantity="q", base="b", numerator=numerator, denominator=denominator)
    assert unit.from_base(unit.to_base(count)) == count


@pytest.mark.parametrize(("amount", "count"), [(0.5, 2), (Fraction(1, 6), 0), (Fraction(1, 2), 2), (-1, -3)])
def test_the_nearest_count(amount: Fraction | float, count: int) -> None:
    assert TICK.from_base(amount) == count


# ---- emergencies -----------------------------------------------------------------------------------------------------


def emergency(name: str, code: int, *octets: int | str) -> Emergency:
    return Emergency(
        name=name,
        code=code,
        title=name,
        bytes=octets,  # type: ignore[arg-type]
        register=(),
        register_mask=0,
        condition="",
        reaction="none",
        momentary=False,
        driver_flag=0,
        cause="",
        remedy="",
    )


TABLE = EmergencyTable(
    axis_count=3,
    rows=(
        emergency("reset", 0x0000, 0, "axis", 0, 0, 0),
        emergency("open_a", 0x1000, 1, "axis", 0, 0, 0),
        emergency("open_b", 0x1000, 2, "axis", 0, 0, 0),
        emergency("special", 0x1000, 2, 1, 0, 0, 0),
        emergency("overrun", 0x8110, 0, 255, 0, 0, 0),
    ),
)


@pytest.mark.parametrize(
    ("code", "octets", "name", "axis"),
    [
        (0x1000, "01 00 00 00 00", "open_a", 0),
        (0x1000, "02 02 00 00 00", "open_b", 2),
        (0x1000, "02 01 00 00 00", "special", None),
        (0x8110, "00 ff 00 00 00", "overrun", None),
        (0x0000, "00 02 00 00 00", "reset", 2),
        (0x0000, "00 ff 00 00 00", "reset", None),
    ],
)
def test_what_a_frame_says(code: int, octets: str, name: str, axis: int | None) -> None:
    found = TABLE.find(code, bytes.fromhex(octets))
    assert found is not None
    assert (found.name, found.axis) == (name, axis)


@pytest.mark.parametrize(
    ("code", "octets"),
    [
        (0x1000, "03 00 00 00 00"),
        (0x1000, "01 03 00 00 00"),
        (0x1000, "01 00 00 00 01"),
        (0x1000, "01 00 00 00"),
        (0x1001, "01 00 00 00 00"),
        (0x8110, "00 00 00 00 00"),
    ],
)
def test_frames_that_are_not_in_the_table(code: int, octets: str) -> None:
    assert TABLE.find(code, bytes.fromhex(octets)) is None


def test_rows_of_a_code() -> None:
    assert [row.name for row in TABLE.of_code(0x1000)] == ["open_a", "open_b", "special"]
    assert TABLE.of_code(1) == ()
    assert len(TABLE) == len(list(TABLE)) == 5
    assert [row.per_axis for row in TABLE] == [True, True, True, False, False]


# ---- state machine ---------------------------------------------------------------------------------------------------


def _machine() -> StateMachine:
    states = [("off", 0x0F, 0x00), ("ready", 0x2F, 0x21), ("on", 0x2F, 0x27), ("fault", 0x0F, 0x08)]
    commands = [("up", 0x87, 0x06, 0), ("run", 0x8F, 0x0F, 0), ("down", 0x82, 0x00, 0), ("reset", 0, 0, 0x80)]
    transitions = [
        (0, (), "off", ("power_on",)),
        (1, ("off",), "ready", ("up",)),
        (2, ("ready",), "on", ("run",)),
        (3, ("ready", "on"), "off", ("stopped", "down")),
        (4, ("off", "ready", "on"), "fault", ("fault",)),
        (5, ("fault",), "off", ("reset",)),
    ]
    return StateMachine(
        {
            name: PdsStateInfo(name=name, title=name, mask=mask, value=value, power=False)
            for name, mask, value in states
        },
        {
            name: PdsCommandInfo(name=name, title=name, mask=mask, value=value, edge=edge)
            for name, mask, value, edge in commands
        },
        {name: Named(name=name) for name in ("power_on", "stopped", "fault")},
        tuple(Transition(number=number, start=start, end=end, by=by) for number, start, end, by in transitions),
    )


MACHINE = _machine()


@pytest.mark.parametrize(("statusword", "name"), [(0x10, "off"), (0x631, "ready"), (0x37, "on"), (0x18, "fault")])
def test_the_state_of_a_statusword(statusword: int, name: str) -> None:
    state = MACHINE.decode(statusword)
    assert state is not None
    assert state.name == name


def test_a_statusword_that_shows_no_state() -> None:
    assert MACHINE.decode(0x05) is None


def test_ways_out_of_a_state() -> None:
    assert [transition.number for transition in MACHINE.leaving("ready")] == [2, 3, 4]
    assert MACHINE.next_states("ready") == ("on", "off", "fault")
    assert MACHINE.next_states("nowhere") == ()


def test_commands_between_states() -> None:
    down = MACHINE.command("on", "off")
    assert down is MACHINE.commands["down"]
    assert MACHINE.command("off", "on") is None
    assert MACHINE.command("off", "fault") is None


def test_routes() -> None:
    def numbers(start: str, end: str) -> list[int] | None:
        route = MACHINE.route(start, end)
        return None if route is None else [transition.number for transition in route]

    assert numbers("off", "on") == [1, 2]
    assert numbers("fault", "on") == [5, 1, 2]
    assert numbers("on", "on") == []
    assert numbers("off", "fault") is None


@given(st.integers(0, 0xFFFF))
def test_applying_a_command_gives_it_and_keeps_the_rest(controlword: int) -> None:
    for command in MACHINE.commands.values():
        applied = command.apply(controlword)
        assert (applied ^ controlword) & ~(command.mask | command.edge) == 0
        assert command.matches(applied, before=controlword & ~command.edge)


def test_an_edge_needs_a_zero_before() -> None:
    reset = MACHINE.commands["reset"]
    assert reset.matches(0x80, before=0)
    assert not reset.matches(0x80, before=0x80)
    assert not reset.matches(0, before=0)
