"""The schema itself, and what is said about documents that it does not accept."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema_rs
import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.canopen_types import Access, DataType, ObjectType
from odsmith.errors import Diagnostic, SpecError
from odsmith.load import FORMAT, Loaded, Map, parse
from odsmith.validate import Schema, packaged_schema, schema_text, validate, validate_merged

SPEC = Path(__file__).parents[3] / "spec"

OBJECT = """
format: 1
objects:
  - index: 0x2005
    name: current
    title: Current
    type: UNSIGNED8
    access: ro
    text: The current.
    source: {section: 4.2.6}
"""


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return dict(json.loads(schema_text()))


def found(text: str) -> list[tuple[str, int, int, str, str]]:
    """Rule, line, column, message and hint of every error of a document."""
    with pytest.raises(SpecError) as caught:
        validate(loaded(text))
    return [(item.rule, item.place.line, item.place.column, item.message, item.hint) for item in errors(caught.value)]


def errors(error: SpecError) -> tuple[Diagnostic, ...]:
    return error.diagnostics


def loaded(text: str) -> Loaded:
    root = parse(text.encode(), "a.yaml")
    return Loaded(root, (root,), {"a.yaml": text}, ())


def changed(old: str, new: str) -> list[tuple[str, int, int, str, str]]:
    """The errors of the object above after a replacement."""
    assert old in OBJECT
    return found(OBJECT.replace(old, new))


# ---- the schema -----------------------------------------------------------------------------------------------------


def described(part: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every property and every definition of a schema."""
    if isinstance(part, dict):
        for group in ("properties", "$defs"):
            if isinstance(part.get(group), dict):
                yield from ((f"{path}/{group}/{name}", item) for name, item in part[group].items())
        for key, item in part.items():
            if key not in ("examples", "enum"):
                yield from described(item, f"{path}/{key}")
    elif isinstance(part, list):
        for index, item in enumerate(part):
            yield from described(item, f"{path}/{index}")


def test_the_schema_fits_its_own_schema(schema: dict[str, Any]) -> None:
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    jsonschema_rs.meta.validate(schema)
    assert schema["properties"]["format"]["const"] == FORMAT


def test_every_property_and_definition_is_described(schema: dict[str, Any]) -> None:
    parts = list(described(schema))
    assert len(parts) > 300
    for path, part in parts:
        description = part.get("description", "") if isinstance(part, dict) else ""
        assert description.strip(), path
        assert description.rstrip().endswith("."), path


def test_no_object_takes_unknown_keys(schema: dict[str, Any]) -> None:
    for path, part in described(schema):
        if isinstance(part, dict) and part.get("type") == "object" and "properties" in part:
            assert part["additionalProperties"] is False, path
    assert schema["additionalProperties"] is False


def test_every_reference_leads_somewhere_and_every_definition_is_used(schema: dict[str, Any]) -> None:
    used = {part.removeprefix("#/$defs/") for part in references(schema)}
    assert used | {"whole"} == set(schema["$defs"])


def references(part: Any) -> Iterator[str]:
    if isinstance(part, dict):
        if "$ref" in part:
            yield part["$ref"]
        for item in part.values():
            yield from references(item)
    elif isinstance(part, list):
        for item in part:
            yield from references(item)


def test_every_pattern_says_what_it_means(schema: dict[str, Any]) -> None:
    for path, part in described(schema):
        if isinstance(part, dict) and "pattern" in part:
            assert part["patternErrorMessage"], path


def test_examples_are_valid(schema: dict[str, Any]) -> None:
    for path, part in described(schema):
        for example in part.get("examples", ()) if isinstance(part, dict) else ():
            alone = {**part, "$defs": schema["$defs"]}
            assert jsonschema_rs.validator_for(alone).is_valid(example), (path, example)


