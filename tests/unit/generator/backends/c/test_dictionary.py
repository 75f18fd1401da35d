"""The packed dictionary: every address of the model leads to its row, no other address leads anywhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from odsmith.backends.c.dictionary import (
    CHUNK,
    FOLDED,
    MAP_UNIT,
    PAGE,
    Dictionary,
    Interval,
    PackedEntry,
    overlap,
    pack,
)
from odsmith.backends.c.storage import Location
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection
from odsmith.errors import SpecError
from odsmith.model import SCOPES, Allowed, AxisArea, Default, Device, Entry, Object
from odsmith.vocabulary import Signature

U8, U16, U32, U64 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32, DataType.UNSIGNED64


def entry(sub: int = 0, **changes: object) -> Entry:
    """A parameter of 16 bits; `changes` make something else of it."""
    base = Entry(
        sub,
        f"sub_{sub}",
        f"Sub {sub}",
        f"Sub {sub}",
        U16,
        Access.RW,
        PdoDirection.NO,
        None,
        "",
        effect="value",
    )
    return replace(base, **changes)  # type: ignore[arg-type]


def thing(index: int, *entries: Entry, **changes: object) -> Object:
    name = f"object_{index:04x}"
    kind = ObjectType.RECORD if len(entries) > 1 else ObjectType.VAR
    base = Object(index, name, name, name, kind, entries or (entry(),), "", ())
    return replace(base, **changes)  # type: ignore[arg-type]


@pytest.fixture
def nothing(io_module: Device) -> Device:
    """A device without objects."""
    return replace(io_module, axes=0, areas=(), objects=(), pdos=())


def find(tables: Dictionary, index: int, sub: int) -> tuple[PackedEntry, int] | None:
    """What `ods_od_find` does: the row and the instance of an address, None if there is nothing."""
    page, low = divmod(index, PAGE)
    instance = tables.owners[page]
    fold = tables.folds[instance - FOLDED] if instance >= FOLDED else None
    if fold and fold.each:
        group, pdo = divmod(low, 1 << fold.shift)
        if group >= fold.groups or pdo >= fold.each or sub >= fold.subs:
            return None
        row = tables.entries[fold.entry + sub]
        return (row, fold.first + group * fold.each + pdo) if row.entry else None
    if fold:
        instance = fold.first + (low >> fold.shift)
    chunk = tables.chunks[tables.maps[tables.map_of[page] * MAP_UNIT + low // CHUNK]]
    first, end = chunk.first[low % CHUNK], chunk.first[low % CHUNK + 1]
    if first + sub >= end:
        return None
    row = tables.entries[chunk.entry + first + sub]
    return (row, instance) if row.entry else None


def answers(tables: Dictionary) -> Iterator[tuple[int, int, Entry, int]]:
    """Every address that answers, among all indices and the sub-indices that could be there."""
    highest = max((row.sub for row in tables.entries), default=0)
    for index in range(0x10000):
        for sub in (*range(highest + 2), 0xFF):
            found = find(tables, index, sub)
            if found and found[0].entry:
                yield index, sub, found[0].entry, found[1]


def test_every_address(tmcm3230: Device) -> None:
    expected = [(item.index, e.entry.sub, e.entry) for item in tmcm3230.expanded for e in item.entries]
    assert [found[:3] for found in answers(pack(tmcm3230))] == expected


def test_instances(tmcm3230: Device) -> None:
    """The device is 0; then come the axes, the RPDOs and the TPDOs."""
    tables = pack(tmcm3230)
    instances = {index: instance for index, _, _, instance in answers(tables)}
    assert tables.instances == (1, 3, 12, 12)
    assert [instances[index] for index in (0x1000, 0x2700)] == [0, 0]
    assert [instances[0x6040 + axis * 0x800] for axis in range(3)] == [1, 2, 3]
    assert [instances[0x2000 + axis * 0x200] for axis in range(3)] == [1, 2, 3]
    rpdos = [instances[0x1400 + axis * 0x40 + pdo] for axis in range(3) for pdo in range(4)]
    tpdos = [instances[0x1A00 + axis * 0x40 + pdo] for axis in range(3) for pdo in range(4)]
    assert (rpdos, tpdos) == (list(range(4, 16)), list(range(16, 28)))


@pytest.mark.parametrize("axes", [1, 2])
def test_more_axes_cost_no_rows(tmcm3230: Device, axes: int) -> None:
    """Only what names an axis differs: owners and maps of pages, folds of PDOs, and how many instances there are."""
    three, fewer = pack(tmcm3230), pack(replace(tmcm3230, axes=axes))
    for table in ("maps", "chunks", "entries", "rules", "intervals", "words", "texts", "scope_entries", "defaults"):
        assert getattr(fewer, table) == getattr(three, table), table
    assert len(fewer.folds) == len(three.folds)
    assert fewer.instances == (1, axes, 4 * axes, 4 * axes)


def test_six_axes_need_the_rows_of_one(tmcm3230: Device) -> None:
    """The manufacturer's objects of six axes reach 2BFFh; the device's own block moves out of their way."""
    moved = tuple(
        replace(obj, index=obj.index + 0x1000) if 0x2700 <= obj.index < 0x2800 else obj for obj in tmcm3230.objects
    )
    one, six = (pack(replace(tmcm3230, objects=moved, axes=axes)) for axes in (1, 6))
    for table in ("maps", "chunks", "entries", "rules", "intervals", "words", "texts", "defaults"):
        assert getattr(one, table) == getattr(six, table), table
    assert six.instances == (1, 6, 24, 24)


@pytest.mark.parametrize("stride", [0x10, 0x20, 0x80, 0x100, 0x200, 0x600])
def test_strides(nothing: Device, stride: int) -> None:
    """Axes may share a page, or take several."""
    axes = min(64, 0x8000 // stride)
    area = AxisArea("axes", 0x2000, 0x2000 + min(stride, 0x200) - 1, stride)
    objects = tuple(thing(0x2000 + offset, entry(), entry(1), stride=stride) for offset in (0, 1, 0xF))
    device = replace(nothing, axes=axes, areas=(area,), objects=(thing(0x1000), *objects))
    expected = sorted(
        (index + axis * stride, sub, 1 + axis)
        for axis in range(axes)
        for index in (0x2000, 0x2001, 0x200F)
        for sub in (0, 1)
    )
    found = [(index, sub, instance) for index, sub, _, instance in answers(pack(device))]
    assert found == [(0x1000, 0, 0), *expected]


indices = st.integers(0x1000, 0xFFFF)
highest_subs = st.integers(0, 15)


@pytest.mark.slow
@settings(max_examples=10)
@given(st.dictionaries(indices, highest_subs, min_size=1, max_size=40), st.data())
def test_any_dictionary_without_axes(io_module: Device, objects: dict[int, int], data: st.DataObject) -> None:
    """Sub-indices may be missing, sub-index 0 as well."""
    things = []
    for index, highest in sorted(objects.items()):
        inner = data.draw(st.sets(st.integers(0, max(highest - 1, 0))), label=f"subs of {index:04X}h")
        things.append(thing(index, *(entry(sub) for sub in sorted({*inner, highest}))))
    device = replace(io_module, axes=0, areas=(), objects=tuple(things), pdos=())
    expected = [(obj.index, e.sub, e, 0) for obj in things for e in obj.entries]
    assert list(answers(pack(device))) == expected


def test_constants(nothing: Device) -> None:
    """Up to 16 bits stand in the row; longer ones in the table of words, the low word first, each only once."""
    constants = [
        (DataType.INTEGER8, -1),
        (DataType.INTEGER16, -2),
        (U16, 0xFFFF),
        (U32, 7),
        (DataType.INTEGER32, -3),
        (U64, 0x1_0000_0007),
        (U32, 7),
        (DataType.REAL32, 1),
    ]
    entries = [entry(n, type=t, access=Access.RO, effect="", default=Default(v)) for n, (t, v) in enumerate(constants)]
    tables = pack(replace(nothing, objects=(thing(0x2000, *entries),)))
    assert [row.at for row in tables.entries] == [0xFF, 0xFFFE, 0xFFFF, 0, 1, 2, 0, 4]
    assert tables.words == (7, 0xFFFFFFFD, 7, 1, 0x3F800000)
    assert not any(row.location or row.rule for row in tables.entries)


def test_texts(nothing: Device) -> None:
    constant = entry(
        1, type=DataType.VISIBLE_STRING, access=Access.RO, effect="", default=Default(text="abc"), length=3
    )
    variable = entry(2, type=DataType.OCTET_STRING, length=7)
    tables = pack(replace(nothing, objects=(thing(0x2000, entry(), constant, variable),)))
    assert [(text.location, text.octets, text.length) for text in tables.texts] == [
        (None, b"abc", 3),
        (Location("device", ("object_2000_sub_2",)), b"", 7),
    ]
    assert [row.at for row in tables.entries[1:]] == [0, 1]


def test_a_hole_has_a_row_but_no_entry(nothing: Device) -> None:
    tables = pack(replace(nothing, objects=(thing(0x1010, entry(0), entry(1), entry(4)),)))
    assert [row.entry is not None for row in tables.entries] == [True, True, False, False, True]


def test_rules_are_shared(nothing: Device) -> None:
    """Two entries that are checked alike and do the same have one rule; rule 0 is that of read-only entries."""
    same = {"allowed": Allowed(((0, 3),), listed=False)}
    entries = [
        entry(0, access=Access.RO, effect=""),
        entry(1, **same),
        entry(2, **same, type=U8),
        entry(3, **same, stored="motor"),
        entry(4, **same, effect="other"),
        entry(5, **same, writable_in=("fault",)),
        entry(6, allowed=Allowed(((0, 3),), listed=True)),
    ]
    tables = pack(replace(nothing, objects=(thing(0x2000, *entries),)))
    assert [row.rule for row in tables.entries] == [0, 1, 1, 2, 3, 4, 5]
    assert tables.intervals == (Interval(0, 3, False),)
    assert [(rule.group, rule.effect, rule.states, rule.listed) for rule in tables.rules[1:]] == [
        ("", "value", (), False),
        ("motor", "value", (), False),
        ("", "other", (), False),
        ("", "value", ("fault",), False),
        ("", "value", (), True),
    ]
    assert [len(users) for users in tables.users[1:]] == [2, 1, 1, 1, 1]


def test_intervals(nothing: Device) -> None:
    """Signed limits are biased, a set of signatures is a set of values, the whole type is no limit at all."""
    make, kill = Signature("make", 0x656B616D, ""), Signature("kill", 0x6C6C696B, "")
    entries = [
        entry(0, type=DataType.INTEGER8, allowed=Allowed(((-3, 12),), listed=False)),
        entry(1, allowed=Allowed(((0, 0), (2, 15)), listed=True)),
        entry(2, type=U32, signatures=(make, kill)),
        entry(3, allowed=Allowed(((0, 0xFFFF),), listed=False)),
        entry(4, type=DataType.BOOLEAN),
    ]
    tables = pack(replace(nothing, objects=(thing(0x2000, *entries),)))
    assert tables.intervals == (
        Interval(-3, 12, True),
        Interval(0, 0, False),
        Interval(2, 15, False),
        Interval(make.value, make.value, False),
        Interval(kill.value, kill.value, False),
        Interval(0, 1, False),
    )
    rules = [tables.rules[row.rule] for row in tables.entries]
    assert [(rule.first, rule.intervals, rule.signature, rule.listed) for rule in rules] == [
        (0, 1, False, False),
        (1, 2, False, True),
        (3, 2, True, False),
        (0, 0, False, False),
        (5, 1, False, False),
    ]


def test_power_on_values(tmcm3230: Device) -> None:
    """What is not 0 on axis 0, PDO parameters included; the node-ID is added where it belongs."""
    tables = pack(tmcm3230)
    defaults = {(item.scope, item.ordinal, item.location.designator): item.number for item in tables.defaults}
    assert defaults["axis", 0, "fullstep_resolution"] == 200
    assert defaults["tpdo", 2, "common.pdo_transmission_type"] == 1
    assert defaults["rpdo", 2, "pdo_mapping[1]"] == 0x607A0020
    assert ("rpdo", 0, "pdo_mapping[1]") not in defaults
    assert all(item.number or item.octets for item in tables.defaults)
    added = [(item.scope, item.instance) for item in tables.node_ids]
    assert added == [("device", 0), *(("rpdo", n) for n in range(4)), *(("tpdo", n) for n in range(4))]


def scan(tables: Dictionary) -> Iterator[tuple[str, int, str, int]]:
    """What is stored as the C runtime comes by it: for each instance each entry of its scope whose rule has a group."""
    for scope, count in enumerate(tables.instances):
        for instance in range(count):
            for row in tables.entries[tables.scope_entries[scope] : tables.scope_entries[scope + 1]]:
                if tables.rules[row.rule].group:
                    assert row.location, "what is stored has memory"
                    yield SCOPES[scope], instance, row.object.name, row.sub


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212", "drive"])
def test_what_is_stored_stands_in_the_order_of_the_record(name: str, request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    names = {item.index: item for item in device.expanded}
    scanned = []
    for entry in device.record:
        item = names[entry.index]
        instance = (entry.axis or 0) * item.object.count
        instance += item.index - item.object.index - (entry.axis or 0) * item.object.stride
        scanned.append((item.object.scope, instance, item.object.name, entry.entry.sub))
    assert scanned == list(scan(pack(device)))
    assert len({scope for scope, *_ in scanned}) > 1
    assert pack(device).layout == device.layout


def test_the_buffer_holds_every_value_that_has_memory(nothing: Device) -> None:
    """Numbers of any length fit; a constant is sent from where it lies."""
    text = entry(type=DataType.VISIBLE_STRING, length=20)
    constant = replace(text, access=Access.CONST, effect="")
    assert pack(replace(nothing, objects=(thing(0x2000),))).buffer_size == 8
    assert pack(replace(nothing, objects=(thing(0x2000, constant),))).buffer_size == 8
    assert pack(replace(nothing, objects=(thing(0x2000, constant), thing(0x2001, text)))).buffer_size == 20
    written_only = replace(text, access=Access.WO, type=DataType.OCTET_STRING, length=9)
    assert pack(replace(nothing, objects=(thing(0x2000, written_only),))).buffer_size == 9


def test_overlap_never_changes_a_window() -> None:
    windows = [[0, 0, 0, 0], [1, 0, 0, 0], [0, 0, 0, 2], [1, 2, 0, 0], [0, 0, 1, 0]]
    starts, cells = overlap(windows, 2)
    assert all(cells[start : start + 4] == window for start, window in zip(starts, windows, strict=True))
    assert all(start % 2 == 0 for start in starts)
    assert len(cells) < 4 * len(windows)


def _area(stride: int, first: int = 0x2000) -> AxisArea:
    return AxisArea("axes", first, first + 0x1F, stride)


@pytest.mark.parametrize(
    ("changes", "objects", "message"),
    [
        pytest.param(
            {"axes": 2, "areas": (_area(0x200),)},
            (thing(0x2000, stride=0x200), thing(0x2100)),
            "'object_2100' and 'object_2000' both lie in 2000h..21FFh",
            id="device and axis in one page",
        ),
        pytest.param(
            {"axes": 2, "areas": (_area(0x30),)}, (thing(0x2000, stride=0x30),), "axes 30h apart", id="odd stride"
        ),
        pytest.param(
            {"axes": 2, "areas": (_area(0x20, 0x2010),)},
            (thing(0x2010, stride=0x20),),
            "axes 20h apart",
            id="small stride from the middle of a page",
        ),
        pytest.param(
            {"axes": 200, "areas": (_area(0x200),)}, (thing(0x2000, stride=0x200),), "200 axes", id="too many axes"
        ),
        pytest.param(
            {"axes": 2},
            (thing(0x1400, pdo="rpdo_communication", stride=0x30, count=4),),
            "PDO parameters of the axes lie 30h apart",
            id="odd stride of PDOs",
        ),
        pytest.param(
            {},
            (thing(0x2000, entry(type=U64, allowed=Allowed(((0, 5),), listed=False))),),
            "range of a UNSIGNED64",
            id="range of 64 bits",
        ),
        pytest.param(
            {}, (thing(0x2000, entry(0), entry(254)), thing(0x2001)), "more than 255 entries", id="a full chunk"
        ),
        pytest.param(
            {},
            (thing(0x2000, *(entry(n, effect=f"effect_{n}") for n in range(250))), thing(0x2100, entry(effect="x"))),
            "",
            id="251 rules are fine",
        ),
        pytest.param(
            {},
            tuple(thing(0x2000 + n * 16, *(entry(m, effect=f"e{n}_{m}") for m in range(32))) for n in range(9)),
            "more than 255 different rules",
            id="too many rules",
        ),
    ],
)
def test_what_the_tables_cannot_hold(
    nothing: Device, changes: dict[str, object], objects: tuple[Object, ...], message: str
) -> None:
    device = replace(nothing, objects=objects, **changes)  # type: ignore[arg-type]
    if not message:
        pack(device)
        return
    with pytest.raises(SpecError) as error:
        pack(device)
    (diagnostic,) = error.value.diagnostics
    assert diagnostic.rule == "E471"
    assert message in diagnostic.message
    assert diagnostic.hint
