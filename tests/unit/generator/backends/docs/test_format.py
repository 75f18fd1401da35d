"""The manual of the format: all that the schema says, and the reader of specifications agrees."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.backends.docs import DocsBackend
from odsmith.backends.docs.format import Definition, flow, manual, read_schema
from odsmith.backends.docs.text import Rich
from odsmith.load import parse
from odsmith.vocabulary import Vocabulary

SCHEMA: dict[str, Any] = {
    "title": "A format",
    "description": "About `it`.",
    "required": ["format"],
    "properties": {
        "format": {"description": "Version.", "const": 1},
        "things": {
            "description": "Things by name.",
            "type": "object",
            "additionalProperties": {"$ref": "#/$defs/thing", "required": ["size"]},
            "examples": [{"one": {"size": 3}}],
        },
        "tree": {
            "description": "A tree.",
            "allOf": [{"$ref": "#/$defs/tree"}, {"$ref": "#/$defs/complete_tree"}],
        },
        "group": {"type": "object", "properties": {"inner": {"$ref": "#/$defs/thing", "description": "Inside."}}},
    },
    "$defs": {
        "thing": {
            "title": "Thing",
            "description": "A thing.",
            "type": "object",
            "properties": {
                "size": {"description": "Its size.", "type": "integer", "minimum": 1, "maximum": 9, "examples": [3]},
                "colour": {"description": "Its colour.", "enum": ["red", "on"]},
            },
        },
        "tree": {
            "title": "Tree",
            "description": "A tree.",
            "type": "object",
            "oneOf": [{"required": ["leaf"]}, {"required": ["needle"]}],
            "properties": {
                "leaf": {"type": "boolean"},
                "needle": {"type": ["integer", "string"]},
                "root": {"anyOf": [{"type": "null"}, {"type": "array", "items": {"$ref": "#/$defs/thing"}}]},
            },
        },
        "complete_tree": {"if": {}, "then": {"required": ["root"]}, "properties": {"leaf": {"description": "So."}}},
    },
}


def words(text: Rich) -> str:
    return "".join(piece.text for piece in text)


def by_name(definitions: tuple[Definition, ...]) -> dict[str, Definition]:
    return {item.id: item for item in definitions}


def test_sections_and_elements_are_those_of_the_schema() -> None:
    found = manual(SCHEMA)
    assert [item.title for item in found.sections] == ["format", "things", "tree", "group"]
    assert [item.title for item in found.elements] == ["Thing", "Tree"]
    sections = by_name(found.sections)
    assert words(sections["section-things"].kind) == "mapping of text to Thing"
    assert sections["section-things"].examples == ("things: {one: {size: 3}}",)
    assert [key.name for key in sections["section-group"].keys] == ["group.inner"]
    assert sections["section-format"].must == "yes"


def test_kinds_are_said_in_words() -> None:
    elements = by_name(manual(SCHEMA).elements)
    kinds = {key.name: words(key.kind) for item in elements.values() for key in item.keys}
    assert kinds == {
        "size": "integer, 1 to 9",
        "colour": 'red, "on"',
        "leaf": "true or false",
        "needle": "integer or text",
        "root": "null or list of Thing",
    }


def test_what_must_be_there_comes_from_all_that_constrains_an_element() -> None:
    elements = by_name(manual(SCHEMA).elements)
    must = {key.name: key.must for item in elements.values() for key in item.keys}
    assert must == {
        "size": "yes",
        "colour": "",
        "leaf": "one of these",
        "needle": "one of these",
        "root": "where it applies",
    }


def test_the_manual_names_every_key_of_the_real_schema(vocabulary: Vocabulary) -> None:
    text = next(o.content.decode() for o in DocsBackend().render(vocabulary) if o.path.endswith("/format.md"))
    schema = read_schema()
    for section in schema["properties"]:
        assert f"`{section}`" in text
    for name, definition in schema["$defs"].items():
        if {"type", "enum", "const", "anyOf"} & set(definition):
            assert f'<a id="type-{name}"></a>' in text
            for key, item in definition.get("properties", {}).items():
                assert f"| `{key}` |" in text or "properties" in item
    assert "`nmt.states`" in text


@pytest.mark.parametrize(
    ("element", "key", "must"),
    [
        ("object", "name", "yes"),
        ("object", "subs", "where it applies"),
        ("object", "unit", ""),
        ("sub", "name", "yes"),
        ("named_value", "text", "yes"),
        ("bit", "name", "yes"),
        ("bit", "supported", ""),
        ("led_pattern", "steady", "one of these"),
        ("step", "write", "one of these"),
        ("pdo", "map", "yes"),
        ("eds", "file", "yes"),
        ("axes", "count", "yes"),
        ("area", "stride", "yes"),
        ("emergency", "remedy", "yes"),
    ],
)
def test_the_manual_says_what_an_element_must_have(element: str, key: str, must: str) -> None:
    keys = by_name(manual(read_schema()).elements)[f"type-{element}"].keys
    assert next(item.must for item in keys if item.name == key) == must


TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("Cc", "Cf", "Zl", "Zp", "Cs")), max_size=12)
VALUES = st.recursive(
    TEXTS | st.integers(-(2**31), 2**31) | st.booleans(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.from_regex(r"[a-z0-9]{1,4}", fullmatch=True), inner),
    max_leaves=6,
)


@given(VALUES)
def test_an_example_is_read_back_as_it_was(value: Any) -> None:
    assert parse(f"key: {flow(value)}\n".encode(), "example").get("key") == value


@pytest.mark.parametrize(
    ("value", "spelled"),
    [
        ("4.2.6", "4.2.6"),
        ("3.22", '"3.22"'),
        ("on", '"on"'),
        ("0, 2..15", '"0, 2..15"'),
        ("0..63", "0..63"),
        ("$NODEID+0x80", "$NODEID+0x80"),
        ("2019-02-11", '"2019-02-11"'),
        ({"0": {"name": "a_b"}}, '{"0": {name: a_b}}'),
        (["16", 7, True, None], '["16", 7, true, null]'),
    ],
)
def test_flow(value: Any, spelled: str) -> None:
    assert flow(value) == spelled
