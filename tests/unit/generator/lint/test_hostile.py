"""Whatever the bytes are, the linter answers, and in a time that grows with their number and no faster."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from types import FrameType

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from odsmith.eds_file import parse
from odsmith.errors import Diagnostic, SourceLines, format_diagnostic
from odsmith.lint import lint

WORDS = re.findall(
    r"\S+",
    """
    FileInfo DeviceInfo DummyUsage Comments MandatoryObjects OptionalObjects ManufacturerObjects DeviceComissioning
    1000 1018 1018sub0 1018sub1 1400 1400sub0 1400sub1 1600 1600sub0 1600sub1 1A00 6040 6840 6041 6841 607Dsub1 687D
    SupportedObjects ParameterName ObjectType DataType AccessType LowLimit HighLimit DefaultValue PDOMapping ObjFlags
    SubNumber CompactSubObj ParameterValue Lines Line1 NodeID ProductName VendorNumber NrOfRXPDO CreationDate FileName
    1 2 0 7 8 9 -1 0x7 0x1000 0x60400010 0xFFFFFFFF $NODEID $NODEID+0x200 0x200+$NODEID ro rw const Controlword
    09:00AM 02-30-2026 99-99-9999 9999999999999999999999
    """,
)
ODD = ("\u00df", "\u2028", "\x85", "\0")

word = st.sampled_from((*WORDS, *ODD)) | st.text(max_size=5)
line = st.one_of(
    st.builds("[{}]".format, word),
    st.builds("{}={}".format, word, word),
    word,
    st.builds(" {} = {} ;".format, word, word),
)


def checked(data: bytes) -> tuple[Diagnostic, ...]:
    file = parse(data, "a.eds")
    findings = lint(file)
    lines = SourceLines({file.path: file.text})
    for finding in findings:
        assert 0 <= finding.place.line <= len(file.lines)
        assert format_diagnostic(finding, lines).startswith("a.eds")
        if finding.fix:
            assert 1 <= finding.fix.first <= len(file.lines) + 1
            assert finding.fix.last in (finding.fix.first, finding.fix.first - 1)
    return findings


@given(st.binary(max_size=400))
def test_any_bytes(data: bytes) -> None:
    checked(data)


@pytest.mark.slow
@given(st.lists(line, max_size=40), st.sampled_from(["\n", "\r\n", "\r"]))
@settings(max_examples=300)
def test_any_arrangement_of_words(lines: list[str], end: str) -> None:
    checked(end.join(lines).encode("utf-8", "surrogatepass"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "text",
    [
        "[" * 500_000,
        "=" * 500_000,
        "[1000]\nDataType=7\nDefaultValue=" + "9" * 500_000,
        "[1000]\nDataType=7\nDefaultValue=$NODEID" + " " * 500_000 + "x",
        "[1000]\nDataType=7\nDefaultValue=" + "A" * 500_000 + "+$NODEID",
        "[DeviceInfo]\nProductName=" + "A" * 500_000,
        "[2000]\nParameterName=" + "1 " * 250_000,
        "[" + " " * 500_000 + "\n",
        "\n" * 500_000,
        "[a]\n" + "b\n" * 20_000,
        "[a]\n" + "b=1\n" * 20_000,
        "[1000]\n" + "".join(f"key{number}=1\n" for number in range(10_000)),
        "[MandatoryObjects]\n" + "".join(f"{number}=0x1000\n" for number in range(10_000)),
        "".join(f"[section{number}]\n" for number in range(10_000)),
    ],
    ids=lambda text: text[:24].strip()[:20],
)
def test_long_texts(text: str) -> None:
    """Work that grew with the square of the text would take hours here."""
    checked(text.encode())


@pytest.mark.slow
def test_the_work_grows_with_the_file() -> None:
    """Counted in calls of functions, which do not depend on the machine."""

    def sheet(objects: int) -> bytes:
        return "".join(
            f"[{0x2000 + number:04X}]\nParameterName=x\nObjectType=7\nDataType=9\nAccessType=q\nHighLimit=\n"
            for number in range(objects)
        ).encode()

    small, large = (calls(checked, sheet(size)) for size in (500, 2000))
    assert large < 5 * small


def calls(function: Callable[[bytes], object], data: bytes) -> int:
    count = 0

    def profile(_: FrameType, event: str, __: object) -> None:
        nonlocal count
        count += event.endswith("call")

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        function(data)
    finally:
        sys.setprofile(before)
    return count
