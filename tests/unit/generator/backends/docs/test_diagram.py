"""The drawing of a state machine: nothing overlaps, nothing is left out."""

from __future__ import annotations

import re
from itertools import combinations, pairwise

from hypothesis import given
from hypothesis import strategies as st

from odsmith.backends.docs.diagram import PORT, Arrow, Drawing, Wire, draw
from odsmith.model import Device

STATES = ["s0", "s1", "s2", "s3", "s4"]
NUMBERED = st.lists(
    st.tuples(st.lists(st.sampled_from(STATES), max_size=4, unique=True), st.sampled_from(STATES)), max_size=14
)


def arrows(pairs: list[tuple[list[str], str]]) -> list[Arrow]:
    return [Arrow(str(number), "", tuple(starts), end) for number, (starts, end) in enumerate(pairs)]


def verticals(wire: Wire) -> list[tuple[int, int, int]]:
    """The vertical stretches of a wire as x, upper y, lower y."""
    found = []
    for path in (wire.path, *wire.stubs):
        match = re.fullmatch(r"M\d+ (\d+)H(\d+)V(\d+)(?:H\d+)?", path)
        if match:
            first, x, last = int(match[1]), int(match[2]), int(match[3])
            found.append((x, min(first, last), max(first, last)))
    return found


def check(drawing: Drawing) -> None:
    for above, below in pairwise(drawing.boxes):
        assert above.y + above.height < below.y
    for one, other in combinations([wire for wire in drawing.wires if verticals(wire)], 2):
        for x, top, bottom in verticals(one):
            for other_x, other_top, other_bottom in verticals(other):
                assert x != other_x or bottom <= other_top or other_bottom <= top, f"{one} covers {other}"
    badges = [badge for wire in drawing.wires if verticals(wire) for badge in wire.badges]
    assert len(set(badges)) == len(badges)
    for wire in drawing.wires:
        numbers = [int(number) for path in (wire.path, *wire.stubs) for number in re.findall(r"\d+", path)]
        assert all(0 <= number <= max(drawing.width, drawing.height) for number in numbers)


@given(NUMBERED)
def test_no_wire_covers_another(pairs: list[tuple[list[str], str]]) -> None:
    drawing = draw(STATES, arrows(pairs))
    check(drawing)
    assert {wire.key for wire in drawing.wires} == {str(number) for number in range(len(pairs))}


def test_the_state_machine_of_a_drive(tmcm3230: Device) -> None:
    given = [Arrow(str(t.number), "", t.start, t.end) for t in tmcm3230.transitions]
    drawing = draw([state.name for state in tmcm3230.pds_states], given)
    check(drawing)
    assert len(drawing.boxes) == len(tmcm3230.pds_states)
    assert sorted(int(wire.key) for wire in drawing.wires) == sorted(t.number for t in tmcm3230.transitions)
    starts = {arrow.key: len(arrow.starts) or 1 for arrow in given}
    assert all(len(wire.badges) == starts[wire.key] for wire in drawing.wires)


def test_downward_runs_right_and_upward_left() -> None:
    drawing = draw(["a", "b"], [Arrow("1", "", ("a",), "b"), Arrow("2", "", ("b",), "a")])
    box = drawing.boxes[0]
    down, up = drawing.wires
    assert verticals(down)[0][0] > box.x + box.width
    assert verticals(up)[0][0] < box.x


def test_a_box_grows_with_its_ports() -> None:
    many = [Arrow(str(number), "", ("a",), "b") for number in range(6)]
    assert draw(["a", "b"], many).boxes[0].height == 7 * PORT


def test_arrows_of_unknown_states_are_left_out() -> None:
    assert draw(["a"], [Arrow("1", "", ("a",), "gone"), Arrow("2", "", ("gone",), "a")]).wires == ()


def test_the_dot_stands_only_where_something_enters() -> None:
    assert draw(["a", "b"], [Arrow("1", "", ("a",), "b")]).start is None
    drawing = draw(["a", "b"], [Arrow("0", "", (), "a")])
    assert drawing.start is not None
    assert drawing.start.y < drawing.boxes[0].y


def test_a_machine_without_states_is_drawn() -> None:
    assert draw([], []).boxes == ()
