"""The state machine as a drawing: states in a column, each transition in a lane of its own beside it.

Downward transitions run on the right, upward ones on the left. Lanes are shared where transitions do not overlap, short
transitions get the inner lanes, and the ports of a state are sorted so that no line crosses more than it must. All
coordinates are whole user units; the template only writes them down.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

BOX_WIDTH = 220
PORT = 20
"""Distance between two ports of a box."""
GAP = 26
"""Distance between two boxes."""
LANE = 22
MARGIN = 20
START_HEIGHT = 30


class Arrow(NamedTuple):
    """What is to be drawn: from which states to which, `starts` empty for the entry from outside."""

    key: str
    label: str
    starts: tuple[str, ...]
    end: str


class Box(NamedTuple):
    key: str
    x: int
    y: int
    width: int
    height: int
    middle_x: int
    middle_y: int


class Badge(NamedTuple):
    """The number of a transition, at the port where it leaves a state."""

    x: int
    y: int


class Wire(NamedTuple):
    """A transition: `path` from its first start to its end, for an arrow head; `stubs` from the others to where the
    path turns in."""

    key: str
    label: str
    stubs: tuple[str, ...]
    path: str
    badges: tuple[Badge, ...]


class Drawing(NamedTuple):
    width: int
    height: int
    boxes: tuple[Box, ...]
    wires: tuple[Wire, ...]
    start: Badge | None
    """Where the dot for the entry from outside is."""


class _Port(NamedTuple):
    row: int
    right: bool
    arrow: Arrow
    arriving: bool
    downward: bool
    lane: int


def draw(states: Sequence[str], arrows: Iterable[Arrow]) -> Drawing:
    """Lay out the states in the order given. Arrows whose states are not there are left out."""
    rows = {name: row for row, name in enumerate(states)}
    known = [a for a in arrows if a.end in rows and all(start in rows for start in a.starts)]
    inside = [arrow for arrow in known if arrow.starts]
    entries = [arrow for arrow in known if not arrow.starts]
    lanes = _lanes(inside, rows)
    ports = _ports(inside, rows, lanes)
    left = max([lane for (right, lane) in lanes.values() if not right], default=-1) + 1
    right = max([lane for (is_right, lane) in lanes.values() if is_right], default=-1) + 1
    x = MARGIN + left * LANE + GAP
    width = x + BOX_WIDTH + GAP + right * LANE + MARGIN
    boxes, y = [], MARGIN + (START_HEIGHT + GAP if entries else 0)
    for row, name in enumerate(states):
        most = max(len(ports[row, side]) for side in (False, True))
        height = PORT * max(2, most + 1)
        boxes.append(Box(name, x, y, BOX_WIDTH, height, x + BOX_WIDTH // 2, y + height // 2))
        y += height + GAP
    height = y - GAP + MARGIN
    start = Badge(x + BOX_WIDTH // 2, MARGIN) if entries else None
    wires = [_entry_wire(arrow, boxes[rows[arrow.end]], start) for arrow in entries if start]
    wires += [_wire(arrow, rows, lanes[arrow.key], ports, boxes) for arrow in inside]
    return Drawing(width, height, tuple(boxes), tuple(wires), start)


def _downward(arrow: Arrow, rows: dict[str, int]) -> bool:
    """Where starts lie on both sides of the end, most of them decide."""
    return 2 * sum(rows[start] < rows[arrow.end] for start in arrow.starts) >= len(arrow.starts)


class _Span(NamedTuple):
    """The rows that an arrow runs past; `loops` if it leaves a state for the same one."""

    low: int
    high: int
    loops: bool


def _lanes(arrows: Iterable[Arrow], rows: dict[str, int]) -> dict[str, tuple[bool, int]]:
    """Side and lane of each arrow: the shortest first, each in the innermost lane that is free over its length."""
    taken: dict[tuple[bool, int], list[_Span]] = defaultdict(list)
    lanes: dict[str, tuple[bool, int]] = {}
    spans = {}
    for arrow in arrows:
        touched = [rows[name] for name in (*arrow.starts, arrow.end)]
        spans[arrow] = _Span(min(touched), max(touched), arrow.end in arrow.starts)
    for arrow, span in sorted(spans.items(), key=lambda item: (item[1].high - item[1].low, item[1])):
        side, lane = _downward(arrow, rows), 0
        while any(_overlap(span, other) for other in taken[side, lane]):
            lane += 1
        taken[side, lane].append(span)
        lanes[arrow.key] = (side, lane)
    return lanes


def _overlap(one: _Span, other: _Span) -> bool:
    """Two lines may meet at a box, where one ends and the other begins; a loop needs its box for itself."""
    if one.loops or other.loops:
        return one.low <= other.high and other.low <= one.high
    return one.low < other.high and other.low < one.high


def _ports(
    arrows: Iterable[Arrow], rows: dict[str, int], lanes: dict[str, tuple[bool, int]]
) -> dict[tuple[int, bool], list[_Port]]:
    """The ports of each side of each row from the top: lines from above, inner lanes first, then lines to below,
    outer lanes first; so a line to an outer lane does not cross the inner ones that end at the same box."""
    ports: dict[tuple[int, bool], list[_Port]] = defaultdict(list)
    for arrow in arrows:
        right, lane = lanes[arrow.key]
        end = rows[arrow.end]
        for start in (rows[name] for name in arrow.starts):
            ports[start, right].append(_Port(start, right, arrow, False, start <= end, lane))
        others = [rows[name] for name in arrow.starts]
        ports[end, right].append(_Port(end, right, arrow, True, min(others) >= end and max(others) > end, lane))
    for found in ports.values():
        found.sort(key=lambda port: (port.downward, -port.lane if port.downward else port.lane, port.arriving))
    return ports


def _wire(
    arrow: Arrow,
    rows: dict[str, int],
    lane: tuple[bool, int],
    ports: dict[tuple[int, bool], list[_Port]],
    boxes: list[Box],
) -> Wire:
    right, number = lane
    first = boxes[0]
    edge = first.x + first.width if right else first.x
    way = 1 if right else -1
    lane_x = edge + way * (GAP + number * LANE)

    def port_y(row: int, arriving: bool) -> int:
        found = ports[row, right]
        position = next(i for i, port in enumerate(found) if port.arrow is arrow and port.arriving is arriving)
        return boxes[row].y + boxes[row].height * (position + 1) // (len(found) + 1)

    starts = [port_y(rows[name], False) for name in arrow.starts]
    end = port_y(rows[arrow.end], True)
    return Wire(
        arrow.key,
        arrow.label,
        tuple(f"M{edge} {y}H{lane_x}V{end}" for y in starts[1:]),
        f"M{edge} {starts[0]}H{lane_x}V{end}H{edge + 7 * way}",
        tuple(Badge(edge + way * 13, y) for y in starts),
    )


def _entry_wire(arrow: Arrow, box: Box, start: Badge) -> Wire:
    return Wire(
        arrow.key,
        arrow.label,
        (),
        f"M{start.x} {start.y}V{box.y - 7}" if box.y > start.y else "",
        (Badge(start.x, (start.y + box.y) // 2),),
    )
