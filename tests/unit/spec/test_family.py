"""The rule of the family: a fact stands once, so a change to it reaches every axis of every device and nothing else."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from configparser import ConfigParser
from dataclasses import dataclass
from difflib import ndiff
from pathlib import Path

import pytest

from odsmith.compile import compile_spec
from odsmith.model import Device
from odsmith.project import render_all
from odsmith.render import write

DEVICES = {"tmcm3230": 3, "tmcm6212": 6}
"""The devices of the family and their axes."""


def family_files(root: Path) -> list[Path]:
    """The files that do not speak of one device only."""
    return [path for path in sorted((root / "spec" / "trinamic").glob("*.yaml")) if "_tmcm" not in path.name]


def test_the_family_names_no_index_of_the_device_wide_block(root: Path) -> None:
    """27xxh on one device is 30xxh on the other, and 27xxh there is an object of the fourth axis."""
    for path in family_files(root):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            said = line.partition("vendor_eds:")[0]  # which quotes an EDS of one device
            assert not re.search(r"\b(27|30)[0-9A-F]{2}h", said), f"{path.name}:{number}"


def test_the_family_names_no_identity(root: Path) -> None:
    """Name, product code and number of axes are the device's."""
    names = re.compile(r"TMCM-3230|TMCM-6212")
    for path in family_files(root):
        lines = path.read_text(encoding="utf-8").splitlines()
        found = [line for line in lines if names.search(line.partition("vendor_eds:")[0])]
        assert not found or path.name == "errata.yaml", path.name  # which compares them


def test_numbers_of_errata_are_unique_over_all_files(root: Path) -> None:
    texts = [path.read_text(encoding="utf-8") for path in sorted((root / "spec").rglob("*.yaml"))]
    ids = [found for text in texts for found in re.findall(r"^  - id: (E\d+)$", text, re.MULTILINE)]
    assert len(ids) > 100
    assert len(ids) == len(set(ids))


@dataclass(frozen=True)
class Change:
    """A line of a family file, the line that takes its place, and the object that this changes."""

    file: str
    index: int
    name: str
    stride: int
    old: str
    new: str


CHANGES = (
    Change("motor.yaml", 0x2089, "setting_delay", 0x200, "    range: 0..400\n", "    range: 0..500\n"),
    Change("profile.yaml", 0x6085, "quick_stop_deceleration", 0x800, "    default: 51200\n", "    default: 51201\n"),
)


@dataclass(frozen=True)
class Outputs:
    """All files of a device by their path in its folder, as text without the digest, and where they are."""

    device: Device
    folder: Path
    files: dict[str, str]


def build(spec: Path, name: str, folder: Path) -> Outputs:
    compiled = compile_spec(spec / f"{name}.yaml")
    assert isinstance(compiled.model, Device)
    outputs = render_all([compiled])
    write(outputs, folder)
    digest = compiled.model.digest
    files = {
        output.path.partition("/")[2]: output.content.decode().replace(digest, "").replace("\r\n", "\n")
        for output in outputs
    }
    return Outputs(compiled.model, folder, files)


Pair = tuple[Change, Outputs, Outputs]


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(
            (change, name),
            id=f"{change.name}-{name}",
            marks=[] if name == "tmcm3230" else pytest.mark.slow,  # twice the axes take twice as long
        )
        for change in CHANGES
        for name in DEVICES
    ],
)
def pair(request: pytest.FixtureRequest, root: Path, tmp_path_factory: pytest.TempPathFactory) -> Pair:
    """The outputs of a device before and after a change in the family."""
    change, name = request.param
    folder = tmp_path_factory.mktemp(name)
    spec = folder / "spec"
    shutil.copytree(root / "spec", spec, ignore=shutil.ignore_patterns("__pycache__"))
    path = spec / "trinamic" / change.file
    before = build(spec, name, folder / "before")
    text = path.read_text(encoding="utf-8")
    assert text.count(change.old) == 1
    path.write_text(text.replace(change.old, change.new), encoding="utf-8")
    return change, before, build(spec, name, folder / "after")


