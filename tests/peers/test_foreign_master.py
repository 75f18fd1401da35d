"""A master in another language, the npm package canopen, works with our devices in both runtimes.

What it gets wrong by itself is listed in known_master_bugs.yaml.
"""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.cross.expected import code, entries, power_on_value, role

from odsmith.canopen_types import DataType
from odsmith.model import Device, ExpandedEntry

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent

BUGS: list[dict[str, str]] = yaml.safe_load((HERE / "known_master_bugs.yaml").read_text())

NODE_ID = 5

COMMANDS = {"store", "restore", "tmcl_mode", "manufacturer_mode", "os_command", "pdo_mapped_count", "pdo_mapping"}
"""Effects of entries that do not take what they give, at least not at any time."""

TPDO, SYNCHRONOUS_TPDO, RPDO = 0x185, 0x285, 0x405

PRE_OPERATIONAL, OPERATIONAL, STOPPED, BOOT_UP = 127, 5, 4, 0

Step = list[Any]


@dataclass(frozen=True)
class Outcome:
    """What came of one step."""

    sent: list[str]
    heard: list[list[Any]]
    value: Any = None
    abort: int = 0


Play = Callable[[Sequence[Step]], list[Outcome]]


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(params=["c", "python"])
def program(request: pytest.FixtureRequest, device: Device) -> Path:
    program: Path = request.getfixturevalue(f"{request.param}_testee")(device)
    return program


@pytest.fixture
def play(program: Path, tool: Callable[[str], str]) -> Play:
    """Let the master do all this, one after the other; the device has just been powered."""
    node = tool("node")
    if not (HERE / "npm" / "node_modules").exists():
        tool("what tests/peers/install makes (npm/node_modules)")  # no such program: skips, or fails in CI

    def play(steps: Sequence[Step]) -> list[Outcome]:
        task = {
            "program": [str(program)],
            "node_id": NODE_ID,
            "receive": {TPDO: ["UNSIGNED32"], SYNCHRONOUS_TPDO: ["UNSIGNED16", "INTEGER8"]},
            "transmit": {RPDO: ["UNSIGNED16", "INTEGER32"]},
            "steps": [["line", "POWER on"], *steps],
        }
        done = subprocess.run(
            [node, str(HERE / "npm" / "master.js")], input=json.dumps(task), capture_output=True, text=True, timeout=120
        )
        assert (done.returncode, done.stderr) == (0, "")
        told = json.loads(done.stdout)
        assert told["status"] == 0
        assert {told["version"]} == {bug["version"] for bug in BUGS}
        begin, *outcomes = (Outcome(**answer) for answer in told["answers"])
        assert begin.heard == [["state", NODE_ID, BOOT_UP]]
        return outcomes

    return play


def upload(item: ExpandedEntry, *type: str) -> Step:
    return ["upload", item.index, item.entry.sub, *type]


def test_every_entry_reads_as_modelled(device: Device, play: Play) -> None:
    items = list(entries(device))
    outcomes = play([upload(item) for item in items])
    assert [outcome.value for outcome in outcomes] == [power_on_value(item, NODE_ID).hex().upper() for item in items]


def test_numbers_are_what_they_mean(device: Device, play: Play) -> None:
    items = [item for item in entries(device) if item.entry.type.integer and item.entry.type.bits <= 32]
    outcomes = play([upload(item, item.entry.type.name) for item in items])
    assert [outcome.value for outcome in outcomes] == [
        int.from_bytes(power_on_value(item, NODE_ID), "little", signed=item.entry.type.signed) for item in items
    ]
    (name,) = [item for item in entries(device) if item.index == 0x1008]
    assert name.entry.type is DataType.VISIBLE_STRING
    assert play([upload(name, "VISIBLE_STRING")])[0].value == device.identity.name


def test_what_is_read_can_be_written_back(device: Device, play: Play) -> None:
    items = [item for item in entries(device) if item.entry.access.writable and item.entry.effect not in COMMANDS]
    assert len(items) > 100
    values = [power_on_value(item, NODE_ID).hex().upper() for item in items]
    written = play([["download", item.index, item.entry.sub, value] for item, value in zip(items, values, strict=True)])
    assert [outcome.abort for outcome in written] == [0] * len(items)
    assert not any(outcome.heard for outcome in written)


def test_a_typed_download_arrives(play: Play) -> None:
    written, read = play([["download", 0x607A, 0, -123456, "INTEGER32"], ["upload", 0x607A, 0, "INTEGER32"]])
    assert written.abort == 0
    assert read.value == -123456


def test_segments_of_a_download(device: Device, play: Play) -> None:
    """An OS command, which has 7 octets: first while nobody takes it, then in TMCL mode."""
    command, tmcl_mode = role(device, "os_command"), role(device, "tmcl_mode")
    refused, _, entered, written, read, reply = play(
        [
            ["download", *command, "0601000000000A"],
            ["line", "OS 1 81 82 83 84 85 86 87"],
            ["download", *tmcl_mode, 0x656B616D, "UNSIGNED32"],
            ["download", *command, "0601000000000A"],
            ["upload", *command],
            ["upload", *role(device, "os_reply")],
        ]
    )
    assert refused.abort == code(device, "device_state")
    assert (entered.abort, written.abort) == (0, 0)
    assert (read.value, reply.value) == ("0601000000000A", "81828384858687")


