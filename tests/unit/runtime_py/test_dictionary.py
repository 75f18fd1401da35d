"""Look-ups in a dictionary that is folded over its axes."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith_runtime import NoSuchObjectError, ObjectDictionary

INDICES = [
    0x1008, 0x1014, 0x1400, 0x1401, 0x1440, 0x1441, 0x1600, 0x1601, 0x1640, 0x1641, 0x2093, 0x2293, 0x2700, 0x2701,
    0x2702, 0x6040, 0x6041, 0x6099, 0x6502, 0x6840, 0x6841, 0x6899, 0x6D02,
]  # fmt: skip


def test_all_indices_ascending(dictionary: ObjectDictionary) -> None:
    assert list(dictionary) == list(dictionary.keys()) == INDICES
    assert len(dictionary) == len(INDICES)
    assert [obj.index for obj in dictionary.values()] == INDICES
    assert [(index, obj.index) for index, obj in dictionary.items()] == [(index, index) for index in INDICES]


def test_exactly_these_indices_are_there(dictionary: ObjectDictionary) -> None:
    assert [index for index in range(0x10000) if index in dictionary] == INDICES


@pytest.mark.parametrize(
    ("index", "name", "axis", "base_index", "number"),
    [
        (0x1008, "device_name", None, 0x1008, 0),
        (0x6040, "controlword", 0, 0x6040, 0),
        (0x6840, "controlword", 1, 0x6040, 0),
        (0x2293, "chopper_mode", 1, 0x2093, 0),
        (0x1400, "rpdo_communication", 0, 0x1400, 1),
        (0x1441, "rpdo_communication", 1, 0x1400, 2),
    ],
)
def test_an_index_folds(
    dictionary: ObjectDictionary, index: int, name: str, axis: int | None, base_index: int, number: int
) -> None:
    obj = dictionary[index]
    assert (obj.index, obj.name, obj.axis, obj.base_index, obj.number) == (index, name, axis, base_index, number)
    assert dictionary[index] is obj
    assert dictionary.object(name, axis, number or 1) is obj
    assert dictionary.at(base_index, axis, number or 1) is obj


@given(st.integers(0, 1), st.integers(0x6000, 0x67FF))
def test_folding_undoes_the_stride(axis: int, base_index: int) -> None:
    dictionary = ObjectDictionary(
        "none", axis_count=2, areas=((0x6000, 0x67FF, 0x800),), objects={}, entries={}, pdos={}, max_pdo_entries=0
    )
    assert dictionary.fold(base_index + axis * 0x800) == (base_index, axis)
    assert dictionary.fold(base_index + 2 * 0x800) == (base_index + 2 * 0x800, None)
    assert dictionary.fold(base_index - 0x800) == (base_index - 0x800, None)


def test_by_name_means_the_first_axis(dictionary: ObjectDictionary) -> None:
    assert dictionary["controlword"].index == 0x6040
    assert dictionary.object("controlword").index == 0x6040
    assert dictionary.object("controlword", axis=1).index == 0x6840
    assert dictionary["device_name"].index == 0x1008


@pytest.mark.parametrize(
    ("name", "index"),
    [("Controlword 1", 0x6040), ("Controlword 2", 0x6840), ("Device Name", 0x1008), ("RPDO 66 Comm", 0x1441)],
)
def test_by_the_name_in_the_eds(dictionary: ObjectDictionary, name: str, index: int) -> None:
    assert dictionary[name].index == index
    assert dictionary[name].parameter_name == name


def test_titles_of_pdos_are_numbered(dictionary: ObjectDictionary) -> None:
    assert dictionary[0x1441].title == "RPDO 66"


def test_entries_by_a_dotted_name(dictionary: ObjectDictionary) -> None:
    fast = dictionary.entry("homing_speeds.fast", axis=1)
    assert (fast.index, fast.sub, fast.axis) == (0x6899, 1, 1)
    assert dictionary.entry("controlword").index == 0x6040
    assert dictionary.entry("rpdo_communication.cob_id", axis=1, number=2).index == 0x1441


@pytest.mark.parametrize(
    ("key", "message"),
    [
        (0x7040, "toy has no object 7040h"),
        (-1, "toy has no object -001h"),
        ("nothing", "toy has no object 'nothing'"),
        ("Controlword 3", "toy has no object 'Controlword 3'"),
    ],
)
def test_what_is_not_there(dictionary: ObjectDictionary, key: int | str, message: str) -> None:
    assert key not in dictionary
    assert dictionary.get(key) is None
    with pytest.raises(NoSuchObjectError) as caught:
        dictionary[key]
    assert str(caught.value) == message
    assert isinstance(caught.value, KeyError)


@pytest.mark.parametrize(
    ("name", "axis", "number"),
    [("controlword", 2, 1), ("controlword", -1, 1), ("device_name", 0, 1), ("controlword", 0, 2), ("x", 0, 1)],
)
def test_axes_and_numbers_that_are_not_there(dictionary: ObjectDictionary, name: str, axis: int, number: int) -> None:
    with pytest.raises(NoSuchObjectError):
        dictionary.object(name, axis, number)


def test_sub_indices(dictionary: ObjectDictionary) -> None:
    speeds = dictionary[0x6099]
    assert [entry.sub for entry in speeds] == [0, 1, 2]
    assert (len(speeds), speeds.highest_sub) == (3, 2)
    assert speeds[1] is speeds["fast"]
    assert 2 in speeds
    assert "fast" in speeds
    assert 3 not in speeds
    for key in (3, "faster"):
        with pytest.raises(NoSuchObjectError, match=r"homing_speeds \(6099h\) has no"):
            speeds[key]


def test_texts_of_an_entry_are_its_own_or_those_of_the_object(dictionary: ObjectDictionary) -> None:
    speeds = dictionary[0x6899]
    assert (speeds.text, speeds.source) == ("Speeds.", "manual, section 2")
    assert (speeds[1].text, speeds[1].source) == ("Fast one.", "manual, section 3")
    assert (speeds[2].text, speeds[2].source) == ("Speeds.", "manual, section 2")


def test_defaults_of_pdos(dictionary: ObjectDictionary) -> None:
    first, other = dictionary[0x1401], dictionary[0x1441]
    assert first["cob_id"].default(node_id=5) == 0x305
    assert other["cob_id"].default(node_id=5) == 0xC0000000
    assert first["type"].default() == other["type"].default() == 1
    assert [entry.default() for entry in dictionary[0x1601]] == [2, 0x60400010, 0x60990120]
    assert [entry.default() for entry in dictionary[0x1641]] == [2, 0x68400010, 0x68990120]
    assert [entry.default() for entry in dictionary[0x1640]] == [1, 0x68400010, 0]


def test_pdos_of_all_axes(dictionary: ObjectDictionary) -> None:
    found = [(pdo.kind, pdo.axis, pdo.number, pdo.communication.index, pdo.mapping.index) for pdo in dictionary.pdos]
    assert found == [
        ("rpdo", 0, 1, 0x1400, 0x1600),
        ("rpdo", 0, 2, 0x1401, 0x1601),
        ("rpdo", 1, 1, 0x1440, 0x1640),
        ("rpdo", 1, 2, 0x1441, 0x1641),
    ]
    assert [(entry.index, entry.sub) for entry in dictionary.pdos[3].entries] == [(0x6840, 0), (0x6899, 1)]
    assert repr(dictionary.pdos[3]) == "<rpdo 2 of axis 1: controlword, homing_speeds.fast>"


def test_it_says_what_it_is(dictionary: ObjectDictionary) -> None:
    assert repr(dictionary) == "<ObjectDictionary of toy: 23 objects, 2 axes>"
    assert repr(dictionary[0x6840]) == "<controlword of axis 1 (6840h)>"
    assert repr(dictionary[0x1008]) == "<device_name (1008h)>"
    assert repr(dictionary[0x6899][1]) == "<homing_speeds.fast of axis 1 (6899h:01) INTEGER32 rw>"


def test_objects_cannot_be_changed(dictionary: ObjectDictionary) -> None:
    with pytest.raises(AttributeError, match="cannot be changed"):
        dictionary[0x6040].name = "other"  # type: ignore[misc]
    with pytest.raises(AttributeError, match="cannot be changed"):
        dictionary[0x6040][0].access = "ro"  # type: ignore[misc]
    with pytest.raises(AttributeError, match="cannot be changed"):
        del dictionary[0x6040][0].access
