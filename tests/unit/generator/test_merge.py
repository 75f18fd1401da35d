"""Many documents become one: definitions, changes, removals, and the places of everything."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.errors import Diagnostic, SpecError
from odsmith.load import Loaded, Map, Seq, load, parse
from odsmith.merge import merge
from odsmith.validate import validate

SPEC = Path(__file__).parents[3] / "spec"

CURRENT = """
  - index: 0x2000
    name: current
    title: Current
    type: UNSIGNED8
    access: ro
    text: The current.
    source: {section: 1}
"""
SPEED = CURRENT.replace("0x2000", "0x2001").replace("current", "speed")
FAULT = """
  - name: fault
    code: 0x1000
    title: Fault
    bytes: [0, 0, 0, 0, 0]
    register: [generic]
    condition: hot
    reaction: none
    cause: Heat.
    remedy: Wait.
    source: {section: 1}
"""
PDS = """pds:
  events: {fault: {text: A fault.}}
  transitions:
    - {number: 15, to: a, by: b, text: First., source: {section: 1}}
    - {number: 16, from: [a, b], to: c, by: d, text: Second., source: {section: 1}}
"""


def of(*texts: str) -> Loaded:
    """Documents 0.yaml, 1.yaml ... in the order of merging; `format: 1` is added on their first line."""
    named = {f"{number}.yaml": f"format: 1\n{text}" for number, text in enumerate(texts)}
    documents = tuple(parse(text.encode(), path) for path, text in named.items())
    return Loaded(documents[-1], documents, named, ())


def merged(*texts: str) -> Map:
    loaded = of(*texts)
    validate(loaded)
    before = copy.deepcopy([json.dumps(document) for document in loaded.documents])
    result = merge(loaded)
    assert [json.dumps(document) for document in loaded.documents] == before, "the documents were changed"
    return result


def problems(*texts: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(SpecError) as caught:
        merged(*texts)
    assert caught.value.texts
    return caught.value.diagnostics


def told(*texts: str) -> list[tuple[str, str, int, int, str]]:
    return [(item.rule, item.place.path, item.place.line, item.place.column, item.message) for item in problems(*texts)]


def at(node: Any, *path: str | int) -> Any:
    for step in path:
        node = node[step]
    return node


def words(node: Any, *path: str | int) -> list[str]:
    """The names of the elements of a list section."""
    return [item["name"] for item in at(node, *path)]


# ---- definitions ----------------------------------------------------------------------------------------------------


def test_sections_of_all_files_come_together_in_order() -> None:
    result = merged(
        "include: [x]\neffects: {a: {text: A}}\nobjects:" + CURRENT,
        "effects: {b: {text: B}}\nobjects:" + SPEED + "emergencies:" + FAULT,
    )
    assert list(result) == ["format", "effects", "objects", "emergencies"]
    assert list(at(result, "effects")) == ["a", "b"]
    assert words(result, "objects") == ["current", "speed"]
    assert isinstance(result["objects"], Seq)
    assert result["format"] == 1


def test_nested_sections_come_together() -> None:
    area = "{first: 0x2000, last: 0x2fff, stride: 0x200}"
    result = merged(
        f"axes: {{count: 2, areas: {{m: {area}}}, device_wide: [{{first: 0x1000, last: 0x1fff}}]}}\n"
        "pdos: {max_entries: 3, rpdo: {'1': {cob_id: 1, transmission_type: 1, map: [], source: {section: 1}}}}\n" + PDS,
        f"axes: {{areas: {{p: {area}}}, device_wide: [{{first: 0x3000, last: 0x3fff}}]}}\n"
        "pdos: {rpdo: {'2': {cob_id: 1, transmission_type: 1, map: [], source: {section: 1}}}}\n"
        "pds: {events: {done: {text: Done.}}}\n",
    )
    assert list(at(result, "axes", "areas")) == ["m", "p"]
    assert [item["first"] for item in at(result, "axes", "device_wide")] == [0x1000, 0x3000]
    assert list(at(result, "pdos", "rpdo")) == ["1", "2"]
    assert list(at(result, "pds", "events")) == ["fault", "done"]
    assert [item["number"] for item in at(result, "pds", "transitions")] == [15, 16]


def test_everything_keeps_its_place() -> None:
    result = merged("objects:" + CURRENT, "objects:" + SPEED + "effects: {a: {text: A}}\n")
    objects = at(result, "objects")
    assert (objects.place(0).path, objects.place(0).line) == ("0.yaml", 3)
    assert (objects.place(1).path, objects.place(1).line) == ("1.yaml", 3)
    assert objects[1].place("name") == objects[1].where.__class__("1.yaml", 4, 11)
    assert result.key_place("objects").path == "0.yaml"
    assert result.key_place("effects").path == result.where.path == "1.yaml"


def test_merging_twice_gives_the_same() -> None:
    loaded = of("objects:" + CURRENT, "change: {objects: {current: {title: Amperes}}}\n")
    assert json.dumps(merge(loaded)) == json.dumps(merge(loaded))


@pytest.mark.parametrize(
    ("first", "second", "line", "name"),
    [
        ("effects: {a: {text: A}}\n", "effects: {a: {text: B}}\n", 2, "effects.a"),
        ("bases: {a: 0x2000}\n", "bases: {a: 0x2000}\n", 2, "bases.a"),
        ("axes: {count: 1, areas: {}}\n", "axes: {count: 1}\n", 2, "axes.count"),
        ("pdos: {max_entries: 1}\n", "pdos: {max_entries: 1}\n", 2, "pdos.max_entries"),
        (
            "vocabulary: {identifier: a, title: A}\n",
            "vocabulary: {identifier: b, title: B}\n",
            2,
            "vocabulary",
        ),
        ("emergencies:" + FAULT, "emergencies:" + FAULT, 3, "emergencies.fault"),
        (PDS, "pds: {events: {fault: {text: A fault.}}}\n", 2, "pds.events.fault"),
        (
            PDS,
            "pds: {transitions: [{number: 16, to: c, by: d, text: Second., source: {section: 1}}]}\n",
            2,
            "pds.transitions.16",
        ),
    ],
)
def test_what_is_defined_twice_names_both_places(first: str, second: str, line: int, name: str) -> None:
    (found,) = problems(first, second)
    assert (found.rule, found.place.path, found.place.line) == ("E210", "1.yaml", line)
    assert found.message == f"`{name}` is defined twice"
    assert [(place.path, text) for place, text in found.notes] == [("0.yaml", "first defined here")]
    assert "`change:`" in found.hint


def test_defined_twice_in_one_file() -> None:
    found = problems("objects:" + CURRENT + CURRENT.replace("0x2000", "0x2001"))
    assert [(item.place.line, item.notes[0][0].line) for item in found] == [(12, 4)]


def test_an_index_defined_twice() -> None:
    (found,) = problems("objects:" + CURRENT, "objects:" + CURRENT.replace("name: current", "name: amperes"))
    assert found.message == "index `0x2000` is defined twice, as `current` and `amperes`"
    assert (found.place.path, found.place.column, found.notes[0][0].path) == ("1.yaml", 12, "0.yaml")
    by_base = CURRENT.replace("0x2000", "block+0x01")
    (found,) = problems("objects:" + by_base + by_base.replace("name: current", "name: amperes"))
    assert found.message.startswith("index `block+0x01` is defined twice")


# ---- changes --------------------------------------------------------------------------------------------------------


def test_a_change_reaches_any_depth_and_keeps_the_rest() -> None:
    bits = '    bits: {"0": {name: a, text: A}, "1": {name: b, text: B}}\n'
    result = merged(
        "objects:" + CURRENT + bits,
        "change:\n  objects:\n    current: {title: Amperes, unit: milliampere,"
        ' bits: {"1": {text: C}}, source: {cia301: "7"}}\n',
    )
    current = at(result, "objects", 0)
    assert (current["title"], current["text"], current["unit"]) == ("Amperes", "The current.", "milliampere")
    assert current["bits"] == {"0": {"name": "a", "text": "A"}, "1": {"name": "b", "text": "C"}}
    assert current["source"] == {"section": 1, "cia301": "7"}
    assert current.place("title").path == current["bits"]["1"].place("text").path == "1.yaml"
    assert current.place("text").path == current.where.path == "0.yaml"


def test_elements_of_lists_are_changed_by_their_identity() -> None:
    result = merged(
        PDS + "emergencies:" + FAULT,
        'change: {emergencies: {fault: {code: 2}}, pds: {transitions: {"16": {to: zz, from: [q]}}}}\n',
    )
    assert at(result, "emergencies", 0, "code") == 2
    transition = at(result, "pds", "transitions", 1)
    assert (transition["to"], transition["from"], transition["by"]) == ("zz", ["q"], "d")


def test_lists_are_replaced() -> None:
    result = merged(
        "axes: {count: 1, areas: {}, device_wide: [{first: 0x1000, last: 0x1fff}]}\n",
        "change: {axes: {count: 2, device_wide: [{first: 0x2000, last: 0x2fff}]}}\n",
    )
    assert result["axes"] == {"count": 2, "areas": {}, "device_wide": [{"first": 0x2000, "last": 0x2FFF}]}


def test_null_deletes() -> None:
    result = merged(
        "bases: {a: 0x2000, b: 0x2001}\nobjects:" + CURRENT + "    unit: second\n" + SPEED,
        "change: {objects: {current: {unit: null}, speed: ~}, bases: {a: null}}\n",
    )
    assert words(result, "objects") == ["current"]
    assert "unit" not in at(result, "objects", 0)
    assert result["bases"] == {"b": 0x2001}


def test_a_word_may_become_a_mapping() -> None:
    result = merged(
        "objects:" + CURRENT + "    values: modes\n",
        'change: {objects: {current: {values: {"1": {name: a, text: A}}}}}\n',
    )
    assert at(result, "objects", 0, "values") == {"1": {"name": "a", "text": "A"}}


def test_later_files_change_what_earlier_ones_changed() -> None:
    change = "change: {objects: {current: {title: %s}}}\n"
    result = merged("objects:" + CURRENT, change % "Second", change % "Third")
    assert at(result, "objects", 0, "title") == "Third"
    assert at(result, "objects", 0).place("title").path == "2.yaml"


def test_a_change_of_nothing() -> None:
    assert told("objects:" + CURRENT, "change: {objects: {curent: {title: X}}}\n") == [
        ("E211", "1.yaml", 2, 20, "there is no `objects.curent` to change")
    ]
    assert problems("objects:" + CURRENT, "change: {objects: {curent: {title: X}}}\n")[0].hint == (
        "did you mean `current`?"
    )
    assert told("objects:" + CURRENT, "change: {objects: {current: {unit: null}}}\n") == [
        ("E211", "1.yaml", 2, 30, "there is no `objects.current.unit` to change")
    ]
    assert told("change: {pds: {transitions: {'3': {to: a}}}}\n") == [
        ("E211", "0.yaml", 2, 10, "there is no `pds` to change")
    ]
    assert told(PDS, "change: {pds: {transitions: {'3': {to: a}}}}\n")[0][4] == (
        "there is no `pds.transitions.3` to change"
    )


def test_what_this_file_defines_is_not_for_change() -> None:
    texts = ("objects:" + CURRENT, "objects:" + SPEED + "change: {objects: {speed: {title: X}}}\n")
    (found,) = problems(*texts)
    assert (found.rule, found.hint) == ("E211", "it is defined in this file: change it there")


def test_an_identity_stays() -> None:
    texts = ("objects:" + CURRENT, "change: {objects: {current: {name: amperes}}}\n")
    (found,) = problems(*texts)
    assert (found.rule, found.message) == ("E213", "`objects.current` cannot get another `name` by a change")
    assert merged("objects:" + CURRENT, "change: {objects: {current: {name: current}}}\n")


def test_the_changed_element_must_fit_the_schema() -> None:
    assert told("objects:" + CURRENT, "change: {objects: {current: {type: null}}}\n") == [
        ("E202", "1.yaml", 2, 30, "`type` is missing in `objects.current`")
    ]
    assert told("objects:" + CURRENT, "change: {objects: {current: {name: null}}}\n")[0][0] == "E213"
    assert told("objects:" + CURRENT, "change: {objects: {current: {text: null, index: [1]}}}\n") == [
        ("E202", "1.yaml", 2, 30, "`text` is missing in `objects.current`"),
        ("E203", "1.yaml", 2, 49, "`index` must be an integer or text, not a list"),
    ]
    assert (
        told("objects:" + CURRENT, "change: {objects: {current: {unit: null, titel: a, unit2: b}}}\n")[0][0] == "E211"
    )
    assert told("objects:" + CURRENT, "change: {objects: {current: {text: null, titel: a}}}\n") == [
        ("E202", "1.yaml", 2, 30, "`text` is missing in `objects.current`"),
        ("E201", "1.yaml", 2, 42, "unknown key `titel` in `objects.current`"),
    ]
    assert told("axes: {count: 1, areas: {}}\n", "change: {axes: {count: null, areas: 5}}\n") == [
        ("E203", "1.yaml", 2, 37, "`axes.areas` can only be changed by a mapping")
    ]


def test_axes_without_a_count_are_not_whole() -> None:
    assert told("axes: {areas: {}}\n") == [("E202", "0.yaml", 2, 1, "`count` is missing in `axes`")]


# ---- removals -------------------------------------------------------------------------------------------------------


def test_elements_are_removed() -> None:
    result = merged(
        PDS + "effects: {a: {text: A}, b: {text: B}}\nobjects:" + CURRENT + SPEED,
        "remove: {objects: [current], effects: [a], pds: {transitions: ['16'], events: [fault]}, emergencies: []}\n",
    )
    assert words(result, "objects") == ["speed"]
    assert list(at(result, "effects")) == ["b"]
    assert [item["number"] for item in at(result, "pds", "transitions")] == [15]
    assert at(result, "pds", "events") == {}


def test_what_is_removed_may_be_defined_anew() -> None:
    result = merged(
        "objects:" + CURRENT + SPEED,
        "remove: {objects: [current]}\nobjects:" + CURRENT.replace("title: Current", "title: Amperes"),
    )
    assert [(item["name"], item["title"]) for item in at(result, "objects")] == [
        ("speed", "Current"),
        ("current", "Amperes"),
    ]


def test_a_removal_of_nothing() -> None:
    assert told("objects:" + CURRENT, "remove: {objects: [curent], modes: [pp], pds: {transitions: ['16']}}\n") == [
        ("E212", "1.yaml", 2, 20, "there is no `objects.curent` to remove"),
        ("E212", "1.yaml", 2, 37, "there is no `modes.pp` to remove"),
        ("E212", "1.yaml", 2, 62, "there is no `pds.transitions.16` to remove"),
    ]


def test_what_is_removed_cannot_be_changed() -> None:
    texts = ("objects:" + CURRENT, "remove: {objects: [current]}\nchange: {objects: {current: {title: X}}}\n")
    assert told(*texts)[0][4] == "there is no `objects.current` to change"


def test_all_problems_are_told() -> None:
    found = problems(
        "objects:" + CURRENT,
        "change: {objects: {a: {title: X}}}\nremove: {modes: [b]}\nobjects:" + CURRENT.replace("0x2000", "0x3000"),
    )
    assert [item.rule for item in found] == ["E211", "E212", "E210"]


# ---- the library ----------------------------------------------------------------------------------------------------


def roots() -> list[Path]:
    return [path for path in sorted(SPEC.rglob("*.yaml")) if "\ndevice:" in path.read_text("utf-8")]


@pytest.mark.parametrize("path", roots(), ids=lambda path: path.stem)
def test_devices_of_the_library(path: Path) -> None:
    loaded = load(path, [SPEC])
    validate(loaded)
    result = merge(loaded)
    objects = at(result, "objects")
    assert len({item["name"] for item in objects}) == len(objects)
    documents: list[Any] = list(loaded.documents)
    written = sum(len(document.get("objects", ())) for document in documents)
    removed = sum(len(document.get("remove", {}).get("objects", ())) for document in documents)
    assert len(objects) == written - removed
    assert not {"include", "change", "remove"} & set(result)


KEYS = st.sampled_from(
    ["name", "index", "number", "count", "areas", "device_wide", "rpdo", "1", "map", "text", "title", "subs", "bytes"]
)
DELTAS = st.recursive(
    st.none() | st.integers(0, 3) | st.sampled_from(["current", "modes", "16"]),
    lambda inner: st.lists(inner, max_size=2) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=6,
)
MAPS = st.dictionaries(KEYS, DELTAS, max_size=3)
CHANGES = st.fixed_dictionaries(
    {},
    optional={
        "objects": st.dictionaries(st.sampled_from(["current", "speed"]), MAPS | st.none(), max_size=2),
        "emergencies": st.dictionaries(st.just("fault"), MAPS | st.none(), max_size=1),
        "pds": st.fixed_dictionaries(
            {}, optional={"transitions": st.dictionaries(st.sampled_from(["15", "17"]), MAPS | st.none(), max_size=2)}
        ),
        "pdos": st.none() | st.dictionaries(st.sampled_from(["rpdo", "tpdo", "max_entries"]), DELTAS, max_size=3),
        "axes": st.none() | st.dictionaries(st.sampled_from(["count", "areas", "device_wide"]), DELTAS, max_size=3),
    },
)
REMOVALS = st.fixed_dictionaries(
    {},
    optional={
        "objects": st.lists(st.sampled_from(["current", "speed"]), max_size=2, unique=True),
        "pds": st.fixed_dictionaries({"transitions": st.lists(st.sampled_from(["15", "16"]), unique=True)}),
        "pdos": st.fixed_dictionaries({"rpdo": st.lists(st.sampled_from(["1", "2"]), unique=True)}),
    },
)
ADDITIONS = st.fixed_dictionaries(
    {},
    optional={
        "axes": st.sampled_from([{"count": 1}, {"device_wide": [{"first": 0x1000, "last": 0x1FFF}]}, {"areas": {}}]),
        "pdos": st.sampled_from([{"max_entries": 2}, {"tpdo": {}}]),
        "pds": st.just({"events": {"fault": {"text": "Again."}}}),
    },
)


@given(CHANGES, REMOVALS, ADDITIONS)
def test_any_overlay_is_merged_or_refused(change: object, removal: object, addition: dict[str, object]) -> None:
    base = (
        "axes: {count: 1, areas: {}, device_wide: []}\n"
        "pdos: {rpdo: {'1': {cob_id: 1, transmission_type: 1, map: [], source: {section: 1}}}}\n"
    )
    overlay = {**addition, "change": change, "remove": removal}
    text = "".join(f"{key}: {json.dumps(item)}\n" for key, item in overlay.items())
    try:
        report = "error[E" if merged(base + PDS + "emergencies:" + FAULT + "objects:" + CURRENT, text) else ""
    except SpecError as error:
        report = str(error)
    assert "error[E" in report
