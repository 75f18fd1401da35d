"""What the EDS says, what C holds, what Python holds and what the reference prints is one dictionary, entry by entry.

Each place is read with a reader of its own: the EDS by python-canopen, the C tables by asking all their addresses and
the C header by its macros, the Python package through its objects, the reference from its Markdown. Each is then a
table of facts by address, and compared with that of the Python package. Where a place keeps a fact to itself, the rule
that lets it do so is in `RULES`, and read from the model.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import canopen
import pytest
from tests.cross.build import WARNINGS, Build, run
from tests.cross.oracle import Address

from odsmith.backends.c import CBackend
from odsmith.canopen_types import DataType
from odsmith.model import Device, Entry
from odsmith.render import write
from odsmith.vocabulary import Vocabulary
from odsmith_runtime.device import Tables
from odsmith_runtime.entries import Entry as PythonEntry

NODE_ID = 5
"""That of dump_od.c."""

Facts = dict[str, Any]
"""Of an entry, by kind: `name` and `eds_name` (object, entry), `title`, `type`, `length` (of text, in octets), `access`
(ro, rw, wo), `mapping` (no, rx, tx, both), `default` (None: not stated), `initial` (the value at power-on), `low`,
`high`, `allowed` (intervals; signatures are such of one value)."""

Dictionary = dict[Address, Facts]

LIMITS = {kind.value: (kind.low, kind.high) for kind in DataType if kind.integer}

RULES: dict[tuple[str, str], Callable[[Entry], bool]] = {
    # a default that would do harm if a tool wrote it back, and text, on whose spelling readers do not agree
    ("eds", "default"): lambda entry: bool(entry.hidden_default) or not entry.type.integer,
    # any value of the type, or a signature: nothing between two signatures is one
    ("eds", "low"): lambda entry: entry.allowed is None or bool(entry.signatures),
    ("eds", "high"): lambda entry: entry.allowed is None or bool(entry.signatures),
    ("c", "low"): lambda entry: entry.allowed is None or bool(entry.signatures),
    ("c", "high"): lambda entry: entry.allowed is None or bool(entry.signatures),
    # a value that never changes has no macro for its default, it stands in the table; those of PDOs differ
    ("c", "default"): lambda entry: (
        entry.constant or bool(entry.signatures and not entry.role) or entry.role.startswith("pdo_")
    ),
    # what cannot be written cannot be written wrongly
    ("c", "allowed"): lambda entry: not entry.access.writable,
    ("docs", "allowed"): lambda entry: not entry.access.writable and entry.allowed is None,
}
"""Where a place may be silent: `RULES[place, fact](entry of the model)`, None is what it then says."""

STATED = {
    "eds": {"eds_name", "type", "access", "mapping", "default", "low", "high"},
    "c": {"name", "type", "access", "mapping", "default", "initial", "low", "high", "allowed"},
    "docs": {"object_name", "eds_name_of_object", "title", "type", "length", "access", "mapping", "default", "allowed"},
}
"""The facts that each place states."""


# ---- Python ----------------------------------------------------------------------------------------------------------


def python_dictionary(tables: Tables) -> Dictionary:
    return {(entry.index, entry.sub): _of_python(entry) for obj in tables.dictionary.values() for entry in obj}


def _of_python(entry: PythonEntry[Any]) -> Facts:
    parent = entry.parent
    default = entry.default(NODE_ID)
    limits = LIMITS.get(entry.type, (None, None))
    return {
        "name": (parent.name, entry.name if entry.sub else ""),
        "object_name": parent.name,
        "eds_name": (parent.parameter_name, "" if parent.is_variable else entry.parameter_name),
        "eds_name_of_object": parent.parameter_name,
        "title": parent.title if parent.is_variable else entry.title,
        "type": entry.type,
        "length": entry.length,
        "access": "ro" if entry.access == "const" else entry.access,
        "mapping": entry.mapping,
        "default": default if isinstance(default, str | bytes | None) else int(default),
        "initial": _plain(entry.initial(NODE_ID), entry.length),
        "low": entry.low,
        "high": entry.high,
        "allowed": tuple((value, value) for _, value in entry.signatures) or entry.allowed or (limits,),
    }


def _plain(value: Any, length: int) -> int | bytes:
    if isinstance(value, str | bytes):
        return (value.encode() if isinstance(value, str) else value).ljust(length, b"\0")
    return int(value)


# ---- the EDS, as python-canopen reads it -----------------------------------------------------------------------------


def eds_dictionary(path: Path) -> Dictionary:
    found: Dictionary = {}
    for obj in canopen.import_od(str(path), NODE_ID).values():
        if isinstance(obj, canopen.objectdictionary.ODVariable):
            found[obj.index, 0] = _of_eds((obj.name, ""), obj)
        else:
            for entry in obj.values():
                found[entry.index, entry.subindex] = _of_eds((obj.name, entry.name), entry)
    return found


def _of_eds(name: tuple[str, str], entry: Any) -> Facts:
    kind = next(kind for kind in DataType if kind.code == entry.data_type)
    direction = {"rww": "rx", "rwr": "tx", "rw": "both", "ro": "tx", "const": "tx"}[entry.access_type]
    return {
        "eds_name": name,
        "type": kind.value,
        "access": {"rww": "rw", "rwr": "rw", "const": "ro"}.get(entry.access_type, entry.access_type),
        "mapping": direction if entry.pdo_mappable else "no",
        "default": entry.default,
        "low": entry.min,
        "high": entry.max,
    }


# ---- the C tables and the C header -----------------------------------------------------------------------------------


def c_dictionary(device: Device, printed: list[str], header: str) -> Dictionary:
    """`printed` is what dump_od.c says of all addresses."""
    macros = _of_header(device.identifier.upper(), header)
    base_index = {obj.index: obj.object.index for obj in device.expanded}
    found: Dictionary = {}
    for line in printed:
        address, kind, access, mapping, value, allowed, *_ = line.split(" ")
        index, sub = (int(part, 16) for part in address.split(":"))
        low, high = LIMITS.get(kind, (None, None))
        said = macros.get((base_index[index], sub), {})
        found[index, sub] = {
            "name": (macros[base_index[index], 0]["OBJ"], said.get("SUB", "")),
            "type": kind,
            "access": access,
            "mapping": mapping,
            "initial": bytes.fromhex(value[1:]) if value.startswith("x") else _signed(int(value), low),
            "default": said.get("DEFAULT"),
            "low": said.get("MIN"),
            "high": said.get("MAX"),
            "allowed": ((low, high),) if allowed == "any" else _intervals(allowed) if allowed != "-" else None,
        }
    return found


def _of_header(prefix: str, header: str) -> dict[Address, dict[str, Any]]:
    """By address on axis 0: the names in OBJ_ and SUB_ macros, in lower case, and the numbers of the others."""
    found: dict[Address, dict[str, Any]] = {}
    index, sub, name = 0, 0, ""
    kinds = "OBJ|SUB|MIN|MAX|DEFAULT"
    macro = re.compile(rf"#define {prefix}_({kinds})_(\w+) \(?(-?\w+?)[ul]*( - 1)?\)?(?: /\* (.*))?$", re.MULTILINE)
    macros = macro.findall(header)
    assert len(macros) == len(re.findall(rf"#define {prefix}_(?:{kinds})_", header))
    for kind, path, value, minus_one, comment in macros:
        number = int(value, 0) - bool(minus_one)
        if kind == "OBJ":
            index, sub, name = number, 0, path
        elif kind == "SUB":
            sub = number
        facts = found.setdefault((index, sub), {})
        facts[kind] = {"OBJ": path.lower(), "SUB": path.removeprefix(f"{name}_").lower()}.get(kind, number)
        if kind == "DEFAULT" and "node-ID" in comment:
            facts[kind] += NODE_ID
    return found


def _signed(value: int, low: int | None) -> int:
    """The value of a type whose least value is `low`, given without a sign."""
    return value + 2 * low if low and value >= -low else value


def _intervals(text: str) -> tuple[tuple[int, int], ...]:
    return tuple((int(low), int(high)) for low, high in (part.split("..") for part in text.split(",")))


# ---- the reference ---------------------------------------------------------------------------------------------------

_MAPPINGS = {"no": "no", "RPDO": "rx", "TPDO": "tx", "RPDO, TPDO": "both"}

_PDO_COLUMNS = {
    "COB-ID used by PDO": "COB-ID",
    "Transmission type": "Transmission type",
    "Inhibit time": "Inhibit time, 100 us",
    "Event timer": "Event timer, ms",
}


def docs_dictionary(device: Device, folder: Path) -> Dictionary:
    found: Dictionary = {}
    pdos = list(_pdo_rows((folder / "pdos.md").read_text()))
    for page in sorted(folder.glob("objects-*.md")):
        for section in re.split(r"^## ", page.read_text(), flags=re.MULTILINE)[1:]:
            for address, facts in _of_section(device, section):
                found[address] = facts
    for index, row in pdos:
        for (at, _), facts in found.items():
            if at == index and facts["default"] == "pdos.md":
                facts["default"] = _of_pdo(found, row, facts["title"])
    return found


def _of_section(device: Device, section: str) -> Iterator[tuple[Address, Facts]]:
    heading = section.partition("\n")[0].partition("</a>")[2].partition(" ")[2]
    tables = list(_tables(section))
    facts = {row[0]: row[1] for row in (tables[0][0], *tables[0][1])}
    rows = [dict(zip(table[0], row, strict=True)) for table in tables if table[0][0] == "Sub" for row in table[1]]
    if not rows:
        columns = ("Type", "Access", "Range", "Default")
        rows = [
            {"Sub": "00h", "Name": heading, "PDO": facts["PDO mapping"], **{key: facts.get(key, "") for key in columns}}
        ]
    names = re.findall("`(.*?)`", facts["EDS name"])
    for place, index in enumerate(_indices(facts["Index"])):
        number = str((index & 0x1FF) + 1)
        eds_name = (
            names[place]
            if len(names) > 1
            else re.sub(r"\bn\b", number, names[0])
            if "n being" in facts["EDS name"]
            else names[0]
        )
        for row in rows:
            kind, _, length = _text(row["Type"]).partition("(")
            title = row["Name"].replace(" n ", f" {number} ", 1) if "n being" in facts["EDS name"] else row["Name"]
            yield (
                (index, _number(row["Sub"])),
                {
                    "object_name": _text(facts["Name in code"]).strip("`"),
                    "eds_name_of_object": eds_name,
                    "title": _text(title),
                    "type": kind,
                    "length": int(length.removesuffix(")") or 0),
                    "access": row["Access"].partition(",")[0].replace("const", "ro"),
                    "mapping": _MAPPINGS[row["PDO"]],
                    "default": _default(row["Default"]),
                    "allowed": _allowed(device, kind, row["Range"]),
                },
            )


def _tables(text: str) -> Iterator[tuple[list[str], list[list[str]]]]:
    """Head and rows of the tables in a piece of Markdown."""
    for block in re.findall(r"(?:^\|.*\n)+", text, flags=re.MULTILINE):
        rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in block.splitlines()]
        yield rows[0], rows[2:]


def _indices(text: str) -> Iterator[int]:
    for first, last in re.findall(r"`([0-9A-F]{4})h(?:\.\.([0-9A-F]{4})h)?`", text):
        yield from range(int(first, 16), int(last or first, 16) + 1)


def _text(cell: str) -> str:
    return re.sub(r"\\(.)", r"\1", cell)


def _number(text: str) -> int:
    return int(text.removesuffix("h"), 16) if text.endswith("h") else int(text)


def _default(cell: str) -> int | str | None:
    text = _text(cell).split(" (")[0]
    if "pdos.md" in text:
        return "pdos.md"
    if text in ("", "none stated, starts as 0"):
        return None
    if text.startswith("`"):
        return text.strip("`")
    number, _, with_node_id = text.partition(" + ")
    return _number(number) + (NODE_ID if with_node_id == "node-ID" else 0)


def _allowed(device: Device, kind: str, cell: str) -> Any:
    text = re.sub(r" \(.*?\)", "", _text(cell))
    if not text:
        return None
    if text == "any value of the type" or text.endswith(" octets"):
        return (LIMITS.get(kind, (None, None)),)
    if text.startswith("`"):
        signatures = {signature.ascii: signature.value for signature in device.signatures.values()}
        return tuple((signatures[word], signatures[word]) for word in re.findall("`(.*?)`", text))
    intervals = []
    for part in text.split(", "):
        low, _, high = part.partition("..")
        intervals.append((_number(low), _number(high or low)))
    return tuple(intervals)


def _pdo_rows(text: str) -> Iterator[tuple[int, dict[str, str]]]:
    """The index of each parameter record of a PDO and the PDO's row."""
    for head, rows in _tables(text):
        for row in rows:
            cells = dict(zip(head, row, strict=True))
            for index in cells["Parameters"].split(", "):
                yield _number(index), cells


