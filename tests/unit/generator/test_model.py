"""The model: what it derives from its facts, above all the flat dictionary that the bus sees."""

from __future__ import annotations

import dataclasses
from dataclasses import FrozenInstanceError, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Place
from odsmith.model import Allowed, Bit, Default, Device, Entry, ExpandedObject, NamedValue, Object, PdoMapEntry

STRIDES = {0x2000: 0x200, 0x6000: 0x800}  # manufacturer and profile area
ENTRY = Entry(0, "x", "X", "X", DataType.UNSIGNED8, Access.RW, PdoDirection.NO, None, "")


# ---- small classes --------------------------------------------------------------------------------------------------


def test_bit_and_field() -> None:
    assert (Bit(5, 5, "x", "").mask, Bit(5, 5, "x", "").label) == (0x20, "5")
    assert (Bit(16, 23, "x", "").mask, Bit(16, 23, "x", "").label) == (0xFF0000, "16..23")


sets = st.sets(st.integers(-200, 200), min_size=1)


def allowed(values: set[int]) -> Allowed:
    """The set as ascending intervals that do not touch."""
    starts = sorted(value for value in values if value - 1 not in values)
    ends = sorted(value for value in values if value + 1 not in values)
    return Allowed(tuple(zip(starts, ends, strict=True)), listed=True)


@given(sets, st.integers(-210, 210))
def test_allowed_is_a_set(values: set[int], value: int) -> None:
    both = allowed(values)
    assert (value in both) == (value in values)
    assert (both.low, both.high) == (min(values), max(values))
    assert both.members == (tuple(sorted(values)) if len(values) <= 64 else None)


def test_allowed_as_text() -> None:
    assert str(allowed({0, 2, 3, 4, -7})) == "-7, 0, 2..4"


def test_allowed_lists_no_more_than_64_members() -> None:
    assert Allowed(((0, 63),), listed=False).members == tuple(range(64))
    assert Allowed(((0, 63), (70, 70)), listed=True).members is None
    assert Allowed(((-(1 << 63), (1 << 64) - 1),), listed=False).members is None


def test_default_of_a_node() -> None:
    assert Default(0x80, node_id=True).value(5) == 0x85
    assert Default(0x80).value(5) == 0x80
    assert Default(text="TMCM").value(5) == "TMCM"
    assert Default(text="").value(5) == ""


@pytest.mark.parametrize(
    ("access", "mapping", "spelling"),
    [
        ("rw", "no", "rw"),
        ("rw", "rx", "rww"),
        ("rw", "tx", "rwr"),
        ("rw", "both", "rw"),
        ("ro", "tx", "ro"),
        ("wo", "rx", "wo"),
        ("const", "tx", "const"),
    ],
)
def test_access_as_the_eds_spells_it(access: str, mapping: str, spelling: str) -> None:
    assert replace(ENTRY, access=Access(access), mapping=PdoDirection(mapping)).eds_access == spelling


def test_an_entry_is_constant_where_nobody_writes_it() -> None:
    assert replace(ENTRY, access=Access.CONST).constant
    assert replace(ENTRY, access=Access.RO).constant
    assert not replace(ENTRY, access=Access.RO, role="statusword").constant
    assert not ENTRY.constant
    assert not replace(ENTRY, access=Access.WO).constant


def test_length_on_the_bus() -> None:
    assert replace(ENTRY, type=DataType.INTEGER16).bit_length == 16
    assert replace(ENTRY, type=DataType.BOOLEAN).bit_length == 1
    assert replace(ENTRY, type=DataType.VISIBLE_STRING, length=7).bit_length == 56


def test_the_eds_hides_what_it_is_told_to_hide() -> None:
    known = replace(ENTRY, default=Default(3))
    assert known.eds_default == Default(3)
    assert replace(known, hidden_default="a command").eds_default is None