def test_words_are_those_of_the_model(schema: dict[str, Any]) -> None:
    definitions = schema["$defs"]
    assert definitions["data_type"]["enum"] == [item.value for item in DataType]
    assert definitions["access"]["enum"] == [item.value for item in Access]
    assert definitions["object"]["properties"]["object_type"]["enum"] == [item.value for item in ObjectType]


def test_change_and_remove_know_every_section(schema: dict[str, Any]) -> None:
    sections = set(schema["properties"]) - {"format", "include", "change", "remove"}
    assert set(schema["$defs"]["change"]["properties"]) == sections
    assert set(schema["$defs"]["remove"]["properties"]) == sections - {"device", "vocabulary", "axes"}


def test_objects_and_their_sub_indices_have_the_same_facts(schema: dict[str, Any]) -> None:
    in_object, in_sub = (set(schema["$defs"][name]["properties"]) for name in ("object", "sub"))
    assert in_object - in_sub == {"index", "object_type", "pdo", "subs"}
    assert in_sub - in_object == {"repeat"}


def test_the_spec_library_fits(schema: dict[str, Any]) -> None:
    compiled = Schema(schema)
    files = sorted(SPEC.rglob("*.yaml"))
    assert files
    for path in files:
        assert compiled.errors(parse(path.read_bytes(), str(path))) == []
        depth = "../" * (len(path.relative_to(SPEC).parts) - 1)
        first = path.read_text("utf-8").split("\n", 1)[0]
        assert first == f"# yaml-language-server: $schema={depth}schema.json", path


def test_the_schema_is_compiled_once() -> None:
    assert packaged_schema() is packaged_schema()


# ---- what is said ---------------------------------------------------------------------------------------------------


def test_a_good_document_passes() -> None:
    validate(loaded(OBJECT))


def test_unknown_key() -> None:
    assert changed("access: ro", "acess: ro") == [
        ("E202", 4, 5, "`access` is missing in `objects.current`", ""),
        ("E201", 8, 5, "unknown key `acess` in `objects.current`", "did you mean `access`?"),
    ]
    assert found("format: 1\nobject: []") == [
        ("E201", 2, 1, "unknown key `object` in the file", "did you mean `objects`?")
    ]
    assert found("format: 1\nremove: {nmt: {zzz: []}}")[0][3:] == (
        "unknown key `zzz` in `remove.nmt`",
        "known here: `states` and `commands`",
    )


def test_a_comma_in_braces() -> None:
    text = "format: 1\nsignatures:\n  save: {value: 1, text: saves all, or a part}\n"
    assert found(text) == [
        (
            "E201",
            3,
            37,
            "unknown key `or a part` in `signatures.save`",
            "text that contains `, ` in braces needs quotes",
        )
    ]


def test_missing_keys_are_said_together() -> None:
    text = "format: 1\nobjects:\n  - name: x\n    title: X\n  - {index: 0x2000}\n"
    assert found(text) == [
        ("E202", 3, 5, "`index`, `text`, `source`, `type` and `access` are missing in `objects.x`", ""),
        ("E202", 5, 5, "`name`, `title`, `text`, `source`, `type` and `access` are missing in `objects.0x2000`", ""),
    ]
    assert found("format: 1\nreactions:\n  none: {}\n") == [("E202", 3, 3, "`text` is missing in `reactions.none`", "")]


def test_arrays_and_records_need_sub_indices() -> None:
    assert changed("type: UNSIGNED8", "object_type: RECORD")[0][3] == "`subs` is missing in `objects.current`"
    assert changed("type: UNSIGNED8", "object_type: ARRAY")[0][3] == (
        "`subs` and `type` are missing in `objects.current`"
    )


