"""The reader of EDS and DCF files: every section and key with its place, and no text that it fails on."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.eds_file import MAX_BYTES, EdsFile, Key, is_eds, parse, read
from odsmith.errors import SourceLines, SpecError


def parsed(text: str) -> EdsFile:
    return parse(text.encode("utf-8"), "a.eds")


def test_sections_and_keys_with_their_places() -> None:
    file = parsed("[FileInfo]\r\nFileName=a.eds\r\n\r\n  [1000]\r\n\tDataType =  0x0007 \r\n")
    assert [(s.name, s.line, s.column, s.end) for s in file.sections] == [("FileInfo", 1, 1, 2), ("1000", 4, 3, 5)]
    assert file.sections[0].keys == (Key("FileName", "a.eds", 2, 1, 10),)
    assert file.sections[1].keys == (Key("DataType", "0x0007", 5, 2, 14),)


@pytest.mark.parametrize("end", ["\r\n", "\n", "\r"])
def test_every_line_end_counts_the_same(end: str) -> None:
    file = parsed(end.join(["; comment", "[1000]", "a=1", "", "b=2"]))
    assert [key.line for key in file.sections[0].keys] == [3, 5]
    assert file.comments == (1,)


def test_names_are_found_without_regard_to_case_and_the_first_one_counts() -> None:
    file = parsed("[1000]\nDataType=1\ndatatype=2\n[DeviceInfo]\nA=1\n[Device Info]\nA=2\n")
    section = file.sections[0]
    assert section.value("DATATYPE") == "1"
    assert section.repeats
    assert not file.sections[1].repeats
    assert section.get("ObjectType") is None
    assert section.value("ObjectType") == ""
    assert file.section("deviceinfo") is file.sections[1]
    assert file.section("FileInfo") is None


def test_what_is_no_section_and_no_key() -> None:
    file = parsed("a=1\n[1000]\nnothing\n=2\n;c\n#d\n ;e\nb=\n")
    assert file.strays == (1, 3, 4)
    assert file.comments == (5, 6, 7)
    assert file.sections[0].keys == (Key("b", "", 8, 1, 3),)


@pytest.mark.parametrize(
    ("line", "name"),
    [("[1000", "1000"), ("[1000] x", "1000"), ("[a]b]", "a]b"), ("[", ""), ("[]", ""), ("[ 1 ]", " 1 ")],
)
def test_headings_of_any_form(line: str, name: str) -> None:
    assert [section.name for section in parsed(line).sections] == [name]


def test_the_value_begins_behind_the_first_equals_sign() -> None:
    assert parsed("[a]\nLine1=a=b").sections[0].keys == (Key("Line1", "a=b", 2, 1, 7),)


@pytest.mark.parametrize(
    ("data", "value"),
    [
        (b"\xef\xbb\xbf[a]\nb=c", "c"),
        ("[a]\nb=\u00e4\u20ac".encode(), "\u00e4\u20ac"),
        ("[a]\nb=\u00e4\u20ac".encode("cp1252"), "\u00e4\u20ac"),
        (b"[a]\nb=\x81\xff", "\ufffd\u00ff"),
    ],
)
def test_encodings(data: bytes, value: str) -> None:
    assert parse(data, "a.eds").sections[0].value("b") == value


def test_the_text_for_display_has_the_lines_that_are_counted() -> None:
    file = parsed("[a]\r\nb=\u2028\u0085\rc=1\n\nd=2")
    lines = SourceLines({file.path: file.text})(file.path)
    assert len(lines) == len(file.lines)
    assert lines[4] == "d=2"


@given(st.binary())
def test_any_bytes_are_read(data: bytes) -> None:
    file = parse(data, "a.eds")
    for section in file.sections:
        assert file.lines[section.line - 1][section.column - 1] == "["
        for key in section.keys:
            line = file.lines[key.line - 1]
            assert line[key.column - 1 :].startswith(key.name)
            assert line[key.value_column - 1 :].startswith(key.value)
    assert len(SourceLines({"a.eds": file.text})("a.eds")) == len(file.lines)


# ---- files -------------------------------------------------------------------------------------------------------


def refusal(path: Path) -> tuple[str, str]:
    with pytest.raises(SpecError) as caught:
        read(path)
    (finding,) = caught.value.diagnostics
    assert finding.place.path == str(path)
    return finding.rule, finding.message


@pytest.mark.parametrize(
    "content", ["[FileInfo]\n", "\n; made by\n[deviceinfo]", "[1018sub1]\nDefaultValue=1", "[ 1000 ]"]
)
def test_a_file_with_a_section_of_cia_306_is_an_eds(content: str, tmp_path: Path) -> None:
    path = tmp_path / "a.eds"
    path.write_text(content)
    assert read(path).path == str(path)


@pytest.mark.parametrize("content", ["", "format: 1\n", "[project]\nname = 1\n", "FileInfo\n", "{}", "<xml/>"])
def test_other_files_are_none(content: str, tmp_path: Path) -> None:
    path = tmp_path / "a.eds"
    path.write_text(content)
    assert refusal(path)[0] == "L100"


def test_missing_files_and_folders(tmp_path: Path) -> None:
    assert refusal(tmp_path / "a.eds") == ("E101", f"`{short(tmp_path / 'a.eds')}` does not exist")
    assert refusal(tmp_path) == ("E101", f"`{short(tmp_path)}` is a folder, not a file")
    assert refusal(Path("a\0b.eds"))[0] == "E101"


def short(path: Path) -> str:
    return str(path) if len(str(path)) <= 60 else str(path)[:57] + "..."


def test_binary_files(tmp_path: Path) -> None:
    path = tmp_path / "a.eds"
    path.write_bytes(b"[FileInfo]\0")
    assert refusal(path) == ("E103", f"`{short(path)}` is binary")
    path.write_bytes("[FileInfo]\r\n".encode("utf-16"))
    assert refusal(path) == ("E103", f"`{short(path)}` is UTF-16")


def test_files_too_large(tmp_path: Path) -> None:
    path = tmp_path / "a.eds"
    with path.open("wb") as stream:
        stream.truncate(MAX_BYTES + 1)
    assert refusal(path)[0] == "E102"


def test_what_the_name_calls_an_eds() -> None:
    assert all(map(is_eds, map(Path, ("a.eds", "a.DCF", "b/a.Eds"))))
    assert not any(map(is_eds, map(Path, ("a.yaml", "eds", "a.eds/b"))))
