"""Reads specification files: YAML text and its includes become trees that know where everything was written.

Only libyaml's event stream is used; the trees are built here, because every key and value must keep its place and
because YAML's own idea of what a plain word means (`off` is false, `0100` is 64, `6040:00` is 362400) is what the
format rules out. Nothing else is judged in this module: which keys there may be is the schema's business.
"""

from __future__ import annotations

import os.path
import posixpath
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, NoReturn

import yaml
from yaml._yaml import CParser

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, SourceLines, SpecError, listed, quoted, shown_path, split_lines
from odsmith.rules import diagnose

FORMAT = 1
"""The version of the format that this program reads."""

MAX_BYTES = 4 * 1024 * 1024
MAX_DEPTH = 64
MAX_ERRORS = 100

Scalar = str | int | bool | None


class Map(dict[str, "Map | Seq | Scalar"]):
    """A mapping of a YAML file that knows where it and each of its keys and values was written."""

    __slots__ = ("_where", "marks")

    def __init__(self, path: str, line: int, column: int) -> None:
        self._where = (path, line, column)
        self.marks: dict[str, tuple[str, int, int, int, int]] = {}

    @property
    def where(self) -> Place:
        """The place where the mapping begins."""
        return Place(*self._where)

    def place(self, key: str) -> Place:
        """The place of the value of a key; of the mapping itself if there is no such key."""
        mark = self.marks.get(key)
        return Place(mark[0], mark[3], mark[4]) if mark else self.where

    def key_place(self, key: str) -> Place:
        """The place of a key; of the mapping itself if there is no such key."""
        mark = self.marks.get(key)
        return Place(mark[0], mark[1], mark[2]) if mark else self.where

    def take(self, other: Map, key: str) -> None:
        """Adds the value that another mapping has under a key, with its place."""
        self[key] = other[key]
        self.marks[key] = other.marks[key]

    def empty_copy(self) -> Map:
        """A mapping without keys at the same place."""
        return Map(*self._where)


class Seq(list["Map | Seq | Scalar"]):
    """A list of a YAML file that knows where it and each of its items was written."""

    __slots__ = ("_where", "marks")

    def __init__(self, path: str, line: int, column: int) -> None:
        self._where = (path, line, column)
        self.marks: list[tuple[str, int, int]] = []

    @property
    def where(self) -> Place:
        """The place where the list begins."""
        return Place(*self._where)

    def place(self, index: int) -> Place:
        """The place of an item; of the list itself if there is no such item."""
        return Place(*self.marks[index]) if -len(self) <= index < len(self) else self.where

    def take(self, other: Seq, index: int) -> None:
        """Adds an item of another list, with its place."""
        self.append(other[index])
        self.marks.append(other.marks[index])

    def empty_copy(self) -> Seq:
        """A list without items at the same place."""
        return Seq(*self._where)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A root file and everything that it includes.

    `documents` stand in the order in which they are merged: includes first, the root last. `texts` has the raw text
    of every file by the path that places name; `files` are the files on disk, for whoever watches them.
    """

    root: Map
    documents: tuple[Map, ...]
    texts: Mapping[str, str]
    files: tuple[Path, ...]

    @property
    def lines(self) -> SourceLines:
        """The source lines of every file, for `format_diagnostic`."""
        return SourceLines(self.texts)


def load(path: str | Path, library: Sequence[Traversable] = ()) -> Loaded:
    """Reads a root file and its includes, which are looked up beside the including file, then in `library`.

    Raises SpecError with every error of every file.
    """
    loader = _Loader(library)
    loader.load_root(Path(path))
    if loader.diagnostics:
        raise SpecError(loader.diagnostics, loader.texts)
    return Loaded(loader.documents[-1], tuple(loader.documents), loader.texts, tuple(loader.files))


def parse(data: bytes, path: str) -> Map:
    """The tree of one file's content; `path` is the name that places carry. Raises SpecError."""
    diagnostics: list[Diagnostic] = []
    text = _decode(data, path, diagnostics)
    root = _document(text, path, diagnostics) if text is not None else None
    if diagnostics or root is None:
        raise SpecError(diagnostics, {path: text or ""})
    return root


