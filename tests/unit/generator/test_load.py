"""Reading YAML: what values mean, where they stand, which text is refused and how includes are found."""

from __future__ import annotations

import errno
import json
import zipfile
from collections.abc import Callable
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from odsmith import load as loader
from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, SpecError
from odsmith.load import Map, Seq, load, parse


def read(text: str) -> Map:
    return parse(text.encode(), "a.yaml")


def value(text: str) -> object:
    return read(f"v: {text}\n")["v"]


def problems(text: str | bytes) -> tuple[Diagnostic, ...]:
    with pytest.raises(SpecError) as caught:
        parse(text.encode() if isinstance(text, str) else text, "a.yaml")
    return caught.value.diagnostics


def only(text: str | bytes) -> tuple[str, int, int, str]:
    """Rule, line, column and message of the one problem of a text."""
    (found,) = problems(text)
    return found.rule, found.place.line, found.place.column, found.message


# ---- scalars --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0", 0),
        ("-12", -12),
        ("0x1F", 31),
        ("0xff", 255),
        ("-0x10", -16),
        ("18446744073709551615", (1 << 64) - 1),
        ("-9223372036854775808", -(1 << 63)),
        ("-0x8000000000000000", -(1 << 63)),
        ("true", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("6.2", "6.2"),
        ("4.2.6", "4.2.6"),
        ("2019-02-11", "2019-02-11"),
        ("0..63", "0..63"),
        ("0x00..0xFF", "0x00..0xFF"),
        ("0, 2..15", "0, 2..15"),
        ("1/1000", "1/1000"),
        ("09:00AM", "09:00AM"),
        ("$NODEID+0x80", "$NODEID+0x80"),
        ("device_block+0x02", "device_block+0x02"),
        ("only", "only"),
        ("=", "="),
        ("-", None),
        ("'on'", "on"),
        ('"0100"', "0100"),
        ('"60:40"', "60:40"),
        ("'~'", "~"),
        ("two\n  lines", "two lines"),
        ("|\n  kept\n  lines", "kept\nlines\n"),
    ],
)
def test_values(text: str, expected: object) -> None:
    if text == "-":
        assert value("\n- ") == [None]
    else:
        found = value(text)
        assert found == expected
        assert type(found) is type(expected)


@pytest.mark.parametrize("word", ["on", "Off", "YES", "no", "y", "N", "True", "FALSE", "Null", "NULL"])
def test_doubtful_words_want_quotes(word: str) -> None:
    (found,) = problems(f"v: {word}")
    assert (found.rule, found.place.column) == ("E110", 4)
    assert f'"{word}"' in found.hint
    assert value(f'"{word}"') == word
    assert problems(f"{word}: 1")[0].rule == "E110"


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("0100", "E110"),
        ("-007", "E110"),
        ("08", "E110"),
        ("0o17", "E110"),
        ("0b1", "E110"),
        ("60:40", "E110"),
        ("6040:00", "E110"),
        ("1:30:00.5", "E110"),
        ("+5", "E110"),
        ("1_000", "E110"),
        ("1e3", "E110"),
        ("1.5e3", "E110"),
        (".5e+3", "E110"),
        ("-.inf", "E110"),
        (".NaN", "E110"),
        ("0x", "E111"),
        ("0xG", "E111"),
        ("0X10", "E111"),
        ("0x1_0", "E111"),
        ("18446744073709551616", "E111"),
        ("-9223372036854775809", "E111"),
        ("9" * 5000, "E111"),
    ],
)
def test_doubtful_numbers_want_quotes(text: str, rule: str) -> None:
    (found,) = problems(f"v: {text}")
    assert (found.rule, found.place.column) == (rule, 4)
    assert value(f'"{text}"') == text


# ---- places ---------------------------------------------------------------------------------------------------------


