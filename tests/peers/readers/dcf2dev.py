"""dcf2dev of dcf-tools: the static C that it makes of the file.

That C has one fixed form, so patterns suffice to read it back.
"""

from __future__ import annotations

import re
from functools import cache
from re import Pattern

import dcf  # type: ignore[import-untyped]

from .commands import run
from .program import Rows, Tables, main

UNCONFIGURED = 255
"""The node-ID that the C is made for. Where a flag says so, the stack replaces it by its own."""

DEVICE = re.compile(r"^static co_dev_t peer = \{$(.*?)^\};$", re.MULTILINE | re.DOTALL)
OBJECT = re.compile(r"^static co_obj_t peer_([0-9A-F]{4}) = \{$(.*?)^\};$", re.MULTILINE | re.DOTALL)
ENTRY = re.compile(r"^static co_sub_t peer_([0-9A-F]{4})sub([0-9A-F]+) = \{$(.*?)^\};$", re.MULTILINE | re.DOTALL)
MEMBER = re.compile(r"^\t\.(\w+) = (.*?),?$", re.MULTILINE)
STRING = re.compile(r'CO_DEV_STRING\("(.*)"\)')
UNION = re.compile(r"\{ \.\w+ = (\S+) \}")
LIMIT = re.compile(r"CO_\w+_(MIN|MAX)")

KINDS = {"CO_OBJECT_VAR": 7, "CO_OBJECT_ARRAY": 8, "CO_OBJECT_RECORD": 9}
TYPES = {f"CO_DEFTYPE_{dcf.DataType(index).name()}": dcf.DataType(index) for index in (*range(1, 13), 15, 17, 21, 27)}


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    code, complaints = made_c(path)
    return {
        "device": {"": device(code)},
        "objects": {index: obj(members(text)) for index, text in OBJECT.findall(code)},
        "entries": entries(code, node_id),
    }, complaints


@cache
def made_c(path: str) -> tuple[str, list[str]]:
    """The C is the same for every node-ID."""
    return run("dcf2dev.cli", path, "peer")


def members(text: str) -> dict[str, str]:
    return dict(MEMBER.findall(text))


def device(code: str) -> dict[str, object]:
    (text,) = DEVICE.findall(code)
    found = members(text)
    return {
        "vendor_name": inner(STRING, found["vendor_name"]),
        "vendor_number": int(found["vendor_id"], 0),
        "product_name": inner(STRING, found["product_name"]),
        "product_number": int(found["product_code"], 0),
        "revision_number": int(found["revision"], 0),
        "order_code": inner(STRING, found["order_code"]),
        "bit_rates": [int(rate) for rate in re.findall(r"CO_BAUD_(\d+)", found["baud"])],
        "lss": found["lss"] == "1",
    }


def obj(found: dict[str, str]) -> dict[str, object]:
    return {"name": inner(STRING, found["name"]), "kind": KINDS[found["code"]]}


def entries(code: str, node_id: int) -> Rows:
    rows: Rows = {}
    for index, sub, text in ENTRY.findall(code):
        found = members(text)
        data_type = TYPES[found["type"]]
        relative = "CO_OBJ_FLAGS_DEF_NODEID" in found["flags"]
        value = number(found["def"], data_type)
        rows[f"{index}:{sub}"] = {
            "name": inner(STRING, found["name"]),
            "type": data_type.index,
            "access": found["access"].removeprefix("CO_ACCESS_").lower(),
            "value": value - UNCONFIGURED + node_id if relative and isinstance(value, int) else value,
            "relative": relative,
            "least": number(found["min"], data_type),
            "most": number(found["max"], data_type),
            "mappable": found["pdo_mapping"] == "1",
        }
    return rows


def inner(pattern: Pattern[str], text: str) -> str:
    match = pattern.fullmatch(text)
    assert match, text
    return match[1]


def number(text: str, data_type: dcf.DataType) -> int | str | None:
    """A member of the union: a number, an empty string, or a limit of the type (strings have none)."""
    value = inner(UNION, text)
    if value == "CO_ARRAY_C":
        return ""
    if limit := LIMIT.fullmatch(value):
        if not data_type.is_basic():
            return None
        return int(data_type.min() if limit[1] == "MIN" else data_type.max())
    return int(value, 0)


if __name__ == "__main__":
    main("dcf-tools", read)