def test_mapping_entry_as_1600h_holds_it() -> None:
    entry = replace(ENTRY, sub=2, type=DataType.INTEGER32)
    mapped = PdoMapEntry(Object(0x607D, "x", "X", "X", ObjectType.ARRAY, (entry,), "", ()), entry)
    assert mapped.value == 0x607D0220


def test_nothing_downstream_can_change_a_model(drive: Device) -> None:
    for item, field in ((drive, "axes"), (drive.objects[0], "name"), (drive.expanded[0], "axis"), (ENTRY, "sub")):
        with pytest.raises((FrozenInstanceError, TypeError)):
            setattr(item, field, 1)


def test_places_are_no_facts() -> None:
    value = NamedValue(1, "one", "", place=Place("a.yaml", 1, 2))
    assert value == NamedValue(1, "one", "", place=Place("b.yaml", 3, 4))
    assert "yaml" not in repr(value)


def test_no_class_of_a_model_lets_its_place_count(drive: Device) -> None:
    """Otherwise a digest would depend on the folder that the spec lies in."""
    assert "Place(" not in repr(drive)
    places = [field for item in everything(drive) for field in dataclasses.fields(item) if field.name == "place"]
    assert places
    assert all(not field.compare and not field.repr for field in places)


def everything(item: object) -> list[type]:
    """The dataclasses that a model is made of."""
    found: dict[type, None] = {}

    def walk(value: object) -> None:
        if isinstance(value, dict):
            value = tuple(value.values())
        if isinstance(value, tuple):
            for element in value:
                walk(element)
        elif dataclasses.is_dataclass(value) and not isinstance(value, type):
            found[type(value)] = None
            for field in dataclasses.fields(value):
                walk(getattr(value, field.name))

    walk(item)
    return list(found)


# ---- a whole device -------------------------------------------------------------------------------------------------


PDO_NUMBERS = (*range(1, 5), *range(65, 69), *range(129, 133))
"""Those of the TMCM-3230."""


def test_look_up(drive: Device) -> None:
    controlword = drive.object("controlword")
    assert controlword is not None
    assert controlword.index == 0x6040
    assert controlword.per_axis
    assert drive.object("control_word") is None
    store = drive.object("store")
    assert store is not None
    assert not store.per_axis
    assert store.highest_sub == 5
    entry = store.entry(5)
    assert entry is not None
    assert entry.name == "axis_1"
    assert store.entry(2) is None


def test_pdos_of_a_direction(drive: Device) -> None:
    assert [pdo.number for pdo in drive.pdos_of("tpdo")] == [1, 2]
    assert [pdo.number for pdo in drive.pdos_of("rpdo")] == [1]


@pytest.mark.parametrize(
    ("path", "ids"),
    [
        ("objects.controlword", ["E10"]),  # the path itself
        ("objects.history", ["E2"]),  # something below it
        ("objects.history.subs.2.access", ["E2"]),
        ("objects.history.subs.2.access.x", []),  # nothing above it
        ("objects.control", []),  # no part of a word
        ("objects.hist", []),
        ("objects", ["E2", "E10"]),
        ("modes.profile_position", ["E10"]),
    ],
)
def test_errata_of(drive: Device, path: str, ids: list[str]) -> None:
    assert [erratum.id for erratum in drive.errata_of(path)] == ids


# ---- expanded -------------------------------------------------------------------------------------------------------


PLACES = [*range(0x1000, 0x1010), *range(0x2000, 0x2200, 7), *range(0x6000, 0x6800, 9)]


def variable(index: int) -> Object:
    name, stride = f"o{index:x}", STRIDES.get(index & 0xF000, 0)
    return Object(index, name, "T", f"P {index:X}", ObjectType.VAR, (ENTRY,), "", (), stride)


dictionaries = st.sets(st.sampled_from(PLACES)).map(lambda indices: tuple(map(variable, sorted(indices))))