def test_every_key_and_value_keeps_its_place() -> None:
    root = read('format: 1\nobjects:\n  - index: 0x10\n    "name": {a: [x, "y"]}\n')
    assert root.where == Place("a.yaml", 1, 1)
    assert root.key_place("objects") == Place("a.yaml", 2, 1)
    objects = root["objects"]
    assert isinstance(objects, Seq)
    assert root.place("objects") == objects.where == objects.place(0) or objects.place(0) == Place("a.yaml", 3, 5)
    entry = objects[0]
    assert isinstance(entry, Map)
    assert entry.where == entry.key_place("index") == Place("a.yaml", 3, 5)
    assert entry.place("index") == Place("a.yaml", 3, 12)
    assert entry.key_place("name") == Place("a.yaml", 4, 5)
    inner = entry["name"]
    assert isinstance(inner, Map)
    assert inner.where == entry.place("name") == Place("a.yaml", 4, 13)
    items = inner["a"]
    assert isinstance(items, Seq)
    assert [items.place(0).column, items.place(1).column] == [18, 21]


def test_what_is_not_there_has_the_place_of_its_owner() -> None:
    root = read("a: [1]\n")
    items = root["a"]
    assert isinstance(items, Seq)
    assert root.place("b") == root.key_place("b") == root.where
    assert items.place(7) == items.where


def test_taking_over_keeps_places() -> None:
    source = read("a: [1, 2]\nb: 3\n")
    copy = source.empty_copy()
    copy.take(source, "b")
    assert copy == {"b": 3}
    assert copy.place("b") == source.place("b")
    items = source["a"]
    assert isinstance(items, Seq)
    part = items.empty_copy()
    part.take(items, 1)
    assert part == [2]
    assert part.place(0) == items.place(1)
    assert source == {"a": [1, 2], "b": 3}


# ---- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\nb: 2\na: 3", ("E113", 3, 1, "the key `a` is given twice")),
        ("v: {a: 1, 'a': 2}", ("E113", 1, 11, "the key `a` is given twice")),
        ("v: {0: x}", ("E112", 1, 5, "the key `0` is an integer")),
        ("v: {0x6040: x}", ("E112", 1, 5, "the key `0x6040` is an integer")),
        ("v: {true: x}", ("E112", 1, 5, "the key `true` is no text")),
        ("v: {~: x}", ("E112", 1, 5, "the key `~` is no text")),
        ("? \n: x", ("E112", 1, 2, "a key is empty")),
        ("v: {[a]: x}", ("E112", 1, 5, "a mapping or list cannot be a key")),
        ("v: {6040:00: x}", ("E110", 1, 5, "`6040:00` is a number to the base 60 to some YAML readers")),
        ("v: &a 1", ("E114", 1, 4, "`&a` is an anchor")),
        ("v: &a [1]", ("E114", 1, 4, "`&a` is an anchor")),
        ("&a v: 1", ("E114", 1, 1, "`&a` is an anchor")),
        ("v: *a", ("E114", 1, 4, "`*a` is an alias")),
        ("*a : v", ("E114", 1, 1, "`*a` is an alias")),
        ("v: !x 1", ("E115", 1, 4, "`!x` is a tag")),
        ("v: !!int 1", ("E115", 1, 4, "`tag:yaml.org,2002:int` is a tag")),
        ("v: ! x", ("E115", 1, 4, "`!` is a tag")),
        ("!!map {v: 1}", ("E115", 1, 1, "`tag:yaml.org,2002:map` is a tag")),
        ("<<: {a: 1}", ("E116", 1, 1, "`<<` is a merge key")),
        ("a: 1\n---\nb: 2", ("E109", 2, 1, "a second document begins here")),
        ("", ("E105", 0, 0, "the file is empty")),
        ("# nothing\n", ("E105", 0, 0, "the file is empty")),
        ("---\n", ("E105", 0, 0, "the file is empty")),
        ("- a\n", ("E117", 1, 1, "the file is a list, not a mapping of sections")),
        ("\nhello\n", ("E117", 2, 1, "the file is text, not a mapping of sections")),
        ("a:\n\tb: 1", ("E107", 2, 1, "a tab in the indentation")),
        ("a:\n  \tb: 1", ("E107", 2, 3, "a tab in the indentation")),
        ("v: " + "[" * 65 + "]" * 65, ("E108", 1, 67, "mappings and lists are nested deeper than 64")),
    ],
)
def test_refused(text: str, expected: tuple[str, int, int, str]) -> None:
    assert only(text) == expected


