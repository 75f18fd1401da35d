"""Reading the text of a manual: contents, tables and where each cell stands."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from odsmith.coverage.manual_text import ManualText, clean, read_manual
from odsmith.errors import UsageError

Read = Callable[[str], ManualText]


def test_contents_and_tables(printed: str, manual_of: Read) -> None:
    manual = manual_of(printed)
    assert manual.title == "TOY-2 Operating Manual"
    assert list(manual.contents)[:4] == ["1", "1.1", "1.2", "2"]
    assert manual.contents["2.2"] == "Object 2002h : Speeds"
    assert sorted(manual.tables) == list(range(1, 29))


def test_a_table_knows_its_caption_heading_and_object(printed: str, manual_of: Read) -> None:
    tables = manual_of(printed).tables
    assert tables[6].caption == "Entry Description (2001h)"
    assert tables[11].index == 0x2003  # the h stands outside of the brackets
    assert tables[14].mode == "pp"
    assert tables[14].index == 0x6040  # from the list of contents, for the heading itself is misread
    assert not tables[14].about_one_object
    assert tables[16].about_one_object
    assert tables[20].index is None


def test_cells_know_where_they_stand(printed: str, manual_of: Read) -> None:
    lines = printed.split("\n")
    for table in manual_of(printed).tables.values():
        assert lines[table.place.line - 1].startswith(f"Table {table.number}: ")
        for row in table.rows:
            for cell in row:
                line = lines[cell.place.line - 1]
                assert clean(line[cell.place.column - 1 :].split("\t")[0]) == cell.text


def test_repeated_headings_are_no_rows(printed: str, manual_of: Read) -> None:
    rows = manual_of(printed).tables[21].body("Error code")
    assert [row[0].text for row in rows] == ["", "8110h", "", "8611h"]
    assert manual_of(printed).tables[21].body("Abort code") == ()
    assert manual_of(printed).tables[21].heads("Abort code") == ()


def test_short_rows_are_filled(manual_of: Read) -> None:
    manual = manual_of("T\n1\tA\t1\n\n1 A\n\nSub-index\tAccess\tRange\n0\tro\n\nTable 1: X\n")
    (row,) = manual.tables[1].body("Sub-index")
    assert [cell.text for cell in row] == ["0", "ro", ""]


def test_another_layout_of_the_contents(manual_of: Read) -> None:
    text = """Toy
        Contents
        1 Preface 7
        1.1 Motion™ Controller ............ 12
        1.2 Method 33 and 34: Index ...99
        some footer 2 / 134
        2 Objects 100
        1 Preface
        This sentence ends in 2
        Table 1: A
        """
    manual = manual_of("\n".join(line.strip() for line in text.split("\n")))
    assert manual.contents == {
        "1": "Preface", "1.1": "Motion™ Controller", "1.2": "Method 33 and 34: Index", "2": "Objects"
    }  # fmt: skip
    assert manual.tables[1].rows == ()


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("1000 _h", "1000h"),
        ("FFFC0192_h", "FFFC0192h"),
        ("80_{h} + 1", "80h + 1"),
        (" a_high ", "a_high"),
        ("x _h:", "xh:"),
    ],
)
def test_subscripts(text: str, meant: str) -> None:
    assert clean(text) == meant


def test_what_is_no_manual(tmp_path: Path) -> None:
    path = tmp_path / "m.txt"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="no UTF-8 text"):
        read_manual(path)
    path.write_text("1\tA\t2\n")
    with pytest.raises(UsageError, match="no captions of tables"):
        read_manual(path)
    with pytest.raises(FileNotFoundError):
        read_manual(tmp_path / "nothing.txt")