# ---- files and includes ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _File:
    """A file and how names beside it are found: on disk, or by `inside` below the `root` of a library."""

    at: Traversable
    root: Traversable | None = None
    inside: str = ""

    @property
    def path(self) -> str:
        """The path that places name."""
        return str(self.at)

    @property
    def identity(self) -> str:
        """Equal for two ways to one file."""
        return os.path.realpath(self.at) if isinstance(self.at, Path) else str(self.at)

    def beside(self, name: str) -> _File | None:
        """The file of this name relative to this one; None where that would leave the library."""
        if self.root is None:
            return _File(Path(os.path.normpath(Path(self.path).parent / name)))
        return _in_library(self.root, posixpath.join(posixpath.dirname(self.inside), name))


def _in_library(root: Traversable, name: str) -> _File | None:
    inside = posixpath.normpath(name)
    if inside == ".." or inside.startswith("../"):
        return None
    if isinstance(root, Path):
        return _File(root / inside)
    return _File(root.joinpath(inside), root, inside)


class _Loader:
    """Follows the includes of a root file, depth first, each file once."""

    def __init__(self, library: Sequence[Traversable]) -> None:
        self.library = library
        self.diagnostics: list[Diagnostic] = []
        self.documents: list[Map] = []
        self.texts: dict[str, str] = {}
        self.files: list[Path] = []
        self._seen: set[str] = set()
        self._chain: list[tuple[_File, Place]] = []
        """The files that are open, each with the place of the include that led to it."""

    def load_root(self, path: Path) -> None:
        file = _File(path)
        self._load(file, Place(file.path, 0, 0))

    def _load(self, file: _File, place: Place) -> None:
        if file.identity in self._seen:
            return
        self._seen.add(file.identity)
        if isinstance(file.at, Path):
            self.files.append(file.at)
        data = self._read(file, place)
        text = None if data is None else _decode(data, file.path, self.diagnostics)
        if text is None:
            return
        self.texts[file.path] = text
        document = _document(text, file.path, self.diagnostics)
        if document is None:
            return
        self._chain.append((file, place))
        self._check_format(document)
        for name, where in self._includes(document):
            self._include(file, name, where)
        self._chain.pop()
        self.documents.append(document)

    def _read(self, file: _File, place: Place) -> bytes | None:
        """The content of a file, None after an error. `place` is the include that names it."""
        called = quoted(shown_path(file.path))
        data = b""
        try:
            if file.at.is_dir():
                reason = "is a folder, not a file"
            elif not file.at.is_file():
                reason = "is not a file" if _exists(file) else "does not exist"
            else:
                with file.at.open("rb") as stream:
                    data = stream.read(MAX_BYTES + 1)
                reason = ""
        except FileNotFoundError:
            reason = "does not exist"
        except OSError as error:
            reason = f"cannot be read: {(error.strerror or str(error)).lower()}"
        if reason:
            self._fail("E101", place, f"{called} {reason}")
            return None
        if len(data) > MAX_BYTES:
            self._fail("E102", place, f"{called} is larger than {MAX_BYTES // (1024 * 1024)} MB")
            return None
        return data

    def _fail(self, rule_id: str, place: Place, message: str, hint: str = "") -> None:
        """Reports an error about an include, with the chain that led to it."""
        chain = tuple((at, "included from here") for _, at in reversed(self._chain) if at.line)
        self.diagnostics.append(diagnose(rule_id, place, message, hint, notes=chain))

    def _check_format(self, document: Map) -> None:
        if "format" not in document:
            self.diagnostics.append(diagnose("E118", document.where, "the file does not say which format it has"))
        elif type(document["format"]) is not int or document["format"] != FORMAT:
            message = f"format {quoted(document['format'])} is unknown; this program reads format {FORMAT}"
            self.diagnostics.append(diagnose("E118", document.place("format"), message))

    def _includes(self, document: Map) -> Iterator[tuple[str, Place]]:
        """The include names of a document and their places; reports what is not a relative file name."""
        if "include" not in document:
            return
        names = document["include"]
        if not isinstance(names, Seq):
            self._fail("E119", document.place("include"), "`include` is not a list of file names")
            return
        for index, name in enumerate(names):
            place = names.place(index)
            if not isinstance(name, str) or not name.strip():
                self._fail("E119", place, "an include must be the name of a file")
            elif name.startswith("/") or "\\" in name or re.match(r"[A-Za-z]:", name) or not name.isprintable():
                self._fail(
                    "E119",
                    place,
                    f"{quoted(name)} is not a relative file name",
                    "write it relative to this file or to the spec library, with `/` between folders",
                )
            else:
                yield name, place

    def _include(self, file: _File, name: str, place: Place) -> None:
        looked: list[str] = []
        for candidate in [file.beside(name), *(_in_library(root, name) for root in self.library)]:
            if candidate is None:
                continue
            if _exists(candidate):
                self._follow(candidate, place)
                return
            looked.append(shown_path(candidate.path))
        where = listed(dict.fromkeys(looked), "and")
        self._fail("E120", place, f"include {quoted(name)} was not found", f"looked for {where}")

    def _follow(self, file: _File, place: Place) -> None:
        """Loads an include unless it is open already, which would never end."""
        open_files = [opened.identity for opened, _ in self._chain]
        if file.identity in open_files:
            cycle = [opened.path for opened, _ in self._chain[open_files.index(file.identity) :]]
            names = " > ".join(shown_path(path) for path in [*cycle, file.path])
            self._fail("E121", place, f"the include leads back to a file that is being read: {names}")
        elif len(self._chain) >= MAX_DEPTH:
            self._fail("E108", place, f"includes are nested deeper than {MAX_DEPTH} files")
        else:
            self._load(file, place)