def test_64_levels_are_allowed() -> None:
    assert value("[" * 63 + "]" * 63)


def test_quoted_merge_key_is_text() -> None:
    assert read('"<<": 1') == {"<<": 1}


def test_a_duplicate_names_both_places() -> None:
    (found,) = problems("a: 1\nb: 2\na: 3")
    assert found.notes == ((Place("a.yaml", 1, 1), "first given here"),)


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"a: 1\nb: \xff", ("E103", 2, 1, "byte 8 (0xFF) is not UTF-8")),
        (b"a: 1\nb: x\0y", ("E103", 2, 5, "the file contains a NUL byte")),
        (b"a: \x1b[31m", ("E103", 1, 4, "the file contains the control character U+001B")),
        (b"a: 1\xef\xbb\xbf", ("E103", 1, 5, "the file contains the control character U+FEFF")),
        (b"\xff\xfea\x00", ("E103", 1, 1, "the file is UTF-16, not UTF-8")),
        (b"\xef\xbb\xbfa: 1", ("E104", 1, 1, "the file begins with a byte order mark")),
    ],
)
def test_what_is_no_text(data: bytes, expected: tuple[str, int, int, str]) -> None:
    assert only(data) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("text: a: b", (1, 8, "a `:` is not allowed here")),
        ("a: 1\n b: 2", (2, 3, "a `:` is not allowed here")),
        ("a: 1\nb", (2, 1, "the key has no `:`")),
        ("a: 'x", (1, 4, "the quoted text is not closed")),
        ('a: "x\n', (1, 4, "the quoted text is not closed")),
        ("a: [1, 2\n", (1, 4, "the list that begins here is not closed")),
        ("a: {b: 2\n", (1, 4, "the mapping that begins here is not closed")),
        ("a: [1, 2\nb: 3\n", (2, 2, "the list in brackets goes wrong here")),
        ("a: {b: [1}}\n", (1, 10, "the list in brackets goes wrong here")),
        ("a: {b: 1]}\n", (1, 9, "the mapping in braces goes wrong here")),
        ('a: "\\q"', (1, 5, "the backslash begins an unknown escape")),
        ("- a\nb: c", (2, 1, "an item of the list was expected here")),
        ('a: "x" y', (1, 8, "a key of the mapping was expected here")),
        ("a: - b", (1, 4, "a list cannot begin here")),
        ("a: @x", (1, 4, "text cannot begin with `@`")),
        ("a: %x", (1, 4, "text cannot begin with `%`")),
        ("a: }", (1, 4, "a value was expected here")),
        ("a: 1\n...\nb", (3, 1, "text follows the end of the document")),
        ("%FOO\n---\na: 1", (1, 5, "YAML cannot read this: found unknown directive name")),
    ],
)
def test_syntax_errors_are_sentences(text: str, expected: tuple[int, int, str]) -> None:
    assert only(text) == ("E106", *expected)


def test_all_errors_of_a_file_are_told() -> None:
    found = problems("a: on\nb: 0100\nc: &x 1\nc: 2\n")
    assert [item.rule for item in found] == ["E110", "E110", "E114", "E113"]


def test_reading_stops_after_many_errors() -> None:
    found = problems("a: [" + "on, " * 500 + "]")
    assert len(found) == 101
    assert found[-1].rule == "E122"
    assert len(problems("\ta\n" * 500)) == 100


# ---- files ----------------------------------------------------------------------------------------------------------