@settings(max_examples=50)
@given(dictionaries, st.integers(1, 8))
def test_every_index_belongs_to_exactly_one_object_and_axis(
    toy: Device, objects: tuple[Object, ...], axes: int
) -> None:
    device = replace(toy, objects=objects, axes=axes)
    owners: dict[int, list[ExpandedObject]] = {}
    for item in device.expanded:
        owners.setdefault(item.index, []).append(item)
    assert all(len(items) == 1 for items in owners.values())
    for obj in objects:
        for axis in range(axes) if obj.per_axis else [None]:
            (item,) = owners.pop(obj.index + (axis or 0) * obj.stride)
            assert (item.object, item.axis, item.number) == (obj, axis, 0)
            assert item.parameter_name == (obj.parameter_name if axis is None else f"{obj.parameter_name} {axis + 1}")
            assert [entry.index for entry in item.entries] == [item.index]
    assert not owners


@pytest.fixture(scope="module")
def toy(drive: Device) -> Device:
    """A device to put other objects into."""
    return replace(drive, pdos=())


@pytest.mark.parametrize("name", ["drive", "tmcm3230", "io_module"])
def test_expanded_is_in_order_and_complete(name: str, request: pytest.FixtureRequest) -> None:
    device: Device = request.getfixturevalue(name)
    indices = [item.index for item in device.expanded]
    assert indices == sorted(set(indices))
    assert len(indices) == sum(obj.count * (device.axes if obj.per_axis else 1) for obj in device.objects)
    assert {item.axis for item in device.expanded} <= {None, *range(device.axes)}


def test_names_of_axes_and_pdos(tmcm3230: Device) -> None:
    names = {item.index: item.parameter_name for item in tmcm3230.expanded}
    assert names[0x6040] == "Controlword 1"
    assert names[0x6840] == "Controlword 2"
    assert names[0x7040] == "Controlword 3"
    assert names[0x1800] == "TPDO 1 Communication Parameter"
    assert names[0x1840] == "TPDO 65 Communication Parameter"
    assert names[0x1A83] == "TPDO 132 Mapping Parameter"
    assert names[0x1008] == "Manufacturer Device Name"
    items = {item.index: item for item in tmcm3230.expanded}
    assert (items[0x1883].axis, items[0x1883].number, items[0x1883].title) == (
        2,
        132,
        "TPDO 132 communication parameter",
    )
    assert (items[0x7040].axis, items[0x7040].number, items[0x7040].title) == (2, 0, "Controlword")
    assert (items[0x1008].axis, items[0x1008].number) == (None, 0)


def defaults(device: Device, index: int) -> dict[int, Default | None]:
    (item,) = (item for item in device.expanded if item.index == index)
    return {entry.entry.sub: entry.default for entry in item.entries}


def test_pdo_defaults_come_from_the_table(drive: Device) -> None:
    assert defaults(drive, 0x1800) == {
        0: Default(6),
        1: Default(0x40000180, node_id=True),
        2: Default(254),
        3: Default(5),
        5: Default(100),
        6: Default(240),  # not a parameter of the table: the default that is written
    }
    assert defaults(drive, 0x1A00) == {0: Default(2), 1: Default(0x60410010), 2: Default(0x10030210), 3: Default(0)}
    assert defaults(drive, 0x1A01) == dict.fromkeys(range(4), Default(0))  # TPDO 2 maps nothing


def test_pdos_of_other_axes_map_that_axis(drive: Device) -> None:
    """What the device has once stays where it is."""
    assert defaults(drive, 0x1840)[1] == Default(0xC0000000)
    assert defaults(drive, 0x1840)[5] == Default(100)
    assert defaults(drive, 0x1A40) == {0: Default(2), 1: Default(0x68410010), 2: Default(0x10030210), 3: Default(0)}