def changed_lines(before: str, after: str) -> tuple[int, int]:
    """How many lines go, and how many come."""
    marks = [line[0] for line in ndiff(before.splitlines(), after.splitlines())]
    return marks.count("-"), marks.count("+")


def changed_files(pair: Pair) -> Iterator[str]:
    _, before, after = pair
    assert before.files.keys() == after.files.keys()
    return (path for path, text in before.files.items() if text != after.files[path])


def axes_of(change: Change, device: Device) -> list[int]:
    return [change.index + axis * change.stride for axis in range(DEVICES[device.identifier])]


def test_the_model_changes_in_every_axis(pair: Pair) -> None:
    change, before, after = pair
    changed = [old.index for old, new in zip(before.device.expanded, after.device.expanded, strict=True) if old != new]
    assert changed == axes_of(change, before.device)


def test_the_eds_changes_in_every_axis(pair: Pair) -> None:
    change, before, after = pair
    (path,) = (path for path in changed_files(pair) if path.endswith(".eds"))
    parsers = [ConfigParser(interpolation=None) for _ in range(2)]
    for parser, outputs in zip(parsers, (before, after), strict=True):
        parser.read_string(outputs.files[path])
    old, new = parsers
    assert old.sections() == new.sections()
    changed = [name for name in old.sections() if dict(old[name]) != dict(new[name])]
    assert changed == [f"{index:04X}" for index in axes_of(change, before.device)]
    lines = len(changed)
    assert changed_lines(before.files[path], after.files[path]) == (lines, lines)


@pytest.mark.slow
def test_python_changes_in_every_axis(pair: Pair) -> None:
    change, before, after = pair
    old, new = facts_in_python(before), facts_in_python(after)
    assert old.keys() == new.keys()
    assert [index for index in old if old[index] != new[index]] == axes_of(change, before.device)
    dictionary = next(path for path in changed_files(pair) if path.endswith("/dictionary.py"))
    assert changed_lines(before.files[dictionary], after.files[dictionary]) == (1, 1)


PROGRAM = """
for index, obj in DICTIONARY.items():
    print(index, [(entry.sub, entry.stated_default, entry.allowed) for entry in obj])
"""


def facts_in_python(outputs: Outputs) -> dict[int, str]:
    """What the generated package says of each index, in a process of its own."""
    name = outputs.device.identifier
    package = outputs.folder / name / "python"
    program = f"import sys; sys.path.insert(0, {str(package)!r}); from {name} import DICTIONARY\n{PROGRAM}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return {int(index): facts for index, facts in (line.split(" ", 1) for line in done.stdout.splitlines())}


def test_one_row_changes_in_c(pair: Pair) -> None:
    change, before, after = pair
    tables, header = (f"c/{before.device.identifier}_od.{suffix}" for suffix in "ch")
    assert {path for path in changed_files(pair) if path.startswith("c/")} == {tables, header}
    assert changed_lines(before.files[tables], after.files[tables]) == (1, 1)
    (line,) = set(after.files[header].splitlines()) - set(before.files[header].splitlines())
    assert change.name.upper() in line


def test_the_docs_change_in_one_section_about_every_axis(pair: Pair) -> None:
    change, before, after = pair
    pages = [path for path in changed_files(pair) if path.endswith(".md")]
    assert len(pages) == 1
    old, new = (sections(outputs.files[pages[0]]) for outputs in (before, after))
    (section,) = (name for name in old if old[name] != new[name])
    assert section == f"{change.index:04X}h"
    for axis, index in enumerate(axes_of(change, before.device)):
        assert f"`{index:04X}h` axis {axis}" in new[section]
    assert f"axis {DEVICES[before.device.identifier]}" not in new[section]
    html = changed_lines(before.files["docs/index.html"], after.files["docs/index.html"])
    assert html == (1, 1)


def sections(markdown: str) -> dict[str, str]:
    """The sections of a page by the anchor of their heading."""
    parts = re.split(r'(?m)^## <a id="([^"]*)"></a>', markdown)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}