class Files:
    """A folder to write files into and to load one of them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, **texts: str) -> Path:
        for name, text in texts.items():
            path = self.folder / (name.replace("__", "/") + ".yaml")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return self.folder / f"{next(iter(texts))}.yaml"

    def problems(self, path: Path, *library: Traversable) -> tuple[Diagnostic, ...]:
        with pytest.raises(SpecError) as caught:
            load(path, library)
        return caught.value.diagnostics


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Files:
    monkeypatch.chdir(tmp_path)
    return Files(tmp_path)


def test_includes_come_first_and_each_once(files: Files) -> None:
    root = files.write(
        root="format: 1\ninclude: [a.yaml, sub/b.yaml]\n",
        a="format: 1\ninclude: [sub/c.yaml]\n",
        sub__b="format: 1\ninclude: [c.yaml, ../a.yaml]\n",
        sub__c="format: 1\n",
    )
    loaded = load(root)
    names = [Path(document.where.path).relative_to(files.folder).as_posix() for document in loaded.documents]
    assert names == ["sub/c.yaml", "a.yaml", "sub/b.yaml", "root.yaml"]
    assert loaded.root is loaded.documents[-1]
    assert sorted(path.name for path in loaded.files) == ["a.yaml", "b.yaml", "c.yaml", "root.yaml"]
    assert loaded.lines(str(root))[1] == "include: [a.yaml, sub/b.yaml]"
    assert set(loaded.texts) == {document.where.path for document in loaded.documents}


def test_a_link_is_the_file_that_it_leads_to(files: Files) -> None:
    root = files.write(root="format: 1\ninclude: [a.yaml, b.yaml]\n", a="format: 1\n")
    (files.folder / "b.yaml").symlink_to("a.yaml")
    assert len(load(root).documents) == 2


def test_the_library_is_the_second_place_to_look(files: Files) -> None:
    root = files.write(
        root="format: 1\ninclude: [cia/a.yaml]\n",
        lib__cia__a="format: 1\ninclude: [../b.yaml]\nbases: {x: 1}\n",
        lib__b="format: 1\n",
    )
    library = files.folder / "lib"
    assert [document.get("bases") for document in load(root, [library]).documents] == [None, {"x": 1}, None]
    files.write(cia__a="format: 1\n")
    assert [document.get("bases") for document in load(root, [library]).documents] == [None, None]


def test_the_library_may_be_a_zip(files: Files) -> None:
    root = files.write(root="format: 1\ninclude: [cia/a.yaml]\n")
    with zipfile.ZipFile(files.folder / "lib.zip", "w") as archive:
        archive.writestr("spec/cia/a.yaml", "format: 1\ninclude: [../b.yaml, ../../outside.yaml]\n")
        archive.writestr("spec/b.yaml", "format: 1\n")
        archive.writestr("outside.yaml", "format: 1\n")
    library = zipfile.Path(files.folder / "lib.zip", "spec/")
    (found,) = files.problems(root, library)
    assert found.rule == "E120"
    assert "../../outside.yaml" in found.message


def test_a_missing_include_names_the_chain_and_where_it_was_looked_for(files: Files) -> None:
    root = files.write(root="format: 1\ninclude: [a.yaml]\n", a="format: 1\ninclude:\n  - gone.yaml\n")
    (found,) = files.problems(root, files.folder / "lib")
    assert (found.rule, found.message) == ("E120", "include `gone.yaml` was not found")
    assert found.place == Place(str(files.folder / "a.yaml"), 3, 5)
    assert found.hint == "looked for `gone.yaml` and `lib/gone.yaml`"
    assert found.notes == ((Place(str(root), 2, 11), "included from here"),)


def test_a_cycle_names_its_files(files: Files) -> None:
    root = files.write(
        root="format: 1\ninclude: [a.yaml]\n",
        a="format: 1\ninclude: [b.yaml]\n",
        b="format: 1\ninclude: [a.yaml]\n",
    )
    (found,) = files.problems(root)
    assert found.rule == "E121"
    assert found.message.endswith("a.yaml > b.yaml > a.yaml")
    assert [place.path for place, _ in found.notes] == [str(files.folder / "a.yaml"), str(root)]


def test_a_file_that_includes_itself_is_a_cycle(files: Files) -> None:
    (found,) = files.problems(files.write(root="format: 1\ninclude: [root.yaml]\n"))
    assert found.message.endswith("root.yaml > root.yaml")


def test_a_long_chain_of_includes_ends(files: Files) -> None:
    root = files.write(**{f"f{i}": f"format: 1\ninclude: [f{i + 1}.yaml]\n" for i in range(80)})
    (found,) = files.problems(root)
    assert (found.rule, len(found.notes)) == ("E108", 63)


@pytest.mark.parametrize(
    ("include", "rule"),
    [
        ("a.yaml", "E119"),
        ("", "E119"),
        ("[1]", "E119"),
        ("['']", "E119"),
        ("[{a: 1}]", "E119"),
        ("[/etc/passwd]", "E119"),
        ("['a\\b.yaml']", "E119"),
        ("['C:/a.yaml']", "E119"),
        ('["a\\0"]', "E119"),
        ("[folder]", "E101"),
        (f"[{'a' * 300}]", "E101"),
    ],
)
def test_bad_includes(files: Files, include: str, rule: str) -> None:
    (files.folder / "folder").mkdir()
    (found,) = files.problems(files.write(root=f"format: 1\ninclude: {include}\n"))
    assert found.rule == rule
    assert found.place.line == 2


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("axes: {}\n", 1, "the file does not say which format it has"),
        ("axes: {}\nformat: 2\n", 2, "format `2` is unknown; this program reads format 1"),
        ("axes: {}\nformat: true\n", 2, "format `true` is unknown; this program reads format 1"),
        ("axes: {}\nformat: '1'\n", 2, "format `1` is unknown; this program reads format 1"),
    ],
)
def test_the_format_must_be_known(files: Files, text: str, line: int, message: str) -> None:
    (found,) = files.problems(files.write(root=text))
    assert (found.rule, found.place.line, found.message) == ("E118", line, message)


def test_errors_of_all_files_are_told_together(files: Files) -> None:
    root = files.write(
        root="format: 1\ninclude: [a.yaml, gone.yaml, b.yaml]\nx: on\n",
        a="format: 1\nx: [\n",
        b="x: 0100\n",
    )
    assert [item.rule for item in files.problems(root)] == ["E106", "E118", "E110", "E120", "E110"]


def test_files_that_cannot_be_read(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    (found,) = files.problems(files.folder / "gone.yaml")
    assert (found.rule, found.message) == ("E101", "`gone.yaml` does not exist")
    assert found.place == Place(str(files.folder / "gone.yaml"), 0, 0)
    (found,) = files.problems(files.folder)
    assert found.message.endswith("is a folder, not a file")
    (found,) = files.problems(Path("/dev/null"))
    assert found.message == "`/dev/null` is not a file"

    def refuse(*_: Any, **__: Any) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    root = files.write(root="format: 1\n")
    monkeypatch.setattr(Path, "open", refuse)
    (found,) = files.problems(root)
    assert found.message == "`root.yaml` cannot be read: permission denied"


def test_a_file_that_is_too_large_is_not_parsed(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    root = files.write(root="format: 1\n")
    with root.open("ab") as stream:
        stream.truncate(10 * 1024 * 1024)

    def refuse(*_: Any) -> None:
        raise AssertionError("parsed")

    monkeypatch.setattr(loader, "_document", refuse)
    (found,) = files.problems(root)
    assert (found.rule, found.message) == ("E102", "`root.yaml` is larger than 4 MB")


def test_the_error_of_a_load_knows_its_sources(files: Files) -> None:
    root = files.write(root="format: 1\nx: on\n")
    with pytest.raises(SpecError) as caught:
        load(root)
    assert str(caught.value).startswith("root.yaml:2:4: error[E110]: ")
    assert "\n    x: on\n       ^~\n" in str(caught.value)


# ---- properties -----------------------------------------------------------------------------------------------------

TEXT = st.text(st.characters(max_codepoint=0xFFFF, exclude_categories=["Cs"]), max_size=20)
SCALARS = st.none() | st.booleans() | st.integers(-(1 << 63), (1 << 64) - 1) | TEXT
STRUCTURES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4), max_leaves=25
)
DOCUMENTS = st.dictionaries(TEXT, STRUCTURES, min_size=1, max_size=5)


def in_blocks(node: object, indent: str = "") -> str:
    """A structure as block YAML, every string in double quotes."""
    if isinstance(node, dict) and node:
        return "".join(f"{indent}{json.dumps(key)}:{below(item, indent)}" for key, item in node.items())
    assert isinstance(node, list)
    return "".join(f"{indent}-{below(item, indent)}" for item in node)


def below(node: object, indent: str) -> str:
    if isinstance(node, (dict, list)) and node:
        return "\n" + in_blocks(node, indent + "  ")
    return f" {json.dumps(node)}\n"


def same(found: object, expected: object) -> bool:
    """Equal, with equal types all the way down: 1 is not True."""
    if isinstance(expected, dict):
        return (
            isinstance(found, Map)
            and list(found) == list(expected)
            and all(same(found[key], expected[key]) for key in expected)
        )
    if isinstance(expected, list):
        return isinstance(found, Seq) and len(found) == len(expected) and all(map(same, found, expected))
    return type(found) is type(expected) and found == expected


@pytest.mark.parametrize("write", [json.dumps, in_blocks], ids=["flow", "blocks"])
def test_what_is_written_is_what_is_read(write: Callable[[object], str]) -> None:
    @given(DOCUMENTS)
    @example({"": [{}, [], [[]], {"a": {"b": None}}]})
    def round_trip(document: dict[str, object]) -> None:
        assert same(read(write(document)), document)

    round_trip()


@given(DOCUMENTS)
def test_places_lead_back_to_the_text(document: dict[str, object]) -> None:
    text = in_blocks(document)
    lines = text.split("\n")
    root = read(text)
    for key, item in document.items():
        place = root.key_place(key)
        assert lines[place.line - 1][place.column - 1 :].startswith(json.dumps(key) + ":")
        place = root.place(key)
        first = lines[place.line - 1][place.column - 1 :]
        assert first.startswith(json.dumps(item) if not isinstance(item, (dict, list)) or not item else ('"', "-"))


def refused_or_read(data: bytes) -> None:
    """Fails if anything but SpecError comes out, or one that says nothing, or nothing that a terminal may have."""
    report = "error[E"
    try:
        parse(data, "a.yaml")
    except SpecError as error:
        report = str(error)
    assert "error[E" in report
    assert report.replace("\n", "").isprintable()


@given(st.binary(max_size=200))
def test_bytes_are_read_or_refused(data: bytes) -> None:
    refused_or_read(data)


PIECES = st.sampled_from(
    [
        *"abn:-?#&*!|>'\"%@`[]{},\\~<=. \n\t\r0123xX_+$",
        "a: ",
        "\n  ",
        "- ",
        "? ",
        "<<: ",
        "---\n",
        "...\n",
        "on",
        "\u2028",
        "é",
    ]
)


@given(st.lists(PIECES, max_size=60).map("".join))
def test_yaml_like_text_is_read_or_refused(text: str) -> None:
    refused_or_read(text.encode())


@pytest.mark.parametrize(
    "text",
    ["a: " + "1" * 1_000_000 + "x", "a: " + "1_" * 500_000, "a: 1" + ":1" * 500_000, "[" * 1_000_000, "- " * 500_000],
    ids=["digits", "underscores", "colons", "brackets", "dashes"],
)
def test_hostile_text(text: str) -> None:
    """Work that grew with the square of the text would take minutes here."""
    refused_or_read(text.encode())
