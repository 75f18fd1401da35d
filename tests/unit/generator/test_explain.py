"""What `odsmith explain` understands: each answer says what it is, on which axis, and where that is written."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from odsmith.canopen_types import Source
from odsmith.explain import Explanation, explain, explain_rule, known_names, source_text
from odsmith.model import Device


def only(device: Device, term: str) -> Explanation:
    (answer,) = explain(device, term)
    return answer


def facts(answer: Explanation) -> dict[str, str]:
    assert len(dict(answer.rows)) == len(answer.rows), "two properties have one name"
    return dict(answer.rows)


# ---- objects --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("term", "index", "axis", "name"),
    [
        ("6040", "6040h", 0, "Controlword 1"),
        ("0x6040", "6040h", 0, "Controlword 1"),
        ("0X6840", "6840h", 1, "Controlword 2"),
        ("6840h", "6840h", 1, "Controlword 2"),
        ("7040H", "7040h", 2, "Controlword 3"),
        (" 607a ", "607Ah", 0, "Target Position 1"),
        ("TargetPosition", "607Ah", 0, "Target Position 1"),
        ("target_position", "607Ah", 0, "Target Position 1"),
        ("target position 1", "607Ah", 0, "Target Position 1"),
        ("Target Position 2", "687Ah", 1, "Target Position 2"),
        ("target_position_3", "707Ah", 2, "Target Position 3"),
    ],
)
def test_an_object_of_an_axis(term: str, index: str, axis: int, name: str, tmcm3230: Device) -> None:
    answer = facts(only(tmcm3230, term))
    assert (answer["Object"], answer["EDS name"]) == (index, name)
    assert answer["Axis"] == f"{axis} of 0..2 (the EDS name counts from 1)"
    assert answer["On the axes"].count(",") == 2
    assert index in answer["On the axes"]
    assert answer["Source"].startswith("manual, section 6.1.1")


@pytest.mark.parametrize("term", ["1008", "device_name", "ManufacturerDeviceName"])
def test_an_object_of_the_device(term: str, tmcm3230: Device) -> None:
    answer = facts(only(tmcm3230, term))
    assert answer["Object"] == "1008h"
    assert "Axis" not in answer
    assert "On the axes" not in answer
    assert answer["Source"]


@pytest.mark.parametrize(
    ("term", "index", "axis", "name"),
    [
        ("1800", "1800h", 0, "TPDO 1 Communication Parameter"),
        ("1840h", "1840h", 1, "TPDO 65 Communication Parameter"),
        ("TPDO 65 Communication Parameter", "1840h", 1, "TPDO 65 Communication Parameter"),
        ("tpdo_65_communication_parameter", "1840h", 1, "TPDO 65 Communication Parameter"),
        ("1A83", "1A83h", 2, "TPDO 132 Mapping Parameter"),
        ("rpdo 2 mapping parameter", "1601h", 0, "RPDO 2 Mapping Parameter"),
        ("tpdo_communication", "1800h", 0, "TPDO 1 Communication Parameter"),  # no number means the first
    ],
)
def test_a_pdo_object(term: str, index: str, axis: int, name: str, tmcm3230: Device) -> None:
    answer = only(tmcm3230, term)
    assert (facts(answer)["Object"], facts(answer)["EDS name"]) == (index, name)
    assert facts(answer)["Axis"].startswith(f"{axis} of 0..2")
    assert answer.title.lower() == name.lower()


def test_a_pdo_object_of_a_device_without_axes(io_module: Device) -> None:
    assert facts(only(io_module, "TPDO 2 Mapping Parameter"))["Object"] == "1A01h"
    assert facts(only(io_module, "tpdo_mapping"))["Object"] == "1A00h"
    assert "Axis" not in facts(only(io_module, "1A01"))


def test_the_title_of_a_pdo_object_leads_to_it_too(device_of: Callable[[str], Device]) -> None:
    device = device_of("change: {objects: {rpdo_mapping: {parameter_name: 'Receive map {number}'}}}")
    for term in ("Receive map 65", "RPDO 65 mapping parameter", "1640"):
        assert facts(only(device, term))["Object"] == "1640h"


@pytest.mark.parametrize("term", ["607D:1", "607Dh:01", "0x607D:0x01", "607Dsub1", "607D sub 1", "607DSUB1"])
def test_a_sub_index(term: str, tmcm3230: Device) -> None:
    answer = only(tmcm3230, term.replace(" ", ""))
    assert [title for title, _ in answer.tables] == ["Sub-index 01h: Minimum position limit"]
    assert dict(answer.tables[0][1])["Type"] == "INTEGER32"


def test_the_sub_index_of_a_record(tmcm3230: Device) -> None:
    answer = only(tmcm3230, "1018sub2")
    assert facts(answer)["EDS name"] == "Identity Object"
    assert [title for title, _ in answer.tables] == ["Sub-index 02h: Product code"]
    assert dict(answer.tables[0][1])["Default"] == "3230 (00000C9Eh)"
    titles = [title for title, _ in only(tmcm3230, "1018").tables]
    assert [title[:13] for title in titles if title.startswith("Sub")] == [f"Sub-index {sub:02X}h" for sub in range(4)]
    assert [title for title in titles if not title.startswith("Sub")] == ["Bits of sub-index 03h"]


@pytest.mark.parametrize("term", ["607D:9", "607D:zz", "6040:1", "607D:123", "1018subx"])
def test_a_sub_index_that_is_not_there_means_nothing(term: str, tmcm3230: Device) -> None:
    assert explain(tmcm3230, term) == []


def test_an_answer_has_every_fact_of_an_entry(drive: Device) -> None:
    answer = only(drive, "history")
    heir, other = (
        dict(rows) for title, rows in answer.tables if not title.endswith("00h: Highest sub-index supported")
    )
    assert heir == {
        "Type": "UNSIGNED8",
        "Access": "rww",
        "PDO mapping": "RPDO",
        "Allowed": "0..100",
        "Unit": "rpm (1 = 1/60 1/s)",
        "Writable in": "switch_on_disabled",
        "Stored": "block",
        "Default": "1 (01h)",
        "Writing it": drive.effects["value"].text,
        "Meaning": "Takes everything from its object.",
    }
    assert other["Default"] == "-5"
    assert other["Unit"] == "pps (1 = 2 step/s)"
    assert "Stored" not in other  # nobody writes it
    assert "Writing it" not in other


def test_an_answer_has_values_bits_modes_and_errata(drive: Device) -> None:
    tables = dict(only(drive, "switches").tables)
    assert tables["Values"] == (("1", "first: Only the first."), ("32", "second: Only the second."))
    assert tables["Bits"] == (("bit 0", "left: The left one."), ("bit 4..7", "mask: Which count."))
    assert facts(only(drive, "target_position"))["Modes"] == "pp"
    assert facts(only(drive, "controlword"))["Errata"] == "E10 A later one"
    assert "Errata" not in facts(only(drive, "statusword"))
    assert facts(only(drive, "device_name"))["Default"] == "'TOY-2'"
    assert facts(only(drive, "node_address"))["Default"] == "none stated"
    assert dict(only(drive, "1010:1").tables[0][1])["Signature"] == "65766173h 'save' (save)"
    assert dict(only(drive, "1400:1").tables[0][1])["Default"] == "1073742336 (40000200h) + node-ID"


@pytest.mark.slow
def test_no_answer_loses_a_table_in_json(tmcm3230: Device) -> None:
    """Tables are keyed by their titles there, so titles differ."""
    for item in tmcm3230.expanded:
        for answer in explain(tmcm3230, f"{item.index:04X}"):
            titles = [title for title, _ in answer.tables]
            assert len(set(titles)) == len(titles), f"{item.index:04X}h"
            facts(answer)


# ---- everything else ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("term", "kind", "title", "row"),
    [
        ("EMCY 8611", "emergency", "Following error", ("Error code", "8611h")),
        ("emcy 8611h", "emergency", "Following error", ("Affects", "the axis in data byte 4, counted from 0")),
        ("8611", "emergency", "Following error", ("Data bytes 3..7", "00 axis 00 00 00")),
        ("0x8611", "emergency", "Following error", ("Error register", "generic, communication")),
        ("EMCY following error", "emergency", "Following error", ("Error code", "8611h")),
        ("06090030", "abort code", "Invalid value for the parameter", ("Abort code", "06090030h")),
        ("0x06090030", "abort code", "Invalid value for the parameter", ("Used by this device", "yes")),
        ("06090030h", "abort code", "Invalid value for the parameter", ("Name", "invalid_value")),
        ("invalid_value", "abort code", "Invalid value for the parameter", ("Abort code", "06090030h")),
        ("pp", "mode of operation", "Profile position mode", ("Code in 6060h", "1")),
        ("profile_position", "mode of operation", "Profile position mode", ("Bit in 6502h", "0")),
        ("Profile position mode", "mode of operation", "Profile position mode", ("Code in 6060h", "1")),
        ("operation enabled", "PDS state", "Operation enabled", ("Statusword", "& 006Fh = 0027h")),
        ("operation_enabled", "PDS state", "Operation enabled", ("Power", "on")),
        ("method 17", "homing method", "Homing on the negative limit switch", ("Method", "17")),
        ("homing method 17", "homing method", "Homing on the negative limit switch", ("Method", "17")),
        ("E20", "erratum of class A", "E20 COB-IDs of PDOs lack the bit that must always be set", ("Printed", "")),
        ("e20", "erratum of class A", "E20 COB-IDs of PDOs lack the bit that must always be set", ("Why", "")),
    ],
)
def test_terms_that_are_no_object(term: str, kind: str, title: str, row: tuple[str, str], tmcm3230: Device) -> None:
    answer = only(tmcm3230, term)
    assert (answer.kind, answer.title, answer.device) == (kind, title, "TMCM-3230")
    assert facts(answer)["Source"].startswith(("manual, section", "CiA 30", "CiA 402"))
    assert facts(answer)[row[0]].startswith(row[1])
    assert all(facts(answer).values())


def test_a_code_that_several_rows_share(tmcm3230: Device) -> None:
    answers = explain(tmcm3230, "EMCY 1000")
    assert len(answers) > 1
    assert {answer.kind for answer in answers} == {"emergency"}
    assert len({facts(answer)["Data bytes 3..7"] for answer in answers}) == len(answers)


def test_a_word_may_mean_several_things(tmcm3230: Device) -> None:
    """1000h is an object and an emergency; EMCY says which."""
    assert [answer.kind for answer in explain(tmcm3230, "1000")][:2] == ["object", "emergency"]
    assert {answer.kind for answer in explain(tmcm3230, "EMCY 1000")} == {"emergency"}


def test_the_ways_out_of_a_state(tmcm3230: Device) -> None:
    ((title, ways),) = only(tmcm3230, "fault").tables
    assert (title, ways) == ("Ways out", (("transition 15", "to switch_on_disabled by fault_reset"),))


def test_the_bits_of_a_mode(drive: Device) -> None:
    answer = only(drive, "pp")
    assert [title for title, _ in answer.tables] == ["Controlword", "Statusword"]
    assert answer.tables[1][1] == (("bit 10", "target_reached: There."),)
    assert facts(only(drive, "my_mode"))["Bit in 6502h"] == "none"


@pytest.mark.parametrize(
    "term", ["nonsense", "", "   ", "?", "12345", "60 40", "EMCY", "EMCY 9999", "method", "E999", "09999999"]
)
def test_nonsense_means_nothing(term: str, tmcm3230: Device) -> None:
    assert explain(tmcm3230, term) == []


@given(st.text(max_size=12))
def test_no_term_is_too_strange(drive: Device, term: str) -> None:
    for answer in explain(drive, term):
        assert answer.rows


@pytest.mark.slow
def test_every_name_that_is_suggested_leads_somewhere(tmcm3230: Device, drive: Device) -> None:
    for device in (tmcm3230, drive):
        for name in known_names(device):
            assert explain(device, name), name


def test_json_form(drive: Device) -> None:
    answer = only(drive, "switches").to_json()
    assert json.loads(json.dumps(answer)) == answer
    assert list(answer) == ["kind", "title", "device", "properties", "tables"]
    assert (answer["kind"], answer["title"], answer["device"]) == ("object", "Switches", "TOY-2")
    assert isinstance(answer["properties"], dict)
    assert answer["properties"]["EDS name"] == "Limit Switches 1"
    assert isinstance(answer["tables"], dict)
    assert answer["tables"]["Values"] == {"1": "first: Only the first.", "32": "second: Only the second."}


@pytest.mark.parametrize(
    ("source", "text"),
    [
        (Source("manual", section="6.1.1"), "manual, section 6.1.1"),
        (Source("manual", section="6", tables=(207,)), "manual, section 6, table 207"),
        (Source("manual", section="6", tables=(207, 208)), "manual, section 6, tables 207, 208"),
        (Source("manual", section="6", tables=(1,), figures=(8, 9)), "manual, section 6, table 1, figures 8, 9"),
        (Source("manual", figures=(8,)), "manual, figure 8"),
        (Source("vendor_eds", clause="3009h"), "the vendor's EDS, 3009h"),
        (Source("cia402", clause="8.4"), "CiA 402, 8.4"),
        (Source("inferred", note="a reason"), "inferred: a reason"),
    ],
)
def test_sources_as_text(source: Source, text: str) -> None:
    assert source_text((source,)) == text
    assert source_text((source, source)) == f"{text}; {text}"


def test_a_rule_is_explained_by_the_id_that_findings_show() -> None:
    (answer,) = explain_rule("l421")
    assert answer.kind == "rule"
    assert answer.title.startswith("L421 ")
    assert dict(answer.rows)["Severity"] == "error"
    assert explain_rule("L999") == []