@pytest.mark.parametrize(
    ("old", "new", "message", "hint"),
    [
        ("title: Current", "title: 12", "`title` must be text, not `12`", "put it in quotes if it is text"),
        ("title: Current", "title: true", "`title` must be text, not `true`", "put it in quotes if it is text"),
        ("title: Current", "title: [a]", "`title` must be text, not a list", ""),
        ("index: 0x2005", "index: {a: 1}", "`index` must be an integer or text, not a mapping", ""),
        ("access: ro", "access: [ro]", "`access` must be a word, not a list", "allowed: `ro`, `rw`, `wo` and `const`"),
        ("section: 4.2.6", "section: [4]", "`section` must be text, not a list", ""),
        ("section: 4.2.6", "section: 4, tables: 66", "`tables` must be a list, not `66`", "write it as a list: [66]"),
        (
            "access: ro",
            "access: ro\n    length: 1.5",
            "`length` must be an integer, not the text `1.5`",
            "there are no fractions in this format",
        ),
        (
            "access: ro",
            "access: ro\n    length: '8'",
            "`length` must be an integer, not the text `8`",
            "without quotes: 8",
        ),
        (
            "access: ro",
            "access: ro\n    length: 1Fh",
            "`length` must be an integer, not the text `1Fh`",
            "hexadecimal numbers begin with 0x: 0x1F",
        ),
        (
            "access: ro",
            "access: ro\n    refuse_write_on_scan: 1",
            "`refuse_write_on_scan` must be true or false, not `1`",
            "",
        ),
    ],
)
def test_wrong_types(old: str, new: str, message: str, hint: str) -> None:
    assert [(item[0], item[3], item[4]) for item in changed(old, new)] == [("E203", message, hint)]


def test_no_value() -> None:
    assert [item[:4] for item in changed("title: Current", "title:")] == [("E203", 6, 5, "`title` has no value")]
    assert [item[:4] for item in changed("access: ro", "access: ~")] == [("E203", 8, 5, "`access` has no value")]
    assert [item[:4] for item in found("format: 1\nobjects:\n")] == [("E203", 2, 1, "`objects` has no value")]


def test_words() -> None:
    assert changed("access: ro", "access: rwx") == [("E204", 8, 13, "`access` cannot be `rwx`", "did you mean `rw`?")]
    assert changed("type: UNSIGNED8", "type: uint")[0][3:] == (
        "`type` cannot be `uint`",
        "allowed: `BOOLEAN`, `INTEGER8`, `INTEGER16`, `INTEGER32`, `INTEGER64`, `UNSIGNED8`, `UNSIGNED16`, "
        "`UNSIGNED32`, `UNSIGNED64`, `REAL32`, `REAL64`, `VISIBLE_STRING`, `OCTET_STRING` and `DOMAIN`",
    )


def test_patterns() -> None:
    assert changed("name: current", "name: Current") == [
        (
            "E205",
            5,
            11,
            "`name` is `Current`: a name is lower-case letters, digits and _, and begins with a letter",
            "for example `switch_parameters`",
        )
    ]
    assert changed("title: Current", 'title: "Größe"')[0][3] == (
        "`title` is `Größe`: a title is printable ASCII on one line, without blanks at its ends"
    )
    assert changed("access: ro", "access: ro\n    range: 0-5")[0][4] == "for example `0..63`, `0, 2..15` or `-128..127`"


def test_bounds() -> None:
    assert changed("0x2005", "0x12005")[0][3] == "`index` is 73733 (0x12005); it must be at most 65535 (0xFFFF)"
    assert changed("0x2005", "5")[0][3] == "`index` is 5; it must be at least 4096 (0x1000)"
    assert (
        changed("section: 4.2.6", "section: 4, tables: [0]")[0][3] == "an item of `tables` is 0; it must be at least 1"
    )


def test_amounts() -> None:
    text = "format: 1\nchange: {emergencies: {x: {bytes: [%s]}}}"
    assert found(text % "0, axis, 0")[0][3] == "`bytes` has 3 items, not at least 5"
    assert found(text % "0, axis, 0, 0, 0, 0")[0][3] == "`bytes` has 6 items, not at most 5"
    assert changed("name: current", f"name: {'c' * 70}")[0][3] == "`name` has 70 characters, not at most 60"
    assert changed("text: The current.", "text: ''")[0][3] == "`text` is empty"
    assert changed("source: {section: 4.2.6}", "source: {}")[0][3] == "`source` is empty"


