"""Each cell of a manual is compared: what differs has an erratum, or is an error with its place."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace

import pytest

from odsmith.coverage.account import account
from odsmith.coverage.compare import Comparison, compare
from odsmith.coverage.manual_text import ManualText
from odsmith.errors import UsageError
from odsmith.model import Device

Compared = Callable[[str], Comparison]


def test_the_manual_as_it_is(printed: str, compared: Compared) -> None:
    found = compared(printed)
    assert found.findings == ()
    assert found.unexplained == ()
    assert found.skipped == (1, 24)
    assert len(found.tables) == 26
    assert found.equal + len(found.explained) == len(found.cells) > 240


def test_a_covered_misprint_names_its_erratum(printed: str, compared: Compared) -> None:
    explained = [(c.table, c.what, c.printed, c.modelled, c.errata) for c in compared(printed).explained]
    assert explained[:3] == [
        (5, "name", "Current", "Limit switches", ("E1",)),
        (8, "default", "—", "2 (2h)", ("E3",)),
        (8, "sub-index", "no row", "00h", ("E2",)),
    ]
    assert (27, "default", "200h + Node-ID", "40000200h + node-ID", ("E5",)) in explained
    assert {item[-1] for item in explained if item[0] == 22} == {("E4",)}


@pytest.mark.parametrize(
    ("old", "new", "table", "what", "modelled"),
    [
        # objects
        ("2002 _h\tSPEEDS", "2004 _h\tSPEEDS", 7, "index", "no such object"),
        ("2002 _h\tSPEEDS", "2002 _h\tCurrent", 7, "name", "Speeds"),
        ("SPEEDS\tArray", "SPEEDS\tVariable", 7, "object type", "ARRAY"),
        ("Array\tUNSIGNED32", "Array\tUNSIGNED16", 7, "data type", "UNSIGNED32"),
        ("1400 _h \u2013 1400 _h\tRPDO", "1400 _h \u2013 1403 _h\tRPDO", 26, "index", "1400h to 1400h"),
        # entries
        ("1\tFast speed", "3\tFast speed", 8, "sub-index", "no such sub-index"),
        ("1\tFast speed\trw", "1\tQuick speed\trw", 8, "name", "Fast speed"),
        ("1\tFast speed\trw", "1\tFast speed\tro", 8, "access", "rw"),
        ("0..1000", "0..1001", 8, "range", "0..1000"),
        ("0 / 2...15", "0...15", 8, "range", "0, 2..15"),
        ("500 (fast)", "501 (fast)", 8, "default", "500 (1F4h)"),
        ("0\trw\tyes\tSee", "0\trw\tno\tSee", 17, "mapping", "rx"),
        ("0...255 [flags]\t80 _h", "0...255 [flags]\t80", 6, "default", "128 (80h)"),
        (": FF _h", ": FE _h", 27, "default", "255 (FFh)"),
        ("Description\tAccess\tValue Range", "Description\tAccess\tValues", 27, "heading", "Sub-index or"),
        # bits
        ("0\tLO", "2\tLO", 4, "bit", "no such bit"),
        ("0\tLO", "0\tRO", 4, "name", "left_off"),
        ("7...4\tReserved", "7...5\tReserved", 4, "bit", "no such bit"),
        ("Change immediately\tNot supported.", "Change immediately\t1: now.", 14, "function", "not supported"),
        ("4\tNew set point\t0-to-1: start.", "4\tNew set point\tNot supported.", 14, "function", "supported"),
        ("oms\teo\tqs", "oms\tev\tqs", 13, "bits 3", "enable_operation"),
        ("nu\toms\th", "nu\tfr\th", 13, "bits 9", "mode_specific_high"),
        ("nu\toms\th", "oms\toms\th", 13, "bits 10..15", "rest"),
        ("nu\toms\th", "nu\tnu\tr", 13, "bits 8", "halt"),
        # values
        ("0\tMoves <i>forward</i>", "3\tMoves <i>forward</i>", 9, "value", "no such value"),
        ("1\tMoves backward\n2", "1\tMoves left\n2", 9, "meaning", "backward: The other way round."),
        ("1\t0\tTakes the shortest way", "1\t0\tMoves in circles", 10, "meaning", "shortest: "),
        ("1\t0\tTakes the shortest way", "1\t2\tTakes the shortest way", 10, "value", "no such value"),
        ("1\t1\treserved", "1\t1\tMoves at will", 10, "value", "no such value"),
        ("e\tv\ta\ts", "s\tv\ta\te", 3, "byte", "e"),
        ("65 _h\t76", "65 _h\t75", 3, "byte", "76h"),
        # names, axes, revisions
        ("Spe eds", "Velocities", 25, "name", "Speeds"),
        ("2002 _h\tSpe", "2009 _h\tSpe", 25, "index", "no such object"),
        ("2200 _h \u2013 23FF", "2200 _h \u2013 22FF", 2, "indices", "2200h to 23FFh"),
        ("Motor #1", "Motor #2", 2, "axis", "1"),
        ("Motor #1\t2200 _h \u2013 23FF _h\t6800 _h \u2013 6FFF _h\n", "", 2, "axes", "2"),
        ("1.1\t2026-NOV-02", "1.1\t2026-NOV-03", 23, "date", "2026-11-02"),
        ("1.1\t2026-NOV-02", "1.2\t2026-NOV-02", 23, "version", "no such version"),
        # the drive
        ("Quick stop\t0\tx\t0", "Quick stop\t0\tx\t1", 15, "bit 2", "0"),
        ("Fault reset\t0-to-1", "Fault reset\t1", 15, "bit 7", "0-to-1"),
        ("2,6,8", "2,6", 15, "transitions", "2, 6, 8"),
        ("Shutdown\t0", "Shut up\t0", 15, "command", "no such command"),
        ("x01x 0011 _h", "x01x 0010 _h", 18, "statusword", "xxxxxxxxx01x0011"),
        ("\tSwitched on\n", "\tSwitched off\n", 18, "state", "no such state"),
        ("17\tSearch", "18\tSearch", 20, "method", "no such method"),
        ("(V_{MAX})", "(V_{MIN})", 28, "parameter", "no such parameter"),
        ("(V_{MAX})\t2000", "(V_{MAX})\t2001", 28, "object", "2000h"),
        # messages
        ("8110 _h\t0\t255", "8120 _h\t0\t255", 21, "message", "no such message"),
        ("8110 _h\t0\t255", "8110 _h\t1\t255", 21, "additional byte 1", "0"),
        ("3\t0...1\t0", "3\t0...2\t0", 21, "additional byte 2", "axis"),
        ("3\t0...1\t0\t0\t0", "3\t0...1\t0\t0\t4", 21, "additional byte 5", "0"),
        ("Following error The axis lags.", "Overcurrent somewhere", 21, "title", "Following error"),
    ],
)  # fmt: skip
def test_a_misprint_that_no_erratum_covers(
    old: str, new: str, table: int, what: str, modelled: str, printed: str, compared: Compared
) -> None:
    assert printed.count(old) == 1, "ambiguous"
    found = compared(printed.replace(old, new))
    cell = next(cell for cell in found.unexplained if cell.table == table and cell.what == what)
    assert cell.modelled.startswith(modelled)
    finding = next(finding for finding in found.findings if finding.place == cell.place)
    assert finding.rule == "E703"
    assert finding.severity == "error"
    assert finding.message.startswith(f"table {table}, {what}: the manual ")


def test_the_place_is_that_of_the_cell(printed: str, compared: Compared) -> None:
    text = printed.replace("0..1000", "0..1001")
    (finding,) = compared(text).findings
    line = text.split("\n")[finding.place.line - 1]
    assert line[finding.place.column - 1 :].startswith("0..1001\t")
    assert finding.length == len("0..1001")
    assert finding.message == "table 8, range: the manual prints `0..1001`, the model says `0..1000`"
    assert finding.hint == (
        "correct the model, or write an erratum with `paths: [objects.speeds.subs.1.range]` and `tables: [8]`"
    )


def test_something_modelled_that_has_no_row_is_shown_at_the_caption(printed: str, compared: Compared) -> None:
    text = printed.replace("1\tRight\tRight switch off.\n", "")
    (finding,) = compared(text).findings
    assert text.split("\n")[finding.place.line - 1] == "Table 4: Bit Definitions (2001_h)"
    assert finding.message == "table 4, bit: the manual has no row, the model says `1 right_off`"


def test_an_erratum_must_name_the_table(printed: str, covered: Device, manual_of: Callable[[str], ManualText]) -> None:
    """What holds for one table says nothing of the same misprint in another."""
    errata = tuple(
        replace(erratum, source=(replace(erratum.source[0], tables=(6,)),)) if erratum.id == "E1" else erratum
        for erratum in covered.errata
    )
    model = replace(covered, errata=errata)
    assert model.manual
    found = compare(model, account(model, model.manual), manual_of(printed))
    assert [(cell.table, cell.what) for cell in found.unexplained] == [(5, "name")]


def test_an_erratum_must_name_the_element(printed: str, compared: Compared) -> None:
    """E3 speaks of a default in the table, so it does not excuse an access there."""
    found = compared(printed.replace("2\tSlow speed\trw\tno", "2\tSlow speed\tro\tyes"))
    assert [(cell.table, cell.what) for cell in found.unexplained] == [(8, "access"), (8, "mapping")]


def test_an_erratum_for_a_whole_section(printed: str, covered: Device, manual_of: Callable[[str], ManualText]) -> None:
    """E4 explains every code that is not printed; without it each is an error, as is one that does not exist."""
    model = replace(covered, errata=tuple(erratum for erratum in covered.errata if erratum.id != "E4"))
    assert model.manual
    text = manual_of(printed.replace("06020000 _h", "06020001 _h"))
    found = compare(model, account(model, model.manual), text).unexplained
    assert [cell.modelled for cell in found][:2] == ["no such code", "05040000h"]
    assert len(found) == len(model.abort_codes)


def test_the_nearest_erratum_explains(printed: str, covered: Device, manual_of: Callable[[str], ManualText]) -> None:
    """One about the field says more than one about the object."""
    broad = replace(next(e for e in covered.errata if e.id == "E2"), id="E9", paths=("objects.speeds",))
    model = replace(covered, errata=(*covered.errata, broad))
    assert model.manual
    text = manual_of(printed.replace("2\tSlow speed\trw", "2\tSlow speed\tro"))
    found = compare(model, account(model, model.manual), text)
    assert [(cell.what, cell.errata) for cell in found.explained if cell.table == 8] == [
        ("access", ("E9",)),
        ("default", ("E3",)),
        ("sub-index", ("E2",)),
    ]


def test_a_table_that_no_reader_knows_is_said(printed: str, compared: Compared) -> None:
    found = compared(printed.replace("Method\tDescription", "Way\tDescription"))
    assert found.skipped == (1, 20, 24)
    assert [(finding.rule, finding.message) for finding in found.findings] == [
        ("W704", "table 20, `Supported Homing Methods`, cannot be compared")
    ]


def test_the_contents_must_be_those_of_the_spec(printed: str, compared: Compared) -> None:
    text = printed.replace("5\tMessages\t10\n", "5\tMessages\t10\n5.1\tMore Messages\t10\n")
    text = text.replace("1.1\tAbbreviations\t2\n", "").replace("Table 28:", "Table 29:")
    assert sorted(finding.message for finding in compared(text).findings if finding.rule == "E704") == [
        "section 1.1 is in the spec and not in the manual",
        "section 5.1, More Messages, is in the manual and not in the spec",
        "table 28 is in the spec and not in the manual",
        "table 29 is in the manual and not in the spec",
    ]


def test_the_manual_of_another_device(printed: str, compared: Compared) -> None:
    with pytest.raises(UsageError, match="is not the manual of the TOY-2") as error:
        compared(printed.replace("TOY-2 Operating", "TOY-3 Operating"))
    assert error.value.hint == "it is `TOY-3 Operating Manual`"


def test_rows_that_are_too_short_are_differences(printed: str, compared: Compared) -> None:
    found = compared(printed.replace("8611 _h\t3\t0...1\t0\t0\t0\tFollowing error The axis lags.", "8611 _h\t3"))
    assert {cell.what for cell in found.unexplained} == {*(f"additional byte {n}" for n in (2, 3, 4, 5)), "title"}


@pytest.mark.parametrize("seed", range(40))
def test_a_damaged_text_is_full_of_differences_and_nothing_worse(seed: int, printed: str, compared: Compared) -> None:
    """Text extraction loses cells, shuffles them and reads them wrongly."""
    chance = random.Random(seed)
    lines = printed.split("\n")
    for _ in range(20):
        position = chance.randrange(3, len(lines))
        cells = lines[position].split("\t")
        damage = chance.randrange(4)
        if damage == 0:
            del lines[position]
            continue
        if damage == 1:
            del cells[chance.randrange(len(cells))]
        elif damage == 2:
            cells[chance.randrange(len(cells))] = chance.choice(
                ["", "-", "9h" * 9, "\u00e9", "1...", "/", "Index 1400h : "]
            )
        else:
            chance.shuffle(cells)
        lines[position] = "\t".join(cells)
    found = compared("\n".join(lines))
    assert found.findings
    assert len(found.cells) == found.equal + len(found.explained) + len(found.unexplained)
