"""What counts as the same, function by function."""

from __future__ import annotations

import pytest

from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection
from odsmith.coverage.printed import (
    alike,
    intervals,
    number,
    same_data_type,
    same_default,
    same_mapping,
    same_object_type,
    same_range,
    same_title,
)
from odsmith.fields import parse_range
from odsmith.model import Default, Entry


def entry(allowed: str = "", data_type: DataType = DataType.UNSIGNED8) -> Entry:
    limits = parse_range(allowed) if allowed else None
    return Entry(0, "x", "X", "X", data_type, Access.RW, PdoDirection.NO, None, "", allowed=limits)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0", 0),
        ("-3", -3),
        ("80h", 0x80),
        ("0286h", 0x286),
        ("656b616dh", 0x656B616D),
        ("3.2", None),
        ("", None),
        ("h", None),
    ],
)
def test_number(text: str, value: int | None) -> None:
    assert number(text) == value


def test_titles_are_the_same_whatever_their_capitals() -> None:
    assert same_title("Profile  Velocity.", "Profile velocity")
    assert not same_title("Node ID", "Node-ID")


def test_object_types() -> None:
    assert same_object_type("Variable", ObjectType.VAR)
    assert same_object_type("RECORD", ObjectType.RECORD)
    assert not same_object_type("Vecord", ObjectType.RECORD)
    assert not same_object_type("Array", ObjectType.RECORD)


def test_data_types() -> None:
    assert same_data_type("SIGNED8", [DataType.INTEGER8])
    assert same_data_type("Visible String", [DataType.VISIBLE_STRING])
    assert same_data_type("UNSIGNED32", [DataType.UNSIGNED32, DataType.UNSIGNED32])
    assert not same_data_type("UNSIGNED8", [DataType.INTEGER8])
    assert not same_data_type("UNSIGNED32", [DataType.UNSIGNED32, DataType.UNSIGNED8])
    assert not same_data_type("Identity", [DataType.UNSIGNED32])


def test_mapping() -> None:
    assert same_mapping("yes", PdoDirection.TX)
    assert same_mapping("No", PdoDirection.NO)
    assert not same_mapping("yes", PdoDirection.NO)
    assert not same_mapping("mappable", PdoDirection.TX)


@pytest.mark.parametrize(
    ("text", "range_text"),
    [
        ("0...63", "0..63"),
        ("0..65535", "0..65535"),
        ("-3...12", "-3..12"),
        ("0...ffffffffh", "0..4294967295"),
        ("0...65535 [0.000032s]", "0..65535"),
        ("0/1", "0, 1"),
        ("0 / 2...15", "0, 2..15"),
        ("20,50,100", "20, 50, 100"),
        ("2", "2"),
    ],
)
def test_intervals(text: str, range_text: str) -> None:
    assert intervals(text) == parse_range(range_text)


@pytest.mark.parametrize("text", ["", "see above", "UNSIGNED8", "5...1", "1...", "one", "0...3 volts"])
def test_what_is_no_range(text: str) -> None:
    assert intervals(text) is None


def test_ranges() -> None:
    assert same_range("0...63", entry("0..63"))
    assert same_range("0...2", entry("0, 1, 2"))  # how other values are refused is not printed
    assert not same_range("0...63", entry("0..62"))
    assert not same_range("0...63", entry())
    assert same_range("UNSIGNED8", entry())
    assert not same_range("UNSIGNED16", entry())
    assert not same_range("UNSIGNED8", entry("0..2"))
    for nothing in ("—", "-", "", "see above", "See command coding above."):
        assert same_range(nothing, entry())
        assert not same_range(nothing, entry("0..2"))


def test_defaults() -> None:
    assert same_default("80h", Default(0x80))
    assert same_default("0 (enter stopped state)", Default(0))
    assert same_default("TMCM-3230", Default(text="TMCM-3230"))
    assert same_default("200h + Node-ID", Default(0x200, node_id=True))
    assert same_default("80h + Node ID", Default(0x80, node_id=True))
    assert not same_default("200h", Default(0x200, node_id=True))
    assert not same_default("200h + Node-ID", Default(0x200))
    assert not same_default("80", Default(0x80))
    assert not same_default("depends", Default(0))
    assert not same_default("1.00", Default(text="1.01"))
    for nothing in ("—", "-", "no", ""):
        assert same_default(nothing, None)
        assert not same_default(nothing, Default(0))
    assert not same_default("0", None)


def test_identifiers_fit_what_is_printed() -> None:
    assert alike("New set point", "new_set_point")
    assert alike("Set point acknowledged", "set_point_acknowledge")
    assert alike("Left limit switch deactivated if set.", "left_limit_off")
    assert alike("OLA", "open_load_bridge_a", "Open load on bridge A (OLA).")
    assert alike("11 bit ID", "can_id")
    assert not alike("Right limit switch", "left_limit_off")
    assert not alike("OLB", "open_load_bridge_a", "Open load on bridge A (OLA).")
    assert not alike("Target position", "target_velocity_used", "1 while the axis follows the target velocity.")
    assert not alike("", "left")
