"""The passes run in their order, each on what the one before has approved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from odsmith.compile import compile_file, compile_spec
from odsmith.errors import SpecError
from odsmith.model import Device
from odsmith.vocabulary import Vocabulary

# One mistake for each pass, in the order in which the passes find them.
MISTAKES = {
    "E110": "bases: {a: 0100}",
    "E201": "basis: {a: 1}",
    "E212": "remove: {objects: [nothing]}",
    "E302": "ramp: {v: {symbol: V, object: rounds, text: A speed., source: {inferred: made up}}}",
    "E409": "change: {objects: {target_position: {range: 1..2}}}",
}


@pytest.mark.parametrize("first", range(len(MISTAKES)))
def test_a_pass_stops_those_behind_it(first: int, spec_file: Callable[[str], Path]) -> None:
    rules = list(MISTAKES)[first:]
    path = spec_file("\n".join(MISTAKES[rule] for rule in rules))
    with pytest.raises(SpecError) as caught:
        compile_spec(path)
    assert [item.rule for item in caught.value.diagnostics] == rules[:1]


@pytest.mark.parametrize("rule", MISTAKES)
def test_the_error_of_every_pass_can_show_its_line(rule: str, spec_file: Callable[[str], Path]) -> None:
    path = spec_file(MISTAKES[rule])
    with pytest.raises(SpecError) as caught:
        compile_spec(path)
    (found,) = caught.value.diagnostics
    shown = str(caught.value).splitlines()
    line = caught.value.texts[found.place.path].splitlines()[found.place.line - 1]
    assert shown[1] == f"    {line}"
    assert shown[2].index("^") == 4 + found.place.column - 1


def test_warnings_come_with_the_model(spec_file: Callable[[str], Path]) -> None:
    compiled = compile_spec(spec_file("include: [drive.yaml]\nremove: {pds: {transitions: ['16']}}"))
    assert isinstance(compiled.model, Device)
    assert [item.rule for item in compiled.warnings] == ["W502"]


def test_the_files_that_were_read(drive: Device, root: Path) -> None:
    """For whoever watches them: includes first, the root among them."""
    compiled = compile_spec(root / "tests" / "unit" / "generator" / "drive.yaml")
    assert compiled.model == drive
    assert compiled.warnings == ()
    names = [path.name for path in compiled.loaded.files]
    assert {"drive.yaml", "toy.yaml", "301.yaml", "runtime_axis.yaml"} <= set(names)
    assert len(names) == len(set(names)) == len(compiled.loaded.texts)


def test_a_file_is_a_device_or_a_vocabulary(root: Path) -> None:
    assert isinstance(compile_file(root / "tests" / "golden" / "toy.yaml"), Device)
    vocabulary = compile_file(root / "spec" / "cia" / "cia.yaml")
    assert isinstance(vocabulary, Vocabulary)
    assert not isinstance(vocabulary, Device)


def test_equal_specs_make_equal_models(drive: Device, copies: Path) -> None:
    assert compile_file(copies / "drive.yaml") == drive