def test_repetition_names_both() -> None:
    (item,) = errors_of("format: 1\ninclude: [a, b, a]\n")
    assert (item.rule, item.message) == ("E207", "`include` lists `a` twice")
    assert (item.place.column, item.notes[0][0].column) == (17, 11)


def errors_of(text: str) -> list[Diagnostic]:
    return packaged_schema().errors(parse(text.encode(), "a.yaml"))


def test_a_key_that_needs_another() -> None:
    assert changed("section: 4.2.6", "tables: [66]")[0][3] == "`tables` says nothing without `section`"


def test_keys_that_exclude_each_other() -> None:
    text = "format: 1\nchange: {modes: {pp: {recipes: {move: {steps: [%s]}}}}}"
    assert found(text % "{wait: 1, command: shutdown}") == [
        ("E208", 2, 58, "`wait` and `command` exclude each other in `change.modes.pp.recipes.move.steps.0`", "")
    ]
    assert found(text % "{text: only}")[0][3] == (
        "one of `write`, `command`, `expect`, `input` or `wait` is missing in `change.modes.pp.recipes.move.steps.0`"
    )
    assert [item[3] for item in found(text % "5")] == ["an item of `steps` must be a mapping, not `5`"]


def test_keys_of_mappings() -> None:
    assert found("format: 1\neffects: {A: {text: x}}") == [
        (
            "E209",
            2,
            11,
            "bad key `A` in `effects`: a name is lower-case letters, digits and _, and begins with a letter",
            "for example `switch_parameters`",
        )
    ]
    assert changed("access: ro", 'access: ro\n    values: {"1 ": {name: a, text: b}}')[0][3] == (
        'bad key `1 ` in `objects.current.values`: the key must be an integer in quotes, such as "0"'
    )
    assert found(f"format: 1\neffects: {{{'a' * 70}: {{text: x}}}}")[0][3].endswith("in `effects`: the key is too long")


def test_keys_that_are_numbers_keep_their_place() -> None:
    bad = changed(
        "access: ro", 'access: ro\n    bits: {"0": {name: a, text: b}, "16..23": {name: B, text: c}, "1": {}}'
    )
    assert [(item[0], item[1], item[2]) for item in bad] == [("E205", 9, 54), ("E202", 9, 67)]
    assert bad[1][3] == "`name` and `text` are missing in `objects.current.bits.1`"
    assert changed("access: ro", 'access: ro\n    bits: {"01": {name: a, text: b, c: d}}')[0][:3] == ("E209", 9, 12)


def test_alternatives_are_told_by_the_one_that_was_meant() -> None:
    assert changed("source: {section: 4.2.6}", "source: {sektion: 1}")[0][3:] == (
        "unknown key `sektion` in `objects.current.source`",
        "did you mean `section`?",
    )
    assert changed("source: {section: 4.2.6}", "source: [{section: [1]}]")[0][3] == "`section` must be text, not a list"
    assert changed("source: {section: 4.2.6}", "source: manual")[0][3] == (
        "`source` must be a mapping or a list, not the text `manual`"
    )
    assert changed("access: ro", "access: ro\n    values: mode")[0][3:] == (
        "`values` cannot be `mode`",
        "did you mean `modes`?",
    )
    assert changed("access: ro", "access: ro\n    values: [1]")[0][3] == (
        "`values` must be a mapping or `modes` or `homing_methods`, not a list"
    )
    text = "format: 1\nchange: {emergencies: {x: {bytes: [0, %s, 0, 0, 0]}}}"
    assert found(text % "axes")[0][3:] == ("an item of `bytes` cannot be `axes`", "did you mean `axis`?")
    assert found(text % "256")[0][3] == "an item of `bytes` is 256 (0x100); it must be at most 255"


