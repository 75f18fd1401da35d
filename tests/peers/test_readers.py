"""Every reader takes our EDS files without a word, and reads out of them what the model says.

What a reader gets wrong by itself is listed in known_bugs.yaml. A bug excuses what it describes and nothing else, for
the version that it names; one that is gone makes a test fail.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import yaml

pytestmark = pytest.mark.slow

Tables = dict[str, dict[str, dict[str, object]]]

FILE = "file_name file_version file_revision eds_version description created created_by modified modified_by"
NAME_PLATE = "vendor_name vendor_number product_name product_number revision_number order_code bit_rates"
ABILITIES = "boot_up_master boot_up_slave granularity dynamic_channels group_messaging rpdos tpdos lss"

EXPOSED = {
    "python_canopen": {
        "device": f"{NAME_PLATE} {ABILITIES}",
        "objects": "name kind",
        "entries": "name type access default relative low high mappable",
        "pdos": "can_id enabled rtr_allowed transmission_type inhibit_time event_timer map",
    },
    "dcf": {
        "device": "vendor_number product_number revision_number device_type",
        "objects": "name kind subs",
        "entries": "name type access readable writable value relative low high mappable",
        "pdos": "cob_id transmission_type inhibit_time event_timer map",
    },
    "dcf2dev": {
        "device": f"{NAME_PLATE} lss",
        "objects": "name kind",
        "entries": "name type access value relative least most mappable",
    },
    "dcfgen": {
        "device": "device_type vendor_number product_number emergency_cob_id",
        "active_pdos": "cob_id transmission_type map",
    },
    "eds_utils": {
        "device": f"{FILE} {NAME_PLATE} {ABILITIES}",
        "objects": "name kind",
        "entries": "name type access value low high mappable",
    },
    "objdictgen": {
        "device": "product_name description boot_up_slave",
        "objects": "name",
        "entries": "name type sdo_access value relative mappable",
    },
    "canmatrix": {
        "device": "symbol",
        "numbers": "symbol bits signed",
        "frames": "can_id sent bytes",
        "signals": "symbol start bits signed least most factor offset",
    },
    "npm_canopen": {
        "device": f"{FILE} {NAME_PLATE} {ABILITIES}",
        "objects": "name kind subs",
        "entries": "name sub type access default value low high mappable refuse_write_on_scan",
    },
}
"""What each reader lets its user see of a file: tables (see conftest.py) and their fields."""


@dataclass(frozen=True)
class Bug:
    """One entry of known_bugs.yaml."""

    reader: str
    version: str
    what: str
    link: str
    message: str = ""
    fields: tuple[str, ...] = ()
    where: dict[str, object] = field(default_factory=dict)

    def excuses_message(self, text: str) -> bool:
        return bool(self.message) and re.fullmatch(self.message, text) is not None

    def excuses(self, difference: Difference) -> bool:
        return difference.path in self.fields and all(
            difference.facts.get(name) in (allowed if isinstance(allowed, list) else [allowed])
            for name, allowed in self.where.items()
        )


@dataclass(frozen=True)
class Difference:
    """A fact that a reader got wrong. `path` is `table.field`, or `table` where a whole row is missing or made up."""

    path: str
    row: str
    facts: dict[str, object] = field(repr=False)
    modelled: object = None
    read: object = None


def _bugs() -> list[Bug]:
    text = (Path(__file__).parent / "known_bugs.yaml").read_text(encoding="utf-8")
    listed: list[dict[str, Any]] = yaml.safe_load(text)
    return [Bug(**{**bug, "fields": tuple(bug.get("fields", ()))}) for bug in listed]


BUGS = _bugs()


NUMBER = re.compile(r"(\$NODEID\+)?(0x[0-9A-F]+|-?\d+)")


def differences(modelled: Tables, read: Tables, node_id: int) -> Iterator[Difference]:
    for table, rows in read.items():
        for key in sorted(modelled[table].keys() ^ rows.keys()):
            yield Difference(table, key, modelled[table].get(key) or rows[key])
        for key in sorted(modelled[table].keys() & rows.keys()):
            facts = modelled[table][key]
            for name, value in rows[key].items():
                if not _same(value, facts[name], node_id):
                    yield Difference(f"{table}.{name}", key, facts, facts[name], value)


def _same(read: object, modelled: object, node_id: int) -> bool:
    """Equal, and not True for 1. Some readers keep a number as the text that stands in the file."""
    if isinstance(read, str) and isinstance(modelled, int):
        match = NUMBER.fullmatch(read)
        return match is not None and int(match[2], 0) + (node_id if match[1] else 0) == modelled
    return read == modelled and isinstance(read, bool) == isinstance(modelled, bool)


Readings = Callable[[str], dict[tuple[str, int], Any]]
Facts = Callable[[str, int], Tables]


@pytest.fixture(params=EXPOSED)
def reader(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


def test_it_loads_without_a_word(readings: Readings, reader: str, device_name: str, node_id: int) -> None:
    said = readings(reader)[device_name, node_id].messages
    assert [text for text in said if not any(bug.reader == reader and bug.excuses_message(text) for bug in BUGS)] == []


def test_it_reads_what_the_model_says(
    readings: Readings, facts: Facts, reader: str, device_name: str, node_id: int
) -> None:
    read = readings(reader)[device_name, node_id].tables
    found = differences(facts(device_name, node_id), read, node_id)
    bugs = [bug for bug in BUGS if bug.reader == reader]
    assert [each for each in found if not any(bug.excuses(each) for bug in bugs)] == []


def test_it_exposes_what_it_should(readings: Readings, reader: str, device_name: str, node_id: int) -> None:
    """Or the comparison would compare nothing."""
    tables = readings(reader)[device_name, node_id].tables
    assert {name: {" ".join(row) for row in rows.values()} for name, rows in tables.items()} == {
        name: {fields} for name, fields in EXPOSED[reader].items()
    }


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: f"{bug.reader}: {bug.what}")
def test_every_known_bug_is_still_there(readings: Readings, facts: Facts, bug: Bug) -> None:
    """If this fails, the reader has become better: take the bug, or the part of it that is gone, off the list."""
    found = readings(bug.reader)
    assert {reading.version for reading in found.values()} == {bug.version}
    said = [text for reading in found.values() for text in reading.messages]
    wrong = [
        difference
        for (name, node_id), reading in found.items()
        for difference in differences(facts(name, node_id), reading.tables, node_id)
    ]
    gone = [path for path in bug.fields if not any(bug.excuses(each) for each in wrong if each.path == path)]
    if bug.message and not any(bug.excuses_message(text) for text in said):
        gone.append(bug.message)
    assert bug.fields or bug.message
    assert gone == []