def _exists(file: _File) -> bool:
    try:
        return file.at.exists() if isinstance(file.at, Path) else file.at.is_file() or file.at.is_dir()
    except OSError:
        return True  # it cannot be looked at, perhaps for lack of rights: reading it gives the reason


# ---- text -----------------------------------------------------------------------------------------------------------

# What YAML 1.1 forbids in a file (section 5.1): libyaml stops there with an offset that helps nobody.
_FORBIDDEN = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
_LEADING_TAB = re.compile(r" *\t")


def _decode(data: bytes, path: str, diagnostics: list[Diagnostic]) -> str | None:
    """The text of a file; None if it is none."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        diagnostics.append(diagnose("E103", Place(path, 1, 1), "the file is UTF-16, not UTF-8"))
        return None
    if data.startswith(b"\xef\xbb\xbf"):
        diagnostics.append(diagnose("E104", Place(path, 1, 1), "the file begins with a byte order mark", length=1))
        data = data[3:]
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        message = f"byte {error.start} (0x{data[error.start]:02X}) is not UTF-8"
        diagnostics.append(diagnose("E103", Place(path, line, 1), message))
        return None
    found = _FORBIDDEN.search(text)
    if found:
        place = _place_at(text, found.start(), path)
        code = ord(found.group())
        what = "a NUL byte" if code == 0 else f"the control character U+{code:04X}"
        diagnostics.append(diagnose("E103", place, f"the file contains {what}", length=1))
        return None
    return text


def _place_at(text: str, offset: int, path: str) -> Place:
    """The place of a character, with lines as libyaml counts them."""
    before = split_lines(text[:offset])
    return Place(path, len(before), len(before[-1]) + 1)


# ---- YAML -----------------------------------------------------------------------------------------------------------


def _document(text: str, path: str, diagnostics: list[Diagnostic]) -> Map | None:
    """The one mapping of a file's text; None after an error that leaves none."""
    tabs = list(_tab_errors(text, path))
    if tabs:
        diagnostics.extend(tabs)
        return None
    try:
        stream = _Builder(path, diagnostics).build(text)
    except _StopReading:
        return None
    except yaml.MarkedYAMLError as error:
        diagnostics.append(_syntax_error(error, text, path))
        return None
    root = stream[0] if stream else None
    if isinstance(root, Map):
        return root
    if root is None:
        diagnostics.append(diagnose("E105", Place(path, 0, 0), "the file is empty"))
    else:
        kind = "a list" if isinstance(root, Seq) else "text"
        diagnostics.append(diagnose("E117", stream.place(0), f"the file is {kind}, not a mapping of sections"))
    return None