def test_change_takes_parts_and_deletions_but_no_nonsense() -> None:
    validate(
        loaded("format: 1\nchange: {objects: {x: {title: Z}}, units: {u: null}, device: {eds: {comments: null}}}\n")
    )
    assert found("format: 1\nchange: {objects: {x: {titel: Z}}}")[0][3:] == (
        "unknown key `titel` in `change.objects.x`",
        "did you mean `title`?",
    )
    assert found("format: 1\nchange: {objects: {x: 5}}")[0][3] == "`x` must be a mapping, not `5`"
    assert found("format: 1\nchange: {object: {}}")[0][4] == "did you mean `objects`?"


def test_errors_of_several_documents_come_sorted() -> None:
    first, second = parse(b"format: 1\nx: 1\nz: 2\n", "b.yaml"), parse(b"format: 1\nz: 1\n", "a.yaml")
    with pytest.raises(SpecError) as caught:
        validate(Loaded(first, (first, second), {}, ()))
    assert [(item.place.path, item.place.line) for item in caught.value.diagnostics] == [
        ("a.yaml", 2),
        ("b.yaml", 2),
        ("b.yaml", 3),
    ]


def test_many_errors_are_cut() -> None:
    assert len(errors_of("format: 1\n" + "".join(f"k{i}: 1\n" for i in range(5000)))) == 100


def test_a_merged_document_must_be_whole() -> None:
    merged = parse(b"format: 1\naxes: {areas: {}}\n", "a.yaml")
    with pytest.raises(SpecError) as caught:
        validate_merged(merged, {})
    (item,) = caught.value.diagnostics
    assert (item.place.line, item.message) == (2, "`count` is missing in `axes`")


def test_the_schema_may_be_another() -> None:
    strict = Schema({"type": "object", "maxProperties": 0, "$defs": {"whole": {}}})
    (item,) = strict.errors(parse(b"a: 1\n", "a.yaml"))
    assert (item.rule, item.place.line) == ("E208", 1)
    with pytest.raises(SpecError):
        validate(loaded("format: 1\n"), strict)


# ---- anything at all ------------------------------------------------------------------------------------------------

WORDS = st.sampled_from(
    [
        "a",
        "1",
        "0",
        "01",
        "16..23",
        "name",
        "index",
        "text",
        "source",
        "subs",
        "bits",
        "values",
        "section",
        "steps",
        "map",
    ]
)
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 70000) | WORDS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(WORDS, inner, max_size=4),
    max_leaves=12,
)


def places(part: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    if path:
        yield path
    items = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    for key, item in items:
        yield from places(item, (*path, key))


def plain(part: Any) -> Any:
    if isinstance(part, dict):
        return {key: plain(item) for key, item in part.items()}
    return [plain(item) for item in part] if isinstance(part, list) else part


def library() -> list[Any]:
    return [plain(parse(path.read_bytes(), str(path))) for path in sorted(SPEC.rglob("*.yaml"))]


LIBRARY = library()


@given(st.data())
def test_any_mistake_is_explained(data: st.DataObject) -> None:
    """Somewhere in a file of the library something else is written: there is an error with a place, or none at all."""
    document = json.loads(json.dumps(data.draw(st.sampled_from(LIBRARY))))
    path = data.draw(st.sampled_from(list(places(document))))
    owner = document
    for step in path[:-1]:
        owner = owner[step]
    if isinstance(owner, dict) and data.draw(st.booleans()):
        owner[data.draw(WORDS)] = data.draw(VALUES)
    else:
        owner[path[-1]] = data.draw(VALUES)
    tree = parse(json.dumps(document).encode(), "a.yaml")
    assert isinstance(tree, Map)
    for item in packaged_schema().errors(tree):
        assert item.place.line == 1
        assert item.message
        assert "given schemas" not in item.message
        assert "any of the schemas" not in item.message