def _of_pdo(found: Dictionary, row: dict[str, str], title: str) -> int | str | None:
    if title in _PDO_COLUMNS:
        return _default(row[_PDO_COLUMNS[title]])
    carried = []
    for index, sub in re.findall(r"\[([0-9A-F]{4})h(?::([0-9A-F]{2}))? ", row["Carries"]):
        at = (int(index, 16), int(sub or "0", 16))
        carried.append(at[0] << 16 | at[1] << 8 | DataType(found[at]["type"]).bits)
    if title == "Number of mapped objects":
        return len(carried)
    position = int(title.removeprefix("Mapping entry ")) - 1
    return carried[position] if position < len(carried) else 0


# ---- all of them -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(scope="module")
def in_python(device: Device, python_tables: Callable[[Device], Tables]) -> Dictionary:
    return python_dictionary(python_tables(device))


@pytest.fixture(scope="module")
def in_c(
    device: Device, vocabulary: Vocabulary, root: Path, c_build: Build, tmp_path_factory: pytest.TempPathFactory
) -> Dictionary:
    folder = tmp_path_factory.mktemp("three_way")
    for model in (device, vocabulary):
        write(CBackend().render(model), folder)
    name, generated = device.identifier, folder / device.identifier / "c"
    tables = (generated / f"{name}_od.c", generated / f"{name}_device.c", root / "runtime_c" / "src" / "ods_od.c")
    run(
        [
            *(*c_build.command, "-std=c99", "-O1", *WARNINGS),
            *(f'-DDEVICE_HEADER="{name}_device.h"', f"-DDEVICE={name}_device", f"-DVALUES={name}_values_t"),
            *(f"-I{place}" for place in (root / "runtime_c" / "include", folder / "cia" / "c", generated)),
            *(str(root / "tests" / "unit" / "runtime_c" / "dump_od.c"), *map(str, tables), "-o", str(folder / "dump")),
        ]
    )
    return c_dictionary(device, run([str(folder / "dump")]).splitlines(), (generated / f"{name}_od.h").read_text())


def differences(device: Device, place: str, said: Dictionary, in_python: Dictionary) -> Iterator[str]:
    entries = {(item.index, item.entry.sub): item.entry for obj in device.expanded for item in obj.entries}
    assert list(said) == list(in_python) == list(entries)
    for at, facts in said.items():
        for fact in STATED[place]:
            rule = RULES.get((place, fact))
            silent = rule is not None and rule(entries[at])
            expected = None if silent else in_python[at][fact]
            if facts[fact] != expected:
                yield f"{at[0]:04X}:{at[1]:02X} {fact}: {place} says {facts[fact]!r}, it should be {expected!r}"


def test_eds(device: Device, root: Path, in_python: Dictionary) -> None:
    said = eds_dictionary(root / "generated" / device.identifier / "eds" / device.identity.eds.file)
    assert not list(differences(device, "eds", said, in_python))


@pytest.mark.slow
def test_c(device: Device, in_c: Dictionary, in_python: Dictionary) -> None:
    assert not list(differences(device, "c", in_c, in_python))


def test_reference(device: Device, root: Path, in_python: Dictionary) -> None:
    said = docs_dictionary(device, root / "generated" / device.identifier / "docs")
    assert not list(differences(device, "docs", dict(sorted(said.items())), in_python))