def _tab_errors(text: str, path: str) -> Iterator[Diagnostic]:
    found = 0
    for number, line in enumerate(split_lines(text), 1) if "\t" in text else ():
        if tab := _LEADING_TAB.match(line):
            yield diagnose("E107", Place(path, number, tab.end()), "a tab in the indentation", length=1)
            found += 1
            if found == MAX_ERRORS:
                return


class _StopReading(Exception):  # noqa: N818 - not an error: what is wrong has been reported
    """Ends the reading of a file."""


class _Builder:
    """Builds the tree of one file from libyaml's events."""

    def __init__(self, path: str, diagnostics: list[Diagnostic]) -> None:
        self._path = path
        self._diagnostics = diagnostics
        self._allowed = MAX_ERRORS
        # Files repeat themselves: each plain scalar is judged once, and so is each plain key.
        self._scalars: dict[str, Scalar] = {"true": True, "false": False, "null": None, "~": None, "": None}
        self._keys: set[str] = set()

    def build(self, text: str) -> Seq:
        """The documents of the text: none or one. Raises _StopReading where going on makes no sense."""
        # One loop without a call per event: this is where the time of a build goes that its size decides.
        path, scalars, keys = self._path, self._scalars, self._keys
        next_event: Callable[[], Any] = CParser(text).get_event
        stream = Seq(path, 1, 1)
        stack: list[Map | Seq] = []
        node: Map | Seq = stream
        key: str | None = None  # the key of `node` that waits for its value
        key_line = key_column = 0
        while True:
            event = next_event()
            kind = type(event)
            if kind is yaml.MappingEndEvent or kind is yaml.SequenceEndEvent:
                node = stack.pop()
                continue
            mark = event.start_mark
            line, column = mark.line + 1, mark.column + 1
            value: Any
            if kind is yaml.ScalarEvent:
                value = event.value
                plain = event.implicit[0]
                if event.anchor is not None or event.tag is not None:
                    self._reject_anchor_and_tag(event, line, column)
                if key is None and isinstance(node, Map):
                    key, key_line, key_column = value, line, column
                    if plain and value not in keys:
                        self._check_key(value, line, column)
                    if value in node:
                        self._report_twice(value, node.key_place(value), line, column)
                    continue
                if plain:
                    value = scalars[value] if value in scalars else self._plain(value, line, column)
            elif kind is yaml.MappingStartEvent or kind is yaml.SequenceStartEvent:
                self._reject_anchor_and_tag(event, line, column)
                if key is None and isinstance(node, Map):
                    hint = "quote text that begins with { or ["
                    self._stop("E112", line, column, "a mapping or list cannot be a key", hint)
                if len(stack) >= MAX_DEPTH:
                    self._stop("E108", line, column, f"mappings and lists are nested deeper than {MAX_DEPTH}")
                value = Map(path, line, column) if kind is yaml.MappingStartEvent else Seq(path, line, column)
                stack.append(node)
            elif kind is yaml.AliasEvent:
                self._report("E114", line, column, f"{quoted('*' + event.anchor)} is an alias")
                value = None
                if key is None and isinstance(node, Map):
                    key, key_line, key_column = "*" + event.anchor, line, column
                    continue
            elif kind is yaml.StreamEndEvent:
                return stream
            else:
                if kind is yaml.DocumentStartEvent and stream:
                    self._stop("E109", line, column, "a second document begins here")
                continue
            if isinstance(node, Map):
                assert key is not None  # above, a node without a waiting key takes the value for the key
                node[key] = value
                node.marks[key] = (path, key_line, key_column, line, column)
                key = None
            else:
                node.append(value)
                node.marks.append((path, line, column))
            if kind is yaml.MappingStartEvent or kind is yaml.SequenceStartEvent:
                node = value

    def _check_key(self, key: str, line: int, column: int) -> None:
        """Complains about a plain key that is no text."""
        value = self._scalars[key] if key in self._scalars else self._plain(key, line, column)
        if key == "<<":
            self._report("E116", line, column, "`<<` is a merge key")
        elif not key:
            self._report("E112", line, column, "a key is empty", "write the key before the `:`")
        elif isinstance(value, str):
            self._keys.add(key)
        else:
            kind = "an integer" if type(value) is int else "no text"
            self._report("E112", line, column, f"the key {quoted(key)} is {kind}", _quote_key(key))

    def _plain(self, text: str, line: int, column: int) -> Scalar:
        """What an unquoted scalar means; complains about what different YAML readers read differently."""
        if text[0] in "+-.0123456789":
            if _INTEGER.match(text):
                number = int(text, 0) if len(text) <= _LONGEST_INTEGER else 1 << 64
                if -(1 << 63) <= number < 1 << 64:
                    self._scalars[text] = number
                    return number
                self._report("E111", line, column, f"the number {quoted(text)} does not fit into 64 bits")
                return text
            for pattern, rule_id, message, hint in _DOUBTFUL_NUMBERS:
                if pattern.match(text):
                    self._report(rule_id, line, column, f"{quoted(text)} {message}", hint + _quote_it(text))
                    return text
        elif text.lower() in _DOUBTFUL_WORDS:
            truth = _DOUBTFUL_WORDS[text.lower()]
            message = f"{quoted(text)} is {truth} to some YAML readers and text to others"
            self._report("E110", line, column, message, f"write {truth} if that is meant, or {_quote_it(text)}")
            return text
        self._scalars[text] = text
        return text

    def _reject_anchor_and_tag(self, event: Any, line: int, column: int) -> None:
        if event.anchor is not None:
            self._report("E114", line, column, f"{quoted('&' + event.anchor)} is an anchor")
        if event.tag is not None:
            self._report("E115", line, column, f"{quoted(event.tag)} is a tag")

    def _report_twice(self, key: str, first: Place, line: int, column: int) -> None:
        place = Place(self._path, line, column)
        notes = ((first, "first given here"),)
        self._add(diagnose("E113", place, f"the key {quoted(key)} is given twice", notes=notes))

    def _report(self, rule_id: str, line: int, column: int, message: str, hint: str = "") -> None:
        self._add(diagnose(rule_id, Place(self._path, line, column), message, hint))

    def _add(self, diagnostic: Diagnostic) -> None:
        self._diagnostics.append(diagnostic)
        self._allowed -= 1
        if not self._allowed:
            place = diagnostic.place
            self._stop("E122", place.line, place.column, f"more than {MAX_ERRORS - 1} errors in this file")

    def _stop(self, rule_id: str, line: int, column: int, message: str, hint: str = "") -> NoReturn:
        self._diagnostics.append(diagnose(rule_id, Place(self._path, line, column), message, hint))
        raise _StopReading


