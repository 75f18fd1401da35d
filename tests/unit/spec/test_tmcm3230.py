"""The TMCM-3230 is modelled whole: what its manual counts, the model has."""

from __future__ import annotations

import re
from pathlib import Path

from odsmith.model import Default, Device


def test_indices(tmcm3230: Device) -> None:
    """127 indices in the manual (27 for the device, 100 of axis 0) and 67FFh, which make three axes by stride."""
    device_wide = [item for item in tmcm3230.expanded if item.axis is None]
    axes = [[item.index for item in tmcm3230.expanded if item.axis == axis] for axis in range(3)]
    assert len(device_wide) == 27
    assert [len(indices) for indices in axes] == [101, 101, 101]
    assert 0x67FF in axes[0]
    strides = {0x1: 0x40, 0x2: 0x200, 0x6: 0x800}
    for axis in (1, 2):
        assert axes[axis] == [index + axis * strides[index >> 12] for index in axes[0]]


def test_no_index_of_a_second_axis_is_written(root: Path) -> None:
    """Anywhere in spec/, prose of the errata aside: axes beyond the first exist by stride only."""
    for path in sorted((root / "spec").rglob("*.yaml")):
        facts = re.findall(r"^\s*-?\s*index:\s*(0x[0-9A-Fa-f]+)", path.read_text(encoding="utf-8"), re.MULTILINE)
        for index in (int(fact, 16) for fact in facts):
            assert not 0x2200 <= index < 0x2700, path
            assert not 0x6800 <= index < 0xA000, path
            assert not (0x1400 <= index < 0x1C00 and index & 0x1C0), path


def test_pdos(tmcm3230: Device) -> None:
    """12 RPDOs and 12 TPDOs; those of axis 0 are active, the others have prefilled mappings (manual 3.1.18-3.1.21)."""
    communication = [item for item in tmcm3230.expanded if item.object.pdo.endswith("communication")]
    assert sorted(item.number for item in communication) == sorted(2 * [1, 2, 3, 4, 65, 66, 67, 68, 129, 130, 131, 132])
    for item in communication:
        cob_id = item.entries[1].default
        assert cob_id is not None
        expected = {"rpdo": 0x200, "tpdo": 0x180}[item.object.pdo[:4]] + 0x100 * ((item.number - 1) % 4)
        assert cob_id == (Default(0xC0000000) if item.axis else Default(0x40000000 + expected, node_id=True))
    types = {item.index: item.entries[2].default for item in communication if item.axis == 0}
    assert [types[index].number for index in sorted(types) if types[index]] == [  # type: ignore[union-attr]  # filtered
        0xFF, 0xFF, 0xFF, 0xFE,
        0xFF, 0xFF, 0x01, 0xFE,
    ]  # fmt: skip
    mapping = {item.index: [entry.default for entry in item.entries] for item in tmcm3230.expanded}
    assert mapping[0x1682] == [Default(2), Default(0x70400010), Default(0x707A0020), Default(0)]
    assert mapping[0x1A43] == [Default(2), Default(0x68410010), Default(0x686C0020), Default(0)]


def test_rows(tmcm3230: Device) -> None:
    assert len(tmcm3230.emergencies) == 26
    assert len(tmcm3230.abort_codes) == 31
    assert all(code.why for code in tmcm3230.abort_codes)
    assert [transition.number for transition in tmcm3230.transitions] == list(range(17))
    assert len(tmcm3230.pds_states) == 8
    assert [mode.code for mode in tmcm3230.modes] == [0, 1, 3, 6, 8, 9]
    assert [method.method for method in tmcm3230.homing_methods] == [0, 17, 18, 19, 21, 35]
    assert len(tmcm3230.ramp) == 9
    assert {state.code for state in tmcm3230.nmt_states} == {0, 4, 5, 127}
    assert {command.code for command in tmcm3230.nmt_commands} == {1, 2, 128, 129, 130}
    assert [led.name for led in tmcm3230.leds] == ["run", "error"]


BIT_TABLES = {
    *(11, 12, 35, 68, 147, 162, 165, 204, 246),  # of objects
    *(208, 214, 255, 279, 285, 305, 331),  # of controlword and statusword in a mode
    *(213, 254, 284, 304, 330),  # bits 14 and 15 of the statusword, printed again in each mode
}
"""Tables of the manual that describe bits."""


def test_tables_of_bits_and_values(tmcm3230: Device) -> None:
    """21 bit tables and 26 value tables, as the manual has them; each bit table is cited by something with bits."""
    cited = {
        table
        for obj in tmcm3230.objects
        if any(entry.bits for entry in obj.entries)
        for source in obj.source
        for table in source.tables
    } | {
        table
        for mode in tmcm3230.modes
        if mode.control_bits or mode.status_bits
        for source in mode.source
        for table in source.tables
    }
    assert len(BIT_TABLES) == 21
    assert cited >= BIT_TABLES
    assert sum(bool(entry.values) for obj in tmcm3230.objects for entry in obj.entries) == 26


def test_worked_examples(tmcm3230: Device) -> None:
    """Sections 6.2, 7.2 and 8.3, with the controlwords that they print."""
    words = {
        mode.short: [value for step in recipe.steps for name, value in step.arguments if name == "controlword"]
        for mode in tmcm3230.modes
        for recipe in mode.recipes
    }
    assert words == {"pp": [6, 7, 15, 31, 15], "pv": [6, 7, 15], "hm": [6, 7, 15, 31, 15]}
    added = {step.added for mode in tmcm3230.modes for recipe in mode.recipes for step in recipe.steps}
    assert added == {"", "E81"}


def test_every_element_has_a_source(tmcm3230: Device) -> None:
    sections = (
        tmcm3230.objects, tmcm3230.pdos, tmcm3230.modes, tmcm3230.homing_methods, tmcm3230.ramp, tmcm3230.emergencies,
        tmcm3230.errata, tmcm3230.abort_codes, tmcm3230.nmt_states, tmcm3230.nmt_commands, tmcm3230.leds,
        tmcm3230.pds_states, tmcm3230.pds_commands, tmcm3230.transitions,
    )  # fmt: skip
    for section in sections:
        assert section
        for element in section:
            assert element.source, element


def test_every_writable_entry_says_what_writing_does(tmcm3230: Device) -> None:
    for obj in tmcm3230.objects:
        for entry in obj.entries:
            if entry.access.writable:
                assert tmcm3230.effects[entry.effect].text, (obj.name, entry.name)
                assert entry.stored == "never" or entry.stored in tmcm3230.storage_groups


def test_errata_of_class_a_and_b(tmcm3230: Device) -> None:
    """All that touch a value (24) or a behaviour (52) are there, and each decides something that exists."""
    by_class = {
        severity: {erratum.id for erratum in tmcm3230.errata if erratum.severity == severity} for severity in "AB"
    }
    assert {f"E{n:02}" for n in range(1, 18)} | {"E20", "E22", "E34", "E35", "E37", "E90", "E94"} <= by_class["A"]
    assert len({name for name in by_class["B"] if int(name[1:]) <= 110}) == 52
    assert all(erratum.paths and erratum.evidence and erratum.why for erratum in tmcm3230.errata)
