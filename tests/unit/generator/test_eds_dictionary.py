"""The object dictionary of a file, and the axes in it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.eds_axes import Area, Axes, find_axes
from odsmith.eds_dictionary import TYPES, EdsDictionary, address, dictionary, parse_number
from odsmith.eds_file import parse
from odsmith.model import Default, Device


def described(text: str) -> EdsDictionary:
    return dictionary(parse(text.encode("utf-8"), "a.eds"))


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("0", Default(0)),
        ("0x10", Default(16)),
        ("0XfF", Default(255)),
        ("-3", Default(-3)),
        ("-0x3", Default(-3)),
        ("010", Default(10)),
        ("$NODEID", Default(0, node_id=True)),
        ("$NODEID+0x200", Default(0x200, node_id=True)),
        ("$nodeid + 512", Default(512, node_id=True)),
        ("0x200+$NODEID", Default(0x200, node_id=True)),
        *((text, None) for text in ("", "x", "0x", "1.5", "1 2", "--1", "$NODEID+", "$NODEID-1", "$NODEID+$NODEID")),
        ("9" * 5000, None),
        ("\u0663", None),
    ],
)
def test_numbers(text: str, number: Default | None) -> None:
    assert parse_number(text) == number


@pytest.mark.parametrize(
    ("section", "found"),
    [
        ("1018", (0x1018, None)),
        ("1018sub1", (0x1018, 1)),
        ("1010SUBa", (0x1010, 10)),
        ("1018sub01", (0x1018, 1)),
        (" 1018 sub 1", (0x1018, 1)),
        ("1A00subFE", (0x1A00, 0xFE)),
        *((name, None) for name in ("FileInfo", "1018Name", "101", "10180", "1018sub", "1018sub100", "1018subG")),
    ],
)
def test_names_of_sections(section: str, found: tuple[int, int | None] | None) -> None:
    assert address(section) == found


def test_types_of_cia_301() -> None:
    assert (TYPES[2].low, TYPES[2].high, TYPES[5].low, TYPES[5].high) == (-128, 127, 0, 255)
    assert (TYPES[1].low, TYPES[1].high, TYPES[0x1B].high) == (0, 1, (1 << 64) - 1)
    assert {code for code, basic in TYPES.items() if not basic.integer} == {8, 9, 0xA, 0xB, 0xC, 0xD, 0xF, 0x11}


def test_variables_and_records() -> None:
    found = described(
        "[1000]\nParameterName=Type\nObjectType=0x7\nDataType=0x0007\nAccessType=RO\nDefaultValue=0x192\n"
        "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=2\n"
        "[1018sub1]\nParameterName=Vendor\nDataType=7\nAccessType=rw\nPDOMapping=1\nLowLimit=1\nHighLimit=9\n"
        "[1018sub0]\nParameterName=Count\nDataType=5\nDefaultValue=1\n[1018subFF]\nDataType=7\n"
    )
    variable, record = found.objects[0x1000], found.objects[0x1018]
    assert list(found.objects) == [0x1000, 0x1018]
    assert (variable.variable, variable.name, list(variable.entries)) == (True, "Type", [0])
    assert (record.variable, record.name, list(record.entries), record.highest_sub) == (
        False,
        "Identity",
        [0, 1, 255],
        1,
    )
    first = found.entry(0x1000, 0)
    assert first
    assert (first.access, first.writable, first.mapped, first.bits) == ("ro", False, False, 32)
    assert first.default == Default(0x192)
    second = found.entry(0x1018, 1)
    assert second
    assert (second.writable, second.mapped, second.low, second.high) == (True, True, Default(1), Default(9))
    assert second.default is None
    assert found.entry(0x1018, 2) is None
    assert found.entry(0x1019, 0) is None
    assert [(entry.index, entry.sub) for entry in found.entries] == [
        (0x1000, 0),
        (0x1018, 0),
        (0x1018, 1),
        (0x1018, 255),
    ]


def test_garbage_is_none() -> None:
    entry = described("[1000]\nDataType=seven\nDefaultValue=x\nPDOMapping=?\n[1001]\nDataType=0x999").entries
    assert (entry[0].data_type, entry[0].type, entry[0].default, entry[0].mapped, entry[0].bits) == (None,) * 3 + (
        False,
        0,
    )
    assert (entry[1].data_type, entry[1].type) == (0x999, None)


def test_sub_indices_without_their_object_are_orphans() -> None:
    found = described("[1018sub1]\n[1018sub0]\n[1000]\n")
    assert [section.name for section in found.orphans] == ["1018sub1", "1018sub0"]
    assert list(found.objects) == [0x1000]


def test_compact_sub_indices_are_written_out() -> None:
    found = described(
        "[1003]\nParameterName=Errors\nObjectType=8\nDataType=7\nAccessType=ro\nCompactSubObj=3\nDefaultValue=0\n"
        "[1003Name]\nNrOfEntries=1\n2=Second\n[1003Value]\nNrOfEntries=1\n3=0x8000\n"
    )
    entries = found.objects[0x1003].entries
    assert [entry.name for entry in entries.values()] == ["NrOfObjects", "Errors1", "Second", "Errors3"]
    assert [entry.default for entry in entries.values()] == [Default(3), Default(0), Default(0), Default(0x8000)]
    assert all(entry.implied and entry.key("DataType") is None for entry in entries.values())
    assert (entries[0].bits, entries[1].bits, entries[1].access) == (8, 32, "ro")


@pytest.mark.parametrize(
    ("product", "device"),
    [("TMCM-6212", "6212"), ("TMC 1270b", "1270b"), ("EW-IO-16", "EW-IO-16"), ("TOY-2", "TOY-2"), ("", "")],
)
def test_what_paths_call_the_device(product: str, device: str) -> None:
    assert described(f"[DeviceInfo]\nProductName={product}\n").device == device
    assert described("[1000]\n").device == ""


# ---- axes --------------------------------------------------------------------------------------------------------


def indices(device: Device) -> list[int]:
    return [item.index for item in device.expanded]


@pytest.mark.parametrize("count", [2, 3, 6])
def test_the_axes_of_a_drive_are_found(count: int, tmcm3230: Device) -> None:
    axes = find_axes(index for index in indices(replace(tmcm3230, axes=count)) if not 0x2700 <= index < 0x2800)
    assert axes.count == count
    last = count - 1
    assert axes.fold(0x6040 + 0x800 * last) == (0x6040, last)
    assert axes.fold(0x2005 + 0x200 * last) == (0x2005, last)
    assert axes.fold(0x1A03 + 0x40 * last) == (0x1A03, last)
    assert axes.fold(0x1018) == (0x1018, None)
    assert axes.fold(0x2000 + 0x200 * count) == (0x2000 + 0x200 * count, None)


def test_a_device_without_axes_has_none(io_module: Device, tmcm3230: Device) -> None:
    assert find_axes(indices(io_module)) == Axes(1, ())
    assert find_axes(indices(replace(tmcm3230, axes=1))) == Axes(1, ())
    assert find_axes(()) == Axes(1, ())
    assert Axes(1, ()).fold(0x6840) == (0x6840, None)


def test_an_axis_may_lack_an_object() -> None:
    whole = {0x6040, 0x6041, 0x6060, 0x607A}
    axes = find_axes(whole | {index + 0x800 for index in whole - {0x6060}} | {0x1400, 0x2000})
    assert axes == Axes(2, (Area(0x6000, 0x800),))
    assert find_axes(whole | {0x6840}) == Axes(1, ())


def test_the_entries_of_a_generated_file_are_those_of_the_model(tmcm3230: Device) -> None:
    (output,) = EdsBackend().render(tmcm3230)
    found = dictionary(parse(output.content, output.path))
    modelled = {(item.index, entry.entry.sub): entry for item in tmcm3230.expanded for entry in item.entries}
    read = {(entry.index, entry.sub): entry for entry in found.entries}
    assert read.keys() == modelled.keys()
    for at, entry in read.items():
        model = modelled[at].entry
        assert entry.data_type == model.type.code
        assert entry.access == model.eds_access
        assert entry.bits == model.type.bits
        if model.type.integer:
            assert entry.default == modelled[at].eds_default
    assert found.device == "3230"