_INTEGER = re.compile(r"-?(?:0|[1-9][0-9]*|0x[0-9A-Fa-f]+)\Z")

_LONGEST_INTEGER = len(str(-(1 << 63)))  # 0x with 16 digits is shorter

_OTHERWISE = "is a number to some YAML readers and text to others"

_DOUBTFUL_NUMBERS = tuple(
    (re.compile(pattern + r"\Z"), rule_id, message, hint and f"{hint}, or ")
    for pattern, rule_id, message, hint in (
        (
            r"[-+]?[0-9][0-9_]*(?::[0-9_]+)+(?:\.[0-9_]*)?",
            "E110",
            "is a number to the base 60 to some YAML readers",
            "",
        ),
        (r"[-+]?0[0-9_]+", "E110", "is an octal number to some YAML readers", "drop the leading zeros"),
        (r"[-+]?0[oO][0-9_]+", "E110", "is an octal number to some YAML readers", "write it decimal or as 0x..."),
        (r"[-+]?0[bB][0-9_]+", "E110", "is a binary number to some YAML readers", "write it decimal or as 0x..."),
        (r"[-+]?0[xX][0-9A-Za-z_]*", "E111", "is not a hexadecimal number", "write 0x and hexadecimal digits"),
        (r"\+[0-9][0-9_]*", "E110", _OTHERWISE, "drop the plus sign"),
        (r"[-+]?[0-9][0-9_]*", "E110", _OTHERWISE, "drop the underscores"),
        (
            r"[-+]?(?:[0-9][0-9_]*(?:\.[0-9_]*)?|\.[0-9_]+)[eE][-+]?[0-9]+",
            "E110",
            "is a fraction to some YAML readers",
            "",
        ),
        (r"[-+]?\.(?:inf|Inf|INF|nan|NaN|NAN)", "E110", "is a fraction to some YAML readers", ""),
    )
)

