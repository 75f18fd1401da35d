"""Do the facts make sense together? tests/errors shows how each rule is broken; here is where each one begins."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from odsmith.check import check
from odsmith.check.errata import PathTree
from odsmith.errors import Diagnostic
from odsmith.load import load, parse
from odsmith.merge import merge
from odsmith.model import Device
from odsmith.render import data_folder

FindingsOf = Callable[[str], tuple[Diagnostic, ...]]


def rules(found: tuple[Diagnostic, ...]) -> list[str]:
    return [item.rule for item in found]


def one_object(fields: str = "", index: int = 0x2100, name: str = "spare") -> str:
    """A list item for `objects`; `fields` are its fields, parted by `; `, where they are not the usual ones."""
    lines = {
        "index": hex(index),
        "name": name,
        "title": name.capitalize(),
        "type": "UNSIGNED8",
        "access": "rw",
        "stored": "never",
        "effect": "value",
        "text": "A value.",
        "source": "{inferred: made up}",
    } | dict(field.split(": ", 1) for field in fields.split("; ") if field)
    return "  - " + "\n    ".join(f"{key}: {value}" for key, value in lines.items() if value != "-") + "\n"


def spare(fields: str = "", index: int = 0x2100, name: str = "spare", include: str = "drive.yaml") -> str:
    """A spec with one more object than its include."""
    return f"include: [{include}]\nobjects:\n{one_object(fields, index, name)}"


@pytest.mark.parametrize("name", ["drive", "tmcm3230", "io_module"])
def test_sound_devices_are_found_sound(name: str, request: pytest.FixtureRequest, root: Path) -> None:
    path = {
        "drive": "tests/unit/generator/drive.yaml",
        "tmcm3230": "spec/tmcm3230.yaml",
        "io_module": "spec/examples/io_module.yaml",
    }[name]
    device: Device = request.getfixturevalue(name)
    assert check(device, merge(load(root / path, [data_folder("spec")]))) == []


# ---- one entry ------------------------------------------------------------------------------------------------------


BOUNDARIES: dict[str, list[str]] = {
    # ranges and defaults reach up to the ends of the type, but not beyond
    "range: 0..255; default: 255": [],
    "range: 0..256": ["E407"],
    "range: -1..255": ["E407"],
    "type: INTEGER8; range: -128..127; default: -128": [],
    "type: INTEGER8; range: -129..127": ["E407"],
    "type: INTEGER8; default: 128": ["E408"],
    "type: UNSIGNED64; default: 0xFFFFFFFFFFFFFFFF": [],
    "type: BOOLEAN; default: 1": [],
    "type: BOOLEAN; default: 2": ["E408"],
    # a default lies in the range, or among the members of the set
    "range: 1..9; default: 1": [],
    "range: 1..9; default: 0": ["E409"],
    "range: 0, 2; default: 1": ["E409"],
    "range: 0, 2; default: 2": [],
    "range: 1..9": [],  # none stated: nothing to say about it
    # with the node-ID for every node-ID
    "default: $NODEID+0x80": [],
    "default: $NODEID+0x81": ["E408"],
    "default: $NODEID; range: 1..127": [],
    "default: $NODEID; range: 2..127": ["E409"],
    "default: $NODEID; range: 1..126": ["E409"],
    # named values
    "values: {'255': {name: all, text: All.}}": [],
    "values: {'256': {name: more, text: More.}}": ["E405"],
    "range: 0..256; values: {'256': {name: more, text: More.}}": ["E407", "E405"],
    "values: {'3': {name: three, text: Three.}}; range: 0..3": [],
    "values: {'4': {name: four, text: Four.}}; range: 0..3": ["E410"],
    # bits
    "bits: {'7': {name: top, text: Top.}}": [],
    "bits: {'8': {name: over, text: Over.}}": ["E406"],
    "bits: {'4..8': {name: over, text: Over.}}": ["E406"],
    "bits: {'0..3': {name: low, text: Low.}, '4..7': {name: high, text: High.}}": [],
    "bits: {'0..4': {name: low, text: Low.}, '4..7': {name: high, text: High.}}": ["E412"],
    "type: BOOLEAN; bits: {'0': {name: only, text: Only.}}": [],
    "type: BOOLEAN; bits: {'1': {name: second, text: Second.}}": ["E406"],
    # no numbers
    "type: REAL32": [],
    "type: REAL32; range: 0..1": ["E411"],
    "type: VISIBLE_STRING; bits: {'0': {name: low, text: Low.}}; length: 4": ["E411"],
    "type: DOMAIN": [],
    "type: OCTET_STRING; length: 1": [],
    "type: OCTET_STRING": ["E413"],
    "type: VISIBLE_STRING; default: abc": [],
    "type: VISIBLE_STRING; default: abc; length: 3": [],
    "type: VISIBLE_STRING; default: abc; length: 2": ["E408"],
    # writing
    "effect: -": ["E414"],
    "access: wo; effect: -": ["E414"],
    "access: ro; effect: -; stored: -": [],
    # what a PDO carries
    "mapping: rx": [],
    "mapping: both": [],
    "access: wo; mapping: rx": [],
    "access: wo; mapping: tx": ["E417"],
    "access: wo; mapping: both": ["E417"],
    "access: ro; mapping: tx": [],
    "access: ro; mapping: both": ["E417"],
    "access: const; mapping: rx": ["E417"],
    # hidden defaults
    "hidden_default: a command; default: 0": [],
    "hidden_default: a command": ["E416"],
}
"""Fields of an object, and the rules that they break: each rule up to its last step and one beyond."""


def test_where_a_rule_begins(findings_of: FindingsOf) -> None:
    cases = [one_object(fields, 0x2100 + number, f"case_{number}") for number, fields in enumerate(BOUNDARIES)]
    found: dict[str, list[str]] = {f"case_{number}": [] for number in range(len(cases))}
    for item in findings_of(f"include: [drive.yaml]\nobjects:\n{''.join(cases)}"):
        name = re.search(r"case_\d+", item.message)
        assert name, item.message
        found[name[0]].append(item.rule)
    assert dict(zip(BOUNDARIES, found.values(), strict=True)) == BOUNDARIES


@pytest.mark.parametrize(
    ("fields", "broken"),
    [
        ("role: microstep_resolution", []),
        ("role: microstep_resolution; access: ro", []),
        ("role: microstep_resolution; access: const", ["E415"]),
        ("role: microstep_resolution; type: UNSIGNED16", ["E419"]),
        ("role: node_id", ["E418"]),
        ("role: node_id; index: 0x2705", []),
        ("role: microstep_resolution; index: 0x2705", ["E418"]),
        ("role: pdo_transmission_type", ["E418"]),
        ("role: os_command; index: 0x2705; type: OCTET_STRING; length: 7", []),
        ("role: os_command; index: 0x2705; type: OCTET_STRING; length: 8", ["E419"]),
    ],
)
def test_roles(fields: str, broken: list[str], findings_of: FindingsOf) -> None:
    assert rules(findings_of(spare(fields))) == broken


ERROR_BEHAVIOUR = """
include: [drive.yaml]
change:
  objects:
    error_behaviour:
      subs:
        "1": {{values: {{"0": {{name: stop, text: Stops., nmt_state: stopped}}, "1": {{name: none, text: Nothing.}}}}}}
        "2": {{values: {{"0": {{name: stop, text: Stops.{0}}}, "1": {{name: none, text: Nothing.{1}}}}}}}