def test_pdos_of_a_three_axis_drive(tmcm3230: Device) -> None:
    for kind, first in (("rpdo", 0x1400), ("tpdo", 0x1800)):
        for pdo in tmcm3230.pdos:
            if pdo.kind != kind:
                continue
            for axis in range(3):
                communication = defaults(tmcm3230, first + 0x40 * axis + pdo.number - 1)
                assert communication[1] == (Default(0xC0000000) if axis else pdo.cob_id)
                assert communication[2] == Default(pdo.transmission_type)
                mapping = defaults(tmcm3230, first + 0x200 + 0x40 * axis + pdo.number - 1)
                assert mapping[0] == Default(len(pdo.map))
                expected = [item.value + (axis * 0x800 << 16) for item in pdo.map] + [0, 0, 0]
                assert [mapping[sub] for sub in (1, 2, 3)] == [Default(value) for value in expected[:3]]


def test_pdos_without_axes(io_module: Device) -> None:
    assert defaults(io_module, 0x1A01)[4] == Default(0x64010410)
    assert defaults(io_module, 0x1801)[3] == Default(100)
    assert [item.number for item in io_module.expanded if item.object.pdo == "rpdo_mapping"] == [1, 2]


def test_the_eds_hides_the_default_of_an_expanded_entry(drive: Device) -> None:
    (history,) = (item for item in drive.expanded if item.index == 0x1003)
    assert [entry.eds_default for entry in history.entries] == [Default(2), None, None]


# ---- what is stored --------------------------------------------------------------------------------------------------


def test_the_record_goes_instance_by_instance(tmcm3230: Device) -> None:
    """The device, the axes, the RPDOs, the TPDOs of all axes; within each by index and sub-index."""
    objects = {item.index: item for item in tmcm3230.expanded}
    record = [(objects[item.index], item) for item in tmcm3230.record]
    instances = list(dict.fromkeys(obj.instance for obj, _ in record))
    assert instances == [(0, 0), *((1, n) for n in range(3)), *((scope, n) for scope in (2, 3) for n in PDO_NUMBERS)]
    assert instances == sorted(instances)
    for instance in instances:
        places = [(item.index, item.entry.sub) for obj, item in record if obj.instance == instance]
        assert places == sorted(places)
    assert [f"{item.index:04X}:{item.entry.sub}" for obj, item in record if obj.instance == (2, 65)] == [
        *(f"1440:{sub}" for sub in (1, 2)),
        *(f"1640:{sub}" for sub in range(4)),
    ]


def test_the_record_has_all_that_is_stored_once(drive: Device) -> None:
    entries = [entry for item in drive.expanded for entry in item.entries if entry.entry.stored != "never"]
    assert sorted((item.index, item.entry.sub) for item in drive.record) == [(e.index, e.entry.sub) for e in entries]
    assert entries


def test_the_layout_is_that_of_the_record(tmcm3230: Device) -> None:
    """A text may change; another type, group, axis or order may not."""
    changed = tuple(replace(obj, text="other words") for obj in tmcm3230.objects)
    assert replace(tmcm3230, objects=changed).layout == tmcm3230.layout
    assert replace(tmcm3230, axes=2).layout != tmcm3230.layout
    (index, stored) = next(
        (n, obj) for n, obj in enumerate(tmcm3230.objects) if obj.entries[0].stored == "motor" and obj.per_axis
    )
    for change in ({"stored": "profile"}, {"stored": "never"}, {"type": DataType.REAL32}, {"length": 1}):
        objects = list(tmcm3230.objects)
        first = replace(stored.entries[0], **change)
        objects[index] = replace(stored, entries=(first, *stored.entries[1:]))
        assert replace(tmcm3230, objects=tuple(objects)).layout != tmcm3230.layout


# ---- error behaviour -------------------------------------------------------------------------------------------------


def test_error_behaviour(tmcm3230: Device, io_module: Device) -> None:
    """As the manual numbers it (3.1.17): 0 and 2 lead to STOPPED, 1 changes nothing."""
    states = {value: state.name for value, state in tmcm3230.error_behaviour.items()}
    assert states == {0: "stopped", 2: "stopped"}
    assert list(states) == sorted(states)
    assert io_module.error_behaviour == {}