def test_refusals(device: Device, play: Play) -> None:
    """Each abort code that a client can provoke who keeps to the protocol."""
    inactive = 0xC0000485
    dialogue: list[tuple[str, Step]] = [
        ("no_object", ["upload", 0x1ABC, 0]),
        ("no_sub_index", ["upload", 0x1018, 9]),
        ("read_only", ["download", 0x1000, 0, 0, "UNSIGNED32"]),
        ("too_long", ["download", 0x1017, 0, 0, "UNSIGNED32"]),
        ("too_long", ["download", 0x1017, 0, "0000000000000000"]),
        ("too_short", ["download", 0x1005, 0, 0x80, "UNSIGNED16"]),
        ("value_too_high", ["download", 0x2005, 0, 64, "UNSIGNED32"]),
        ("value_too_low", ["download", 0x60C2, 2, -4, "INTEGER8"]),
        ("invalid_value", ["download", 0x1800, 2, 0xF1, "UNSIGNED8"]),
        ("not_stored", ["download", 0x1010, 1, 0x73617665, "UNSIGNED32"]),
        ("device_state", ["download", 0x1A03, 1, 0x60410010, "UNSIGNED32"]),
        ("", ["download", 0x1803, 1, inactive, "UNSIGNED32"]),
        ("", ["download", 0x1A03, 0, 0, "UNSIGNED8"]),
        ("not_mappable", ["download", 0x1A03, 1, 0x10000020, "UNSIGNED32"]),
        *(("", ["download", 0x1A03, sub, 0x60640020, "UNSIGNED32"]) for sub in (1, 2, 3)),
        ("pdo_length", ["download", 0x1A03, 0, 3, "UNSIGNED8"]),
        ("command", ["upload_in_blocks", 0x1008, 0]),
        ("", ["line", "NVM fail"]),
        ("hardware", ["download", 0x1010, 1, 0x65766173, "UNSIGNED32"]),
    ]
    outcomes = play([step for _, step in dialogue])
    names = {0: "", **{abort.code: abort.name for abort in device.abort_codes}}
    assert [names.get(outcome.abort) for outcome in outcomes] == [name for name, _ in dialogue]
    assert {abort.name for abort in device.abort_codes if abort.used} - {name for name, _ in dialogue} == {
        "toggle_bit",
        "timeout",
    }
    strays = [frame for outcome in outcomes for frame in outcome.sent[1:]]
    assert [frame for frame in strays if not any(re.fullmatch(bug["frame"], frame) for bug in BUGS)] == []
    assert all(any(re.fullmatch(bug["frame"], frame) for frame in strays) for bug in BUGS), "a bug is gone"


def test_states(play: Play) -> None:
    outcomes = play(
        [
            ["download", 0x1017, 0, 100, "UNSIGNED16"],
            ["line", "T 100000"],
            ["nmt", "startNode", 0],
            ["line", "T 100000"],
            ["nmt", "stopNode", NODE_ID],
            ["line", "T 100000"],
            ["nmt", "enterPreOperational", NODE_ID],
            ["line", "T 100000"],
            ["nmt", "startNode", NODE_ID + 1],
            ["line", "T 100000"],
            ["nmt", "resetCommunication", NODE_ID],
            ["upload", 0x1017, 0, "UNSIGNED16"],
            ["download", 0x1017, 0, 100, "UNSIGNED16"],
            ["line", "T 100000"],
            ["nmt", "resetNode", NODE_ID],
        ]
    )
    states = [
        [state for event, node_id, state in outcome.heard if (event, node_id) == ("state", NODE_ID)]
        for outcome in outcomes
    ]
    assert states == [
        *([], [PRE_OPERATIONAL]),
        *([], [OPERATIONAL]),
        *([], [STOPPED]),
        *([], [PRE_OPERATIONAL]),
        *([], []),
        *([BOOT_UP], [], [], [PRE_OPERATIONAL]),
        [BOOT_UP],
    ]
    assert outcomes[11].value == 0


def test_emergencies(play: Play) -> None:
    outcomes = play(
        [
            ["line", "CAN error"],
            ["line", "CAN passive"],
            ["line", "CAN ok"],
            ["line", "FAULT axis1 overtemperature on"],
            ["line", "T 1000"],
        ]
    )
    assert [outcome.heard for outcome in outcomes[:3]] == [
        [["emergency", 0x85, 0x8100, 0x11, "00FF000000", "Communication error"]],
        [["emergency", 0x85, 0x8120, 0x11, "00FF000000", "CAN in error passive mode"]],
        [["emergency", 0x85, 0, 0, "00FF000000", "Error reset"]],
    ]
    (error,) = outcomes[4].heard
    assert error[:3] == ["emergency", 0x85, 0x4310]
    assert bytes.fromhex(error[4])[1] == 1


def test_process_data(device: Device, play: Play) -> None:
    """What is mapped anew tells the inputs as they change; a TPDO answers SYNC; an RPDO sets a target."""
    inputs, sub = role(device, "general_inputs")
    outcomes = play(
        [
            ["download", 0x1800, 1, TPDO | 0xC0000000, "UNSIGNED32"],
            ["download", 0x1A00, 0, 0, "UNSIGNED8"],
            ["download", 0x1A00, 1, inputs << 16 | sub << 8 | 32, "UNSIGNED32"],
            ["download", 0x1A00, 0, 1, "UNSIGNED8"],
            ["download", 0x1800, 1, TPDO | 0x40000000, "UNSIGNED32"],
            ["download", 0x1801, 2, 1, "UNSIGNED8"],
            ["nmt", "startNode", NODE_ID],
            ["sync"],
            ["line", "IN digital 5"],
            ["line", "T 1000"],
            ["pdo", RPDO, [0, -123456]],
            ["upload", 0x607A, 0, "INTEGER32"],
        ]
    )
    assert [outcome.abort for outcome in outcomes] == [0] * len(outcomes)
    assert outcomes[7].heard == [["pdo", SYNCHRONOUS_TPDO, [0x0250, 0]]]
    assert outcomes[9].heard == [["pdo", TPDO, [5 << 16]]]
    assert outcomes[11].value == -123456