"""


@pytest.mark.parametrize(
    ("zero", "one", "messages"),
    [
        (", nmt_state: stopped", "", []),
        ("", "", ["error behaviour 0 changes no NMT state here, but leads to `stopped` elsewhere"]),
        (
            ", nmt_state: pre_operational",
            ", nmt_state: stopped",
            [
                "error behaviour 0 leads to `pre_operational` here, but leads to `stopped` elsewhere",
                "error behaviour 1 leads to `stopped` here, but changes no NMT state elsewhere",
            ],
        ),
    ],
)
def test_a_choice_of_error_behaviour_means_one_state(
    zero: str, one: str, messages: list[str], findings_of: FindingsOf
) -> None:
    found = findings_of(ERROR_BEHAVIOUR.format(zero, one))
    assert [item.message for item in found] == messages
    assert set(rules(found)) <= {"E423"}


@pytest.mark.parametrize(
    ("fields", "broken"),
    [("effect: error_behaviour", []), ("effect: value", ["E422"]), ("access: ro; stored: -; effect: -", ["E422"])],
)
def test_only_error_behaviour_leads_to_nmt_states(fields: str, broken: list[str], findings_of: FindingsOf) -> None:
    values = 'values: {"0": {name: stop, text: Stops., nmt_state: stopped}}'
    assert rules(findings_of(spare(f"{fields}; {values}"))) == broken


def test_a_role_has_as_many_elements_as_it_says(findings_of: FindingsOf) -> None:
    text = "change: {{objects: {{rpdo_mapping: {{subs: {{'1': {{repeat: {}}}}}}}}}}}"
    assert findings_of(text.format(8)) == ()
    assert rules(findings_of(text.format(9))) == ["E420"]


def test_a_role_is_taken_once(findings_of: FindingsOf) -> None:
    """But once for each direction by PDO parameters, and once for each element of an array."""
    assert findings_of("include: [drive.yaml]") == ()
    (found,) = findings_of(
        "change: {objects: {rpdo_communication: {subs: {'5': {name: again, title: Again, type: UNSIGNED8, access: rw,"
        " stored: never, effect: pdo_parameter, role: pdo_transmission_type, text: Again.}}}}}"
    )
    assert found.rule == "E421"
    assert found.notes[0][1] == "taken here first"


def test_a_role_of_another_scope_is_found_before_its_default_is_missed(findings_of: FindingsOf) -> None:
    text = "change: {objects: {rpdo_communication: {subs: {'2': {role: error_register}}}}}"
    assert rules(findings_of(text)) == ["E418"]


def test_without_axes_an_axis_role_may_live_anywhere_but_a_pdo_role_may_not(findings_of: FindingsOf) -> None:
    """A drive of one axis may do without `axes`; PDO parameters are not of this kind."""
    text = """
        include: [examples/io_module.yaml, cia/runtime_axis.yaml]
        objects:
          - {{index: 0x2001, name: spare, title: Spare, type: UNSIGNED8, access: rw, stored: never, effect: value,
              role: {}, text: A value., source: {{inferred: made up}}}}
        """
    assert findings_of(text.format("microstep_resolution")) == ()
    assert rules(findings_of(text.format("pdo_transmission_type"))) == ["E418"]


def test_the_caret_stands_at_the_fact_even_where_it_is_inherited(findings_of: FindingsOf) -> None:
    text = """
        objects:
          - index: 0x2001
            name: spare
            title: Spare
            object_type: ARRAY
            type: UNSIGNED8
            access: ro
            range: 0..300
            subs:
              "1": {name: one, text: One.}
              "2": {name: two, range: 0..5, default: 9, text: Two.}
            text: A value.
            source: {inferred: made up}
        """
    inherited, own = findings_of(text)
    assert (inherited.rule, inherited.place.line, inherited.place.column) == ("E407", 10, 12)
    assert (own.rule, own.place.line, own.place.column) == ("E409", 13, 46)
    assert "2001h:01 `spare.one`" in inherited.message
    assert "2001h:02 `spare.two`" in own.message


# ---- the dictionary -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["device_type", "error_register", "identity_object"])
def test_mandatory_objects(name: str, findings_of: FindingsOf) -> None:
    (found,) = findings_of(f"remove: {{objects: [{name}]}}")
    assert found.rule == "E401"


def test_two_objects_that_clash_on_many_axes_are_reported_once(findings_of: FindingsOf) -> None:
    found = findings_of("change: {axes: {count: 5, areas: {profile: {stride: 0x16}}}}")
    assert [item.message for item in found] == [
        "607Ah is taken twice: by `position_actual_value` of axis 1 and by `target_position` of axis 0"
    ]


def test_objects_side_by_side_do_not_clash(findings_of: FindingsOf) -> None:
    assert findings_of("change: {axes: {count: 5, areas: {profile: {stride: 0x1B}}}}") == ()


def test_the_last_axis_may_end_at_the_end_of_the_dictionary(findings_of: FindingsOf) -> None:
    fits = "change: {axes: {count: 2, areas: {profile: {stride: 0x9F85}}}}"
    assert findings_of(fits) == ()  # 607Ah + 9F85h = FFFFh
    (found,) = findings_of(fits.replace("0x9F85", "0x9F86"))
    assert found.message == "`target_position` of axis 1 lies at 10000h, past the end of the dictionary"


@pytest.mark.parametrize(("index", "broken"), [(0x21FF, []), (0x13FF, []), (0x2800, ["E404"]), (0x9000, ["E404"])])
def test_every_object_lies_in_an_area(index: int, broken: list[str], findings_of: FindingsOf) -> None:
    assert rules(findings_of(spare(index=index))) == broken


def test_a_device_without_axes_has_no_areas(findings_of: FindingsOf) -> None:
    assert findings_of(spare(index=0x9000, include="examples/io_module.yaml")) == ()


# ---- PDOs -----------------------------------------------------------------------------------------------------------


def test_a_pdo_carries_64_bits(findings_of: FindingsOf) -> None:
    text = "change: {{pdos: {{rpdo: {{'1': {{map: [{}]}}}}}}}}"
    assert findings_of(text.format("target_position, target_position")) == ()
    found = findings_of(text.format("target_position, target_position, modes_of_operation"))
    assert [item.rule for item in found] == ["E431"]


def test_a_pdo_has_as_many_entries_as_the_device_allows(findings_of: FindingsOf) -> None:
    text = "change: {{pdos: {{rpdo: {{'1': {{map: [{}]}}}}}}}}"
    assert findings_of(text.format(", ".join(["modes_of_operation"] * 4))) == ()
    assert rules(findings_of(text.format(", ".join(["modes_of_operation"] * 5)))) == ["E432"]


@pytest.mark.parametrize(
    ("kind", "mapping", "broken"),
    [("rpdo", "rx", []), ("rpdo", "both", []), ("rpdo", "tx", ["E433"]),
     ("tpdo", "rx", ["E433"]), ("tpdo", "both", []), ("tpdo", "tx", [])],
)  # fmt: skip
def test_direction_of_what_is_mapped(kind: str, mapping: str, broken: list[str], findings_of: FindingsOf) -> None:
    text = spare(f"mapping: {mapping}") + f"change: {{pdos: {{{kind}: {{'1': {{map: [spare]}}}}}}}}"
    assert rules(findings_of(text)) == broken


def test_pdos_that_share_a_can_id(findings_of: FindingsOf) -> None:
    """A warning for both; one that is off shares nothing."""
    text = "include: [drive.yaml]\nchange: {{pdos: {{tpdo: {{'2': {{cob_id: {}}}}}}}}}"
    found = findings_of(text.format("$NODEID+0x40000180"))
    assert [(item.rule, item.severity) for item in found] == [("W501", "warning")] * 2
    assert {item.message[:6] for item in found} == {"TPDO 1", "TPDO 2"}
    assert findings_of(text.format("$NODEID+0xC0000180")) == ()
    assert rules(findings_of(text.format("$NODEID+0x40000200"))) == ["W501", "W501"]  # with the RPDO


# ---- what a drive does ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message", "names"),
    [
        ("modes: {profile_velocity: {bit: 0}}", "modes have the bit of 6502h 0", "profile_position profile_velocity"),
        ("homing_methods: {right: {method: 0}}", "homing methods have the number 0", "nothing right"),
        ("abort_codes: {crc: {code: 0x05030000}}", "abort codes have the code 05030000h", "crc toggle_bit"),
        ("nmt: {states: {stopped: {code: 5}}}", "NMT states have the code 5", "operational stopped"),
        ("nmt: {commands: {stop: {code: 1}}}", "NMT commands have the code 1", "start stop"),
        ("mode_codes: {torque: {code: 1}}", "mode codes have the code 1", "profile_position torque"),
    ],
)
def test_numbers_that_are_given_twice(change: str, message: str, names: str, findings_of: FindingsOf) -> None:
    (found,) = findings_of(f"include: [drive.yaml]\nchange: {{{change}}}")
    assert found.rule == "E441"
    assert found.message.startswith(f"two {message}: ")
    assert sorted(found.message.split("`")[1::2]) == names.split()


def test_transitions_that_share_a_number(findings_of: FindingsOf) -> None:
    """They are told apart by it, so that merging finds it."""
    text = "pds: {transitions: [{number: 16, to: fault, by: fault, text: Again., source: {inferred: made up}}]}"
    assert rules(findings_of(text)) == ["E210"]


def test_modes_without_a_bit_do_not_share_one(findings_of: FindingsOf) -> None:
    mine = "mine: {code: -2, text: A mode., source: {inferred: made up}}"
    none = "no_mode: {text: No mode., source: {inferred: made up}}"
    assert findings_of(f"modes: {{{mine}, {none}}}") == ()


def test_one_code_may_have_rows_with_different_first_bytes(findings_of: FindingsOf) -> None:
    text = "include: [drive.yaml]\nchange: {{emergencies: {{overrun: {{code: 0x8611, bytes: [{}, 255, 0, 0, 0]}}}}}}"
    assert findings_of(text.format(4)) == ()
    assert rules(findings_of(text.format(3))) == ["E441"]


def test_a_state_needs_a_way_from_power_on(findings_of: FindingsOf) -> None:
    """Two states that only lead to each other are not reached."""
    found = findings_of("remove: {pds: {transitions: ['14']}}")
    assert [item.message for item in found] == ["no transition leads to the PDS state `fault`"]
    found = findings_of("remove: {pds: {transitions: ['0']}}")
    assert rules(found) == ["E442"] * 8
    assert findings_of("remove: {pds: {transitions: ['16']}}") == ()


def test_states_differ_in_a_bit_that_both_name(findings_of: FindingsOf) -> None:
    text = "change: {{pds: {{states: {{fault: {{status: '{}'}}}}}}}}"
    assert findings_of(text.format("xxxx xxxx x0xx 1000")) == ()
    found = findings_of(text.format("xxxx xxxx x0xx x000"))
    assert [item.message for item in found] == ["a statusword can mean both `not_ready_to_switch_on` and `fault`"]
    assert found[0].notes[0][1] == "`not_ready_to_switch_on` is here"


def test_an_axis_in_an_emergency_needs_axes_or_a_state_machine(findings_of: FindingsOf) -> None:
    text = """
        include: [examples/io_module.yaml{}]
        change: {{emergencies: {{can_passive: {{bytes: [0, axis, 0, 0, 0]}}}}}}
        """
    assert rules(findings_of(text.format(""))) == ["E446"]
    assert findings_of(text.format(", cia/402.yaml")) == ()


# ---- identifiers ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "languages"),
    [("while", "C and of Python"), ("register", "C"), ("none_", ""), ("match", ""), ("def", "Python")],
)
def test_words_of_the_languages(name: str, languages: str, findings_of: FindingsOf) -> None:
    found = findings_of(spare(name=name))
    assert {item.message for item in found} == ({f"`{name}` is a word of {languages}"} if languages else set())


def test_names_of_sub_indices_count_too(findings_of: FindingsOf) -> None:
    found = findings_of("change: {objects: {identity_object: {subs: {'1': {name: long}}}}}")
    assert [item.message for item in found] == ["`long` is a word of C"]


@pytest.mark.parametrize(
    ("name", "languages"), [("double", "C"), ("lambda", "Python"), ("continue", "C and of Python"), ("match", "")]
)
def test_names_of_roles_count_too(name: str, languages: str, findings_of: FindingsOf) -> None:
    found = findings_of(f"roles: {{{name}: {{scope: device, type: UNSIGNED8, text: A value.}}}}")
    assert [(item.rule, item.message) for item in found] == (
        [("E452", f"`{name}` is a word of {languages}")] if languages else []
    )


def test_members_of_one_entry_differ_in_name(findings_of: FindingsOf) -> None:
    found = findings_of(spare("bits: {'0': {name: same, text: A.}, '1': {name: same, text: B.}}"))
    assert rules(found) == ["E453"]
    assert findings_of(spare("bits: {'0': {name: same, text: A.}}; values: {'1': {name: same, text: B.}}")) == ()


def test_an_eds_name_may_collide_with_that_of_an_axis(findings_of: FindingsOf) -> None:
    found = findings_of(spare("parameter_name: Current 2", 0x2705))
    assert [item.message for item in found] == ["`current` and `spare` are both called `Current 2` in the EDS"]
    assert findings_of(spare("parameter_name: Current 3", 0x2705)) == ()  # there is no third axis


def test_pdo_names_end_after_32_characters(findings_of: FindingsOf) -> None:
    text = "change: {{objects: {{rpdo_mapping: {{parameter_name: '{} {{number}}'}}}}}}"
    assert findings_of(text.format("M" * 29)) == ()  # and a blank and two digits on the second axis
    assert rules(findings_of(text.format("M" * 30))) == ["E455"]


# ---- errata ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "leads"),
    [
        ("objects", True),
        ("objects.current", True),
        ("objects.current.default", True),
        ("objects.current.default.0", False),
        ("objects.curent", False),
        ("objects.history.subs.2.access", True),
        ("objects.history.subs.3", False),
        ("objects.current.bits.5", True),
        ("objects.current.bits.6", False),
        ("objects.current.false", True),  # a fact may be false or nothing
        ("objects.current.nothing", True),
        ("objects.current.empty", False),  # a key without a value says nothing
        ("pds.transitions.16", True),
        ("pds.transitions.17", False),
        ("emergencies.overrun.bytes", True),
        ("errata.E2", True),
        ("abort_codes.toggle_bit.used", True),
        ("", False),
    ],
)
def test_paths_that_lead_somewhere(path: str, leads: bool) -> None:
    tree = PathTree(
        parse(
            b"""
            objects:
              - {name: current, default: 50, bits: {"5": {name: x}}, "false": false, nothing: 0, empty: }
              - {name: history, subs: {"2": {access: ro}}}
            pds: {transitions: [{number: 16}]}
            emergencies: [{name: overrun, bytes: [0]}]
            errata: [{id: E2}]
            abort_codes: {toggle_bit: {used: true}}
            """,
            "a.yaml",
        )
    )
    assert tree.leads_somewhere(path) == leads


def test_an_erratum_about_what_the_device_lacks_is_a_warning(findings_of: FindingsOf) -> None:
    (found,) = findings_of("include: [drive.yaml]\nremove: {pds: {transitions: ['16']}}")
    assert (found.rule, found.severity) == ("W502", "warning")
    assert found.message == "erratum E2 decides `pds.transitions.16`, which this device does not have"


def test_every_kind_of_finding_at_once(findings_of: FindingsOf) -> None:
    """The checks do not stop at the first one that finds something, and the findings are in the order of the files."""
    found = findings_of("""
        change:
          objects: {current: {default: 200, effect: null}}
          modes: {profile_velocity: {code: 1}}
          pdos: {rpdo: {"1": {map: [current]}}}
        remove:
          pds: {transitions: ["14"]}
          objects: [device_type]
        """)
    assert sorted(rules(found)) == ["E401", "E409", "E414", "E433", "E441", "E442"]
    assert [item.place for item in found] == [
        item.place for item in sorted(found, key=lambda item: (item.place.path, item.place.line, item.place.column))
    ]
