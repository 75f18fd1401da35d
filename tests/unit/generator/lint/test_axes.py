"""Axes that are not alike: most of them are right, and the first where there is no majority."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest

from odsmith.errors import Diagnostic, Fix

Found = Callable[..., tuple[Diagnostic, ...]]

RULES = ("L601", "L602", "L603", "L604")


def drive(axes: int, changed: Mapping[tuple[int, int], str] = {}, more: str = "") -> str:
    """A drive; `changed` gives other text for the body of an object (index on axis 0, axis), or none of it."""
    bodies = {
        0x6040: "ParameterName=Controlword {n}\nDataType=0x0006\nAccessType=rww\nPDOMapping=1\n",
        0x6041: "ParameterName=Statusword {n}\nDataType=0x0006\nAccessType=ro\nPDOMapping=1\n",
        0x6060: "ParameterName=Mode {n}\nDataType=0x0002\nAccessType=rw\nLowLimit=0\nHighLimit=9\nDefaultValue=1\n",
        0x2011: "ParameterName=Profile A1 {n}\nDataType=0x0007\nAccessType=rw\nDefaultValue=0\n",
    }
    text = ""
    for index, body in bodies.items():
        for axis in range(axes):
            own = changed.get((index, axis), body)
            at = index + axis * (0x800 if index >= 0x6000 else 0x200)
            text += f"[{at:04X}]\nObjectType=0x7\n{own.replace('{n}', str(axis + 1))}" if own else ""
    return text + more


def pdos(mapped: str) -> str:
    return "".join(
        f"[{0x1400 + 0x40 * axis:04X}]\nObjectType=9\nParameterName=RPDO {64 * axis + 1} Communication Parameter\n"
        f"[{0x1400 + 0x40 * axis:04X}sub1]\nParameterName=COB-ID\nDataType=7\nDefaultValue=0x{axis}\n"
        f"[{0x1600 + 0x40 * axis:04X}]\nObjectType=9\nParameterName=RPDO {64 * axis + 1} Mapping Parameter\n"
        f"[{0x1600 + 0x40 * axis:04X}sub1]\nParameterName=Entry 1\nDataType=7\nDefaultValue={value}\n"
        for axis, value in enumerate(mapped.split())
    )


@pytest.mark.parametrize("axes", [2, 3, 6])
def test_equal_axes_are_fine(axes: int, found: Found) -> None:
    mapped = " ".join(f"0x{0x6040 + 0x800 * axis:04X}0010" for axis in range(axes))
    assert found(drive(axes, more=pdos(mapped)), *RULES) == ()


def test_the_majority_is_right(found: Found) -> None:
    other = "ParameterName=Mode {n}\nDataType=0x0002\nAccessType=ro\nLowLimit=0\nHighLimit=9\n"
    (finding,) = found(drive(3, {(0x6060, 0): other}), *RULES)
    assert (finding.rule, finding.subject) == ("L601", "axes.6060")
    assert finding.message == (
        "6060h on axis 0 differs from 6860h on axis 1: AccessType `ro`, not `rw`; DefaultValue missing, not `1`"
    )
    assert [text for _, text in finding.notes] == ["axis 1"]


def test_without_a_majority_axis_0_is_right(found: Found) -> None:
    other = "ParameterName=Statusword {n}\nDataType=0x0006\nAccessType=rw\nPDOMapping=1\n"
    findings = found(drive(4, {(0x6041, 2): other, (0x6041, 3): other}), *RULES)
    assert [finding.message.split(":")[0] for finding in findings] == [
        "7041h on axis 2 differs from 6041h on axis 0",
        "7841h on axis 3 differs from 6041h on axis 0",
    ]


def test_spelling_of_numbers_is_no_difference(found: Found) -> None:
    other = "ParameterName=Mode {n}\nDataType=2\nAccessType=RW\nLowLimit=0x0\nHighLimit=0x9\nDefaultValue=0x01\n"
    assert found(drive(3, {(0x6060, 1): other}), *RULES) == ()


@pytest.mark.parametrize(
    ("mapped", "axes"),
    [
        ("0x60400010 0x68400010 0x60400010", [2]),
        ("0x60400010 0x68410010 0x70400010", [1]),
        ("0x10010008 0x10010008 0x10010008", []),
    ],
)
def test_each_axis_maps_its_own_objects(mapped: str, axes: list[int], found: Found) -> None:
    findings = found(drive(3, more=pdos(mapped)), *RULES)
    assert [int(finding.message.split("axis ")[1][0]) for finding in findings] == axes


@pytest.mark.parametrize(
    ("axis", "name", "spelt"),
    [(1, "Mode", "Mode 2"), (2, "mode 3", "Mode 3"), (0, "Mode 2", "Mode 1"), (1, "Mode 1", "Mode 2")],
)
def test_names_differ_in_the_number_of_the_axis_alone(axis: int, name: str, spelt: str, found: Found) -> None:
    body = f"ParameterName={name}\nDataType=0x0002\nAccessType=rw\nLowLimit=0\nHighLimit=9\nDefaultValue=1\n"
    (finding,) = found(drive(3, {(0x6060, axis): body}), *RULES)
    assert finding.rule == "L602"
    assert finding.fix == Fix(finding.place.line, finding.place.line, (f"ParameterName={spelt}",))


def test_names_of_sub_indices(found: Found) -> None:
    more = "".join(
        f"[{index}]\nObjectType=8\nParameterName=Limits {n}\n[{index}sub1]\nParameterName={name}\nDataType=4\n"
        for n, (index, name) in enumerate((("607D", "Min"), ("687D", "Min"), ("707D", "Minimum")), 1)
    )
    (finding,) = found(drive(3, more=more), *RULES)
    assert (finding.rule, finding.severity, finding.subject) == ("L603", "note", "axes.607D:1")


def test_what_one_axis_lacks(found: Found) -> None:
    (finding,) = found(drive(3, {(0x6060, 1): ""}), *RULES)
    assert (finding.rule, finding.message) == ("L604", "axis 1 lacks 6860h, which other axes have")
    more = "[607D]\nObjectType=8\n[607Dsub1]\nDataType=4\n[687D]\nObjectType=8\n[687Dsub1]\nDataType=4\n[687Dsub2]\n"
    findings = found(drive(2, more=more), *RULES)
    assert [finding.message for finding in findings] == ["607Dh lacks sub-index 2, which other axes have"]
    assert found(drive(3, {(0x6060, 1): "", (0x6060, 2): ""}), *RULES) == ()