_DOUBTFUL_WORDS = {
    **dict.fromkeys(("on", "yes", "y", "true"), "true"),
    **dict.fromkeys(("off", "no", "n", "false"), "false"),
    "null": "null",
}


def _quote_it(text: str) -> str:
    return f'quote it as text: "{text}"' if len(text) <= 40 else "quote it as text"


def _quote_key(key: str) -> str:
    return f'quote it: "{key}":' if len(key) <= 40 else "quote it"


# ---- YAML syntax errors ---------------------------------------------------------------------------------------------

# libyaml's complaint -> our sentence, the hint, and whether the beginning of the construct tells more than its end.
_SYNTAX = {
    "mapping values are not allowed in this context": (
        "a `:` is not allowed here",
        "quote text that contains `: `; the keys of one mapping begin in one column",
        False,
    ),
    "did not find expected key": (
        "a key of the mapping was expected here",
        "the keys of one mapping begin in one column; nothing may follow quoted text or a closing bracket",
        False,
    ),
    "did not find expected '-' indicator": (
        "an item of the list was expected here",
        "every item of one list begins with `- ` in one column",
        False,
    ),
    "could not find expected ':'": ("the key has no `:`", "write `key: value`", True),
    "found unexpected end of stream": ("the quoted text is not closed", "add the closing quotation mark", True),
    "found unexpected document indicator": ("the quoted text is not closed", "add the closing quotation mark", True),
    "did not find expected ',' or ']'": (
        "the list in brackets goes wrong here",
        "separate items with `, `, quote text with brackets or colons, close the list with `]`",
        False,
    ),
    "did not find expected ',' or '}'": (
        "the mapping in braces goes wrong here",
        "separate keys with `, `, quote text with braces or colons, close the mapping with `}`",
        False,
    ),
    "found unknown escape character": (
        "the backslash begins an unknown escape",
        "write the backslash twice, or use single quotes",
        False,
    ),
    "block sequence entries are not allowed in this context": (
        "a list cannot begin here",
        "begin the list on the line after its key",
        False,
    ),
    "did not find expected node content": ("a value was expected here", "quote text that begins with , ] or }", False),
    "did not find expected <document start>": ("text follows the end of the document", "delete the line `...`", False),
}


def _syntax_error(error: yaml.MarkedYAMLError, text: str, path: str) -> Diagnostic:
    """One clear sentence for a syntax error of libyaml, at the place that a user has to look at."""
    problem = error.problem or "unknown problem"
    mark, context = error.problem_mark, error.context_mark
    message, hint, at_context = _SYNTAX.get(problem, (f"YAML cannot read this: {problem}", "", False))
    at_end = mark is not None and not text[mark.index :].strip() if mark is not None else True
    begin = context if context is not None and (at_context or at_end) else mark
    if begin is None:
        return diagnose("E106", Place(path, 1, 1), message, hint)
    place = Place(path, begin.line + 1, begin.column + 1)
    if problem == "found character that cannot start any token":
        character = split_lines(text)[begin.line][begin.column : begin.column + 1]
        message, hint = f"text cannot begin with {quoted(character)}", "put the text into quotation marks"
    if at_end and problem.startswith("did not find expected ','"):
        message = f"the {'list' if ']' in problem else 'mapping'} that begins here is not closed"
    return diagnose("E106", place, message, hint, length=1)
