"""A finding names its line and column, the object that it is about, and the line as it should be."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from odsmith.errors import Diagnostic, Fix, SourceLines, format_diagnostic

Found = Callable[..., tuple[Diagnostic, ...]]

DRIVE = "[DeviceInfo]\nProductName=TMCM-6212\n" + "".join(
    f"[{index + 0x800 * axis:04X}]\nParameterName=Object {index:X} {axis + 1}\nDataType=0x0007\nAccessType=rw\n"
    for index in (0x6040, 0x6041)
    for axis in (0, 1)
)
LIMIT = "[687D]\nObjectType=0x8\nSubNumber=1\n[687Dsub1]\nDataType=0x0004\nDefaultValue=0x80000001\n"


def test_a_value(found: Found) -> None:
    (finding,) = found("[607C]\nDataType=0x0004\nDefaultValue=0xFFFFFFFD\n", "L421")
    assert (finding.place.path, finding.place.line, finding.place.column, finding.length) == ("a.eds", 3, 14, 10)
    assert finding.subject == "607C"
    assert finding.fix == Fix(3, 3, ("DefaultValue=-3",))
    assert format_diagnostic(finding, SourceLines({"a.eds": "\n\nDefaultValue=0xFFFFFFFD"})) == (
        "a.eds:3:14: error[L421]: 0xFFFFFFFD is 4294967293 to some readers and -3 to others, for INTEGER32\n"
        "    DefaultValue=0xFFFFFFFD\n"
        "                 ^~~~~~~~~~\n"
        "object: 607C\n"
        "hint: write signed types in decimal\n"
        "fix: DefaultValue=-3"
    )


@pytest.mark.parametrize(
    ("text", "subject"),
    [
        (DRIVE + LIMIT + LIMIT.replace("687D", "607D"), "6212.axes.607D:1"),
        (DRIVE + LIMIT.replace("687D", "2700"), "6212.2700:1"),
        (LIMIT.replace("sub1", "subA"), "687D:A"),
        (DRIVE + "[3000]\nDataType=0x0004\nLowLimit=0xFFFFFFFF\n", "6212.3000"),
    ],
)
def test_the_object(text: str, subject: str, found: Found) -> None:
    findings = found(text, "L421")
    assert {finding.subject for finding in findings} == {subject}


def test_each_axis_has_a_finding_of_its_own(found: Found) -> None:
    findings = found(DRIVE + LIMIT + LIMIT.replace("687D", "607D"), "L421")
    assert len({finding.place.line for finding in findings}) == len(findings) == 2


def test_a_missing_key_is_found_at_its_section(found: Found) -> None:
    (finding,) = found("[1018]\nObjectType=0x9\nSubNumber=1\n[1018sub0]\nDataType=0x0005\n\n[1019]\n", "L409")
    assert (finding.place.line, finding.place.column, finding.length) == (4, 1, 10)
    assert finding.fix == Fix(6, 5, ("DefaultValue=0x00",))


def test_a_missing_section_is_found_in_the_file(found: Found) -> None:
    findings = found("[1000]\n", "L203")
    assert [finding.place.line for finding in findings] == [0] * 6


def test_an_empty_value_is_found_at_its_key(found: Found) -> None:
    (finding,) = found("[DeviceInfo]\nVendorNumber=\n", "L115")
    assert (finding.place.line, finding.place.column, finding.length) == (2, 1, 12)


@pytest.mark.parametrize(
    ("line", "spelt"),
    [
        ("  Granularity = 8 ", "Granularity=8"),
        ("granularity=8", "Granularity=8"),
        ("Granularity=08", "Granularity=8"),
        ("Granularity=255", "Granularity=8"),
        ("NrOfRXPDO=0x5", "NrOfRXPDO=0"),
        ("BaudRate_100=1", None),
    ],
)
def test_proposed_lines(line: str, spelt: str | None, found: Found) -> None:
    (finding,) = [item for item in found(f"[DeviceInfo]\n{line}\n") if item.place.line == 2]
    assert finding.fix == Fix(2, 2, (spelt,) if spelt else ())


@pytest.mark.parametrize(
    ("given", "spelt"),
    [
        ("$nodeid+0x200", "$NODEID+0x200"),
        ("0x200 + $NODEID", "$NODEID+0x200"),
        ("$NODEID", "$NODEID+0x0"),
        ("$NODEID + 512", "$NODEID+0x200"),
    ],
)
def test_the_node_id(given: str, spelt: str, found: Found) -> None:
    (finding,) = found(f"[1014]\nDataType=0x0007\nDefaultValue={given}\n", "L427")
    assert finding.fix == Fix(3, 3, (f"DefaultValue={spelt}",))
    assert not found(f"[1014]\nDataType=0x0007\nDefaultValue={spelt}\n", "L427", "L117", "L116")


def test_related_places(found: Found) -> None:
    (finding,) = found("[2000]\nParameterName=A\n[2001]\nParameterName=A\n", "L412")
    assert [(place.line, place.column, text) for place, text in finding.notes] == [(2, 15, "the name of 2000h")]
    assert finding.place.line == 4


def test_similar_words_are_suggested(found: Found) -> None:
    (finding,) = found("[2000]\nDefaultVal=1\n", "L205")
    assert finding.hint == "did you mean `DefaultValue`?"
    (finding,) = found("[2000]\nSomething=1\n", "L205")
    assert finding.hint.startswith("delete the line")
    (finding,) = found("[MandatoryObject]\n", "L202")
    assert finding.hint == "did you mean `MandatoryObjects`?"


def test_the_identity_is_told_once(found: Found) -> None:
    text = "[DeviceInfo]\nRevisionNumber=0x00030016\n[1018]\nObjectType=0x9\n" + "".join(
        f"[1018sub{sub}]\nDataType=0x0007\n{default}" for sub, default in ((1, "DefaultValue=1\n"), (3, ""), (4, ""))
    )
    (finding,) = found(text, "L311")
    assert finding.subject == "1018:3"
    assert finding.fix == Fix(10, 9, ("DefaultValue=0x00030016",))
    assert [place.line for place, _ in finding.notes] == [10]


def test_limits_that_no_entry_has_are_told_of_the_file_and_of_known_objects(found: Found) -> None:
    text = DRIVE + "".join(f"[{index}]\nDataType=0x0002\nAccessType=rw\n" for index in ("6060", "6860", "607F"))
    assert [(item.place.line, item.subject) for item in found(text, "L426")] == [(0, ""), (19, "6212.axes.6060")]
    assert [item.place.line for item in found(f"{text}LowLimit=1\n", "L426")] == [19]
