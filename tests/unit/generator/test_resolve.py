"""Names become things, and what the YAML leaves out is filled in; `drive.yaml` has one of everything."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.compile import compile_file
from odsmith.errors import Diagnostic, SpecError
from odsmith.load import Map, Seq, load
from odsmith.merge import merge
from odsmith.model import Allowed, Bit, Default, Device, Entry, NamedValue, Object, Pdo
from odsmith.render import data_folder
from odsmith.resolve import resolve
from odsmith.vocabulary import Unit, Vocabulary

DeviceOf = Callable[[str], Device]
FindingsOf = Callable[[str], tuple[Diagnostic, ...]]


def the(device: Device, name: str) -> Object:
    found = device.object(name)
    assert found is not None
    return found


def entry(device: Device, name: str, sub: int = 0) -> Entry:
    found = the(device, name).entry(sub)
    assert found is not None
    return found


# ---- entries --------------------------------------------------------------------------------------------------------


def test_a_sub_index_takes_from_its_object_what_it_leaves_out(drive: Device) -> None:
    heir = entry(drive, "history", 1)
    assert (heir.type, heir.access, heir.mapping) == (DataType.UNSIGNED8, Access.RW, PdoDirection.RX)
    assert heir.allowed == Allowed(((0, 100),), listed=False)
    assert (heir.stored, heir.effect, heir.writable_in) == ("block", "value", ("switch_on_disabled",))
    assert heir.unit is drive.units["turns"]
    assert heir.hidden_default == "a command"
    assert heir.refuse_write_on_scan
    assert heir.source == the(drive, "history").source
    assert (heir.title, heir.parameter_name) == ("Heir", "Heir")


def test_a_sub_index_may_say_everything_itself(drive: Device) -> None:
    other = entry(drive, "history", 2)
    assert (other.type, other.access, other.mapping) == (DataType.INTEGER16, Access.RO, PdoDirection.TX)
    assert other.allowed == Allowed(((-5, 5),), listed=False)
    assert other.unit is drive.units["steps"]
    assert other.hidden_default == "another reason"
    assert not other.refuse_write_on_scan
    assert other.source == (Source("inferred", note="its own"),)
    assert (other.title, other.parameter_name) == ("Other", "Other")  # made from the name


def test_what_only_writes_have_is_not_inherited_by_a_read_only_entry(drive: Device) -> None:
    other = entry(drive, "history", 2)
    assert (other.effect, other.stored) == ("", "never")


def test_an_object_does_not_hand_on_what_describes_one_value(device_of: DeviceOf) -> None:
    """Default, values, bits, role and groups belong to one entry."""
    device = device_of("""
        objects:
          - index: 0x2001
            name: many
            title: Many
            object_type: ARRAY
            type: UNSIGNED8
            access: ro
            default: 7
            values: {"7": {name: seven, text: Seven.}}
            bits: {"0": {name: low, text: Low.}}
            subs: {"1": {name: one, text: One.}}
            text: Many.
            source: {inferred: made up}
        """)
    one = entry(device, "many", 1)
    assert (one.default, one.values, one.bits, one.allowed) == (None, (), (), None)


def test_sub_index_0_is_made(drive: Device) -> None:
    count = entry(drive, "store")
    assert (count.type, count.access, count.default) == (DataType.UNSIGNED8, Access.RO, Default(5))
    assert count.constant
    assert (count.mapping, count.stored, count.effect, count.allowed) == (PdoDirection.NO, "never", "", None)


def test_sub_index_0_may_be_written_out(drive: Device) -> None:
    assert entry(drive, "tpdo_mapping").name == "count"
    assert entry(drive, "tpdo_mapping").access is Access.RW


def test_repeated_sub_indices_are_numbered(drive: Device) -> None:
    """{i} counts from 0 as the axes do, {n} from 1 as EDS names do; once per axis or a fixed number of times."""
    axes = [entry(drive, "store", sub) for sub in (4, 5)]
    assert [item.name for item in axes] == ["axis_0", "axis_1"]
    assert [item.title for item in axes] == ["Axis 0", "Axis 1"]
    assert [item.parameter_name for item in axes] == ["Save axis 1", "Save axis 2"]
    assert [item.text for item in axes] == ["Axis 0, the 1th.", "Axis 1, the 2th."]
    assert [(item.repeat, item.per_axis) for item in axes] == [(0, True), (1, True)]
    assert not entry(drive, "store", 1).per_axis
    mapping = the(drive, "tpdo_mapping").entries
    assert [(item.sub, item.name, item.per_axis) for item in mapping[1:]] == [
        (1, "mapping_1", False),
        (2, "mapping_2", False),
        (3, "mapping_3", False),
    ]


def test_more_axes_repeat_more(device_of: DeviceOf) -> None:
    device = device_of("include: [drive.yaml]\nchange: {axes: {count: 4}}")
    assert [item.name for item in the(device, "store").entries[2:]] == ["axis_0", "axis_1", "axis_2", "axis_3"]
    assert entry(device, "store").default == Default(7)


def test_an_array_role_is_filled_in_the_order_of_the_sub_indices(drive: Device) -> None:
    """However the sub-indices are ordered in the file; the numbers in names and texts are those of the repetition."""
    first, second = entry(drive, "error_behaviour", 1), entry(drive, "error_behaviour", 2)
    assert [(item.role, item.repeat) for item in (first, second)] == [("error_behaviour", 0), ("error_behaviour", 1)]
    assert (second.name, second.text) == ("own_1", "Number 1.")


def test_braces_in_the_text_of_a_variable_are_text(device_of: DeviceOf) -> None:
    assert entry(device_of('change: {objects: {current: {text: "the set {n}"}}}'), "current").text == "the set {n}"


def test_strings_are_as_long_as_they_say_or_as_their_default(drive: Device, device_of: DeviceOf) -> None:
    assert entry(drive, "device_name").length == 5
    assert entry(drive, "device_name").default == Default(text="TOY-2")
    assert entry(drive, "node_address").length == 4
    assert entry(drive, "node_address").default is None
    longer = device_of("include: [drive.yaml]\nchange: {objects: {device_name: {length: 20}}}")
    assert entry(longer, "device_name").length == 20


# ---- indices --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "index", "stride"),
    [
        ("device_type", 0x1000, 0),
        ("tpdo_mapping", 0x1A00, 0x40),
        ("switches", 0x2001, 0x200),
        ("speed_unit", 0x2700, 0),
        ("node_address", 0x2704, 0),
        ("controlword", 0x6040, 0x800),
    ],
)
def test_an_index_has_the_stride_of_its_area(drive: Device, name: str, index: int, stride: int) -> None:
    assert (the(drive, name).index, the(drive, name).stride) == (index, stride)


def test_objects_are_in_the_order_of_their_indices(drive: Device) -> None:
    indices = [obj.index for obj in drive.objects]
    assert indices == sorted(indices)


def test_a_base_moves_its_objects(device_of: DeviceOf) -> None:
    device = device_of("include: [drive.yaml]\nchange: {bases: {block: 0x2710}}")
    assert [the(device, name).index for name in ("speed_unit", "node_address")] == [0x2710, 0x2714]


def test_object_types(drive: Device) -> None:
    assert the(drive, "controlword").object_type is ObjectType.VAR
    assert the(drive, "history").object_type is ObjectType.ARRAY
    assert the(drive, "tpdo_mapping").object_type is ObjectType.RECORD


def test_areas_of_the_axes_then_of_the_device(drive: Device) -> None:
    areas = [(area.name, area.first, area.stride) for area in drive.areas]
    assert areas[0] == ("manufacturer", 0x2000, 0x200)
    assert areas[4:] == [
        ("tpdo_communication", 0x1800, 0x40),
        ("tpdo_mapping", 0x1A00, 0x40),
        ("device_wide", 0x1000, 0),
        ("device_wide", 0x2700, 0),
    ]


# ---- values, bits, units --------------------------------------------------------------------------------------------


def test_values_are_sorted_and_make_the_allowed_set(drive: Device) -> None:
    switches = entry(drive, "switches")
    assert switches.values == (
        NamedValue(1, "first", "Only the first."),
        NamedValue(32, "second", "Only the second."),
    )
    assert switches.allowed == Allowed(((1, 1), (32, 32)), listed=True)


def test_the_nmt_state_of_a_value(device_of: DeviceOf) -> None:
    device = device_of(
        "include: [drive.yaml]\nchange: {objects: {error_behaviour: {subs: {'1': {values: "
        "{'3': {name: stop, text: Stops., nmt_state: stopped}, '2': {name: none, text: Nothing.}}}}}}}"
    )
    assert [(value.value, value.nmt_state) for value in entry(device, "error_behaviour", 1).values] == [
        (2, ""),
        (3, "stopped"),
    ]
    assert [(value, state.code) for value, state in device.error_behaviour.items()] == [(3, 4)]


def test_a_range_goes_before_the_values(device_of: DeviceOf) -> None:
    device = device_of("include: [drive.yaml]\nchange: {objects: {switches: {range: 0..40}}}")
    assert entry(device, "switches").allowed == Allowed(((0, 40),), listed=False)


def test_values_of_a_section(drive: Device) -> None:
    modes = entry(drive, "modes_of_operation")
    assert [(value.value, value.name) for value in modes.values] == [
        (-1, "my_mode"),
        (1, "profile_position"),
        (3, "profile_velocity"),
    ]
    assert modes.values[2].text == "Turning (turn)."
    assert modes.allowed == Allowed(((-1, -1), (1, 1), (3, 3)), listed=True)
    homing = entry(drive, "homing_method")
    assert [(value.value, value.name, value.text) for value in homing.values] == [
        (0, "nothing", "Nothing."),
        (18, "right", "Right switch."),
    ]


def test_bits_are_sorted(drive: Device) -> None:
    assert entry(drive, "switches").bits == (
        Bit(0, 0, "left", "The left one.", supported=False),
        Bit(4, 7, "mask", "Which count."),
    )


def test_bits_of_a_section(drive: Device) -> None:
    """6502h lists every mode of CiA 402, 1001h the bits of the error register."""
    modes = entry(drive, "supported_drive_modes").bits
    assert [(bit.low, bit.name) for bit in modes][:3] == [
        (0, "profile_position"),
        (1, "velocity"),
        (2, "profile_velocity"),
    ]
    assert [bit.low for bit in modes] == sorted(bit.low for bit in modes)
    register = entry(drive, "error_register").bits
    assert (register[0].name, register[0].mask) == ("generic", 1)
    assert [bit.low for bit in register] == sorted(bit.low for bit in register)
    assert {bit.name for bit in register} == set(drive.register_bits)


def test_modes_as_a_default(drive: Device, device_of: DeviceOf) -> None:
    assert entry(drive, "supported_drive_modes").default == Default(1 << 0 | 1 << 4)
    fewer = device_of("include: [drive.yaml]\nremove: {modes: [profile_velocity]}")
    assert entry(fewer, "supported_drive_modes").default == Default(1)


def test_node_id_in_a_default(device_of: DeviceOf) -> None:
    device = device_of("change: {objects: {target_position: {default: $NODEID+0x80}}}")
    assert entry(device, "target_position").default == Default(0x80, node_id=True)


def test_units(drive: Device) -> None:
    assert drive.units["speed"] == Unit(
        "speed", "rpm", "velocity", "1/s", 1, 60, "What the object for the unit says.", "speed_unit",
        ((0, "turns"), (16, "steps")),
    )  # fmt: skip
    assert (drive.units["steps"].numerator, drive.units["steps"].denominator) == (2, 1)
    assert entry(drive, "switches").unit is drive.units["speed"]


def test_signatures_and_groups(drive: Device) -> None:
    (save,) = entry(drive, "store", 4).signatures
    assert (save.name, save.value, save.ascii) == ("save", 0x65766173, "save")
    assert entry(drive, "store", 1).groups == ("motor", "block")
    assert entry(drive, "store", 4).groups == ("motor",)


def test_one_source_for_each_authority(drive: Device) -> None:
    assert the(drive, "history").source == (
        Source("manual", section="1.2", tables=(3, 4), figures=(5,)),
        Source("vendor_eds", clause="1003h"),
        Source("cia301", clause="7.5.2.4"),
    )
    assert the(drive, "switches").source == (
        Source("manual", section="4", figures=(7,)),
        Source("inferred", note="made up"),
    )


def test_a_list_of_sources(device_of: DeviceOf) -> None:
    device = device_of("""
        change: {objects: {current: {source: [{section: "1"}, {section: "2", tables: [9]}, {cia402: "3"}]}}}
        """)
    assert the(device, "current").source == (
        Source("manual", section="1"),
        Source("manual", section="2", tables=(9,)),
        Source("cia402", clause="3"),
    )


# ---- PDOs -----------------------------------------------------------------------------------------------------------


def test_pdos_are_in_order(drive: Device) -> None:
    assert [(pdo.kind, pdo.number) for pdo in drive.pdos] == [("rpdo", 1), ("tpdo", 1), ("tpdo", 2)]
    first: Pdo = drive.pdos[1]
    assert first.cob_id == Default(0x40000180, node_id=True)
    assert first.other_axes_cob_id == Default(0xC0000000)
    assert (first.transmission_type, first.inhibit_time, first.event_timer) == (254, 5, 100)
    assert [(item.object.name, item.entry.name) for item in first.map] == [
        ("statusword", "statusword"),
        ("history", "other"),
    ]
    second = drive.pdos[2]
    assert (second.cob_id, second.inhibit_time, second.event_timer, second.map) == (Default(0x80000000), 0, 0, ())


def test_pdos_of_other_axes_are_off_where_nothing_is_said(io_module: Device) -> None:
    assert {pdo.other_axes_cob_id for pdo in io_module.pdos} == {Default(0x80000000)}


def test_pdo_objects_stand_for_as_many_indices_as_there_are_pdos(drive: Device, device_of: DeviceOf) -> None:
    assert (the(drive, "tpdo_mapping").count, the(drive, "rpdo_mapping").count, the(drive, "current").count) == (
        2,
        1,
        1,
    )
    fewer = device_of('include: [drive.yaml]\nremove: {pdos: {tpdo: ["1", "2"]}}')
    assert fewer.object("tpdo_mapping") is None
    assert the(fewer, "rpdo_mapping").count == 1


# ---- what a drive does ----------------------------------------------------------------------------------------------


def test_modes(drive: Device) -> None:
    """Codes, bits and names come from CiA 402 where the device gives none of its own; ascending by code."""
    modes = [(mode.code, mode.bit, mode.short, mode.title) for mode in drive.modes]
    assert modes == [
        (-1, None, "my_mode", "My mode"),
        (1, 0, "pp", "Profile position mode"),
        (3, 4, "turn", "Turning"),
    ]
    position = drive.modes[1]
    assert position.objects == ("target_position",)
    assert position.slow_down_ramp == "current"
    assert [(bit.label, bit.name, bit.supported) for bit in position.control_bits] == [
        ("4", "new_set_point", True),
        ("5", "change_immediately", False),
    ]
    assert [bit.name for bit in position.status_bits] == ["target_reached"]


def test_steps_of_a_recipe(drive: Device) -> None:
    (recipe,) = drive.modes[1].recipes
    assert (recipe.name, recipe.title) == ("move", "Move")
    assert [(step.kind, step.arguments) for step in recipe.steps] == [
        ("write", (("switches", 0x20), ("history.heir", 7))),  # the name of a value is that value
        ("write", (("modes_of_operation", 1),)),
        ("command", (("command", "shutdown"),)),
        ("expect", (("state", "ready_to_switch_on"),)),
        ("expect", (("status_bit", "target_reached"), ("position_actual_value", 500))),
        ("expect", (("status_bit", "remote"),)),  # a bit of the statusword itself
        ("input", (("home", 1),)),
        ("wait", (("milliseconds", 100),)),
    ]
    assert (recipe.steps[0].added, recipe.steps[0].text) == ("E10", "Two at once.")
    assert (recipe.steps[1].added, recipe.steps[1].text) == ("", "")


def test_homing_methods(drive: Device) -> None:
    nothing, right = drive.homing_methods
    assert (nothing.method, nothing.direction, nothing.edge, nothing.switch) == (0, 0, 0, "none")
    assert (right.method, right.direction, right.edge, right.switch) == (18, 1, -1, "positive_limit")
    assert right.needs_power
    assert not right.index_pulse


def test_ramp(drive: Device) -> None:
    assert [(item.name, item.symbol, item.object) for item in drive.ramp] == [("v_max", "VMAX", "current")]


def test_emergencies_stay_in_the_order_of_the_table(drive: Device) -> None:
    first, second = drive.emergencies
    assert (first.name, first.bytes, first.per_axis) == ("following_error", (3, "axis", 0, 0, 0), True)
    assert (second.name, second.bytes, second.per_axis) == ("overrun", (0, 255, 0, 0, 0), False)
    assert (first.register, second.register) == (("generic", "communication"), ())
    assert not second.momentary  # where nothing is said


def test_errata_are_in_the_order_of_their_numbers(drive: Device) -> None:
    assert [erratum.id for erratum in drive.errata] == ["E2", "E10"]


def test_identity(drive: Device, device_of: DeviceOf) -> None:
    plate = drive.identity
    assert (plate.identifier, plate.name, plate.order_code, plate.version) == ("toy", "TOY-2", "TOY-2-B", "1.0.0")
    assert (plate.digital_inputs, plate.analog_inputs) == (3, 1)
    assert (plate.digital_outputs, plate.analog_outputs) == (2, 4)
    assert (plate.eds.created_by, plate.eds.modified_by, plate.eds.modification_date) == (
        "odsmith",
        "somebody",
        "11-23-2026",
    )
    assert [revision.version for revision in plate.firmware] == ["1.0"]
    plain = device_of("").identity
    assert plain.order_code == "TOY-2"
    assert (plain.digital_inputs, plain.analog_inputs, plain.analog_outputs) == (0, 0, 0)
    assert (plain.manual, plain.firmware) == ("", ())
    assert (plain.eds.modified_by, plain.eds.modification_date, plain.eds.modification_time) == (
        "odsmith",
        "11-22-2026",
        "09:00AM",
    )


def test_vocabulary(vocabulary: Vocabulary) -> None:
    assert not isinstance(vocabulary, Device)
    assert vocabulary.identifier == "cia"
    codes = [code.code for code in vocabulary.abort_codes]
    assert codes == sorted(codes)
    assert [transition.number for transition in vocabulary.transitions] == list(range(17))
    states = {state.name: state for state in vocabulary.pds_states}
    assert (states["operation_enabled"].mask, states["operation_enabled"].value) == (0x6F, 0x27)
    commands = {command.name: command for command in vocabulary.pds_commands}
    assert (commands["fault_reset"].mask, commands["fault_reset"].edge) == (0, 0x80)
    thirteen = vocabulary.transitions[13]
    assert (len(thirteen.start), thirteen.by, thirteen.end) == (5, ("fault",), "fault_reaction_active")
    assert vocabulary.transitions[0].start == ()


# ---- overlays -------------------------------------------------------------------------------------------------------


def test_what_a_device_changes_and_removes(drive: Device, device_of: DeviceOf) -> None:
    device = device_of("""
        include: [drive.yaml]
        change:
          objects:
            current: {default: 40, range: 0..50}
            homing_method: {default: -3}
            history: {subs: {"2": {unit: null, text: Changed.}}}
          homing_methods: {nothing: {method: -3}}
          emergencies: {overrun: {register: [generic]}}
        remove:
          objects: [node_address]
          modes: [my_mode]
          homing_methods: [right]
          emergencies: [following_error]
          errata: [E2]
          pds: {transitions: ["16"]}
        """)
    assert entry(device, "current").default == Default(40)
    assert entry(device, "current").allowed == Allowed(((0, 50),), listed=False)
    assert entry(device, "current").stored == "motor"  # what the change does not name stays
    assert entry(device, "history", 2).text == "Changed."
    assert entry(device, "history", 2).unit is device.units["turns"]  # nothing is left of it but what it inherits
    assert entry(device, "history", 1) == entry(drive, "history", 1)
    assert device.object("node_address") is None
    assert [value.value for value in entry(device, "modes_of_operation").values] == [1, 3]
    assert [value.value for value in entry(device, "homing_method").values] == [-3]
    assert [(row.name, row.register) for row in device.emergencies] == [("overrun", ("generic",))]
    assert [erratum.id for erratum in device.errata] == ["E10"]
    assert 16 not in [transition.number for transition in device.transitions]
    assert 16 in [transition.number for transition in drive.transitions]


# ---- names that lead nowhere ----------------------------------------------------------------------------------------

NOWHERE = {
    "unit": ("change: {objects: {current: {unit: rounds}}}", "there is no unit `rounds`"),
    "unit of a choice": (
        "change: {units: {speed: {options: {'0': rounds}}}}",
        "there is no unit `rounds`",
    ),
    "object that chooses a unit": (
        "change: {units: {speed: {selected_by: speed_index}}}",
        "there is no object `speed_index`",
    ),
    "effect": ("change: {objects: {current: {effect: explode}}}", "there is no effect `explode`"),
    "role": ("change: {objects: {current: {role: current}}}", "there is no role `current`"),
    "signature": ("change: {objects: {store: {signatures: [safe]}}}", "there is no signature `safe`"),
    "group of a command": (
        "change: {objects: {store: {subs: {'1': {groups: [motors]}}}}}",
        "there is no storage group `motors`",
    ),
    "storage group": ("change: {objects: {current: {stored: motors}}}", "there is no storage group `motors`"),
    "state for writing": (
        "change: {objects: {current: {writable_in: [enabled]}}}",
        "there is no PDS state `enabled`",
    ),
    "base": ("change: {objects: {speed_unit: {index: blocks}}}", "there is no base index `blocks`"),
    "object of a mode": (
        "change: {modes: {profile_position: {objects: [target]}}}",
        "there is no object `target`",
    ),
    "ramp of a mode": (
        "change: {modes: {profile_position: {slow_down_ramp: brake}}}",
        "there is no object `brake`",
    ),
    "object of the ramp": ("change: {ramp: {v_max: {object: vmax}}}", "there is no object `vmax`"),
    "register bit": ("change: {emergencies: {overrun: {register: [noise]}}}", "there is no error register bit `noise`"),
    "condition": ("change: {emergencies: {overrun: {condition: rain}}}", "there is no condition `rain`"),
    "reaction": ("change: {emergencies: {overrun: {reaction: panic}}}", "there is no reaction `panic`"),
    "start of a transition": (
        "change: {pds: {transitions: {'16': {from: [stopped]}}}}",
        "there is no PDS state `stopped`",
    ),
    "end of a transition": ("change: {pds: {transitions: {'16': {to: stopped}}}}", "there is no PDS state `stopped`"),
    "command of a transition": (
        "change: {pds: {transitions: {'16': {by: magic}}}}",
        "there is no PDS command or event `magic`",
    ),
    "NMT state of a value": (
        "change: {objects: {switches: {values: {'1': {nmt_state: halted}}}}}",
        "there is no NMT state `halted`",
    ),
    "NMT state": ("change: {nmt: {commands: {start: {to: running}}}}", "there is no NMT state `running`"),
    "mapped object": (
        "change: {pdos: {tpdo: {'1': {map: [status_word]}}}}",
        "there is no object `status_word`",
    ),
    "mapped sub-index": (
        "change: {pdos: {tpdo: {'1': {map: [history.others]}}}}",
        "there is no sub-index of `history` called `others`",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", NOWHERE)
def test_a_name_that_leads_nowhere_is_an_error(what: str, findings_of: FindingsOf) -> None:
    text, message = NOWHERE[what]
    found = findings_of(f"include: [drive.yaml]\n{text}")
    assert [(item.rule, item.message) for item in found] == [("E302", message)]
    assert found[0].hint
    assert found[0].place.line == 3 or what.startswith("object that chooses")


@pytest.mark.parametrize(
    ("step", "message"),
    [
        ("write: {switch: 1}", "there is no object `switch`"),
        ("write: {history.first: 1}", "there is no sub-index of `history` called `first`"),
        ("write: {switches: third}", "there is no value of `switches` called `third`"),
        ("command: start", "there is no PDS command `start`"),
        ("expect: {state: enabled}", "there is no PDS state `enabled`"),
        ("expect: {status_bit: arrived}", "there is no statusword bit `arrived`"),
        ("expect: {switches: third}", "there is no value of `switches` called `third`"),
        ("{wait: 1, added: E99}", "there is no erratum `E99`"),
    ],
)
def test_a_step_that_leads_nowhere_is_an_error(step: str, message: str, findings_of: FindingsOf) -> None:
    found = findings_of(f"""
        include: [drive.yaml]
        change:
          modes:
            profile_position:
              recipes:
                move:
                  steps:
                    - {step}
        """)
    assert [(item.rule, item.message) for item in found] == [("E302", message)]


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("motr", "did you mean `motor`?"),
        ("zzz", "known: block, motor, never"),
    ],
)
def test_the_hint_names_what_there_is(name: str, hint: str, findings_of: FindingsOf) -> None:
    (found,) = findings_of(f"include: [drive.yaml]\nchange: {{objects: {{current: {{stored: {name}}}}}}}")
    assert found.hint == hint


def test_the_hint_does_not_list_what_is_too_much(findings_of: FindingsOf) -> None:
    (found,) = findings_of("include: [drive.yaml]\nchange: {objects: {current: {effect: zzz}}}")
    assert found.hint == "define it, or include the file that does"


def test_all_problems_are_shown_at_once(findings_of: FindingsOf) -> None:
    found = findings_of("change: {objects: {current: {unit: a, effect: b, stored: c, default: x}}}")
    assert sorted(item.message for item in found) == [
        "`x` is no default for UNSIGNED8",
        "there is no effect `b`",
        "there is no storage group `c`",
        "there is no unit `a`",
    ]


def test_what_is_kept_says_where(findings_of: FindingsOf) -> None:
    """Every rw entry names a storage group or `never`."""
    (found,) = findings_of("change: {objects: {current: {stored: null}}}")
    assert (found.rule, found.message) == ("E305", "`current` has no `stored`")


def test_modes_are_no_default_of_a_string(findings_of: FindingsOf) -> None:
    (found,) = findings_of("include: [drive.yaml]\nchange: {objects: {supported_drive_modes: {type: REAL32}}}")
    assert (found.rule, found.message) == ("E301", "`$MODES` is no default for REAL32")


def test_a_file_is_a_device_or_a_vocabulary_not_both(findings_of: FindingsOf) -> None:
    (found,) = findings_of("vocabulary: {identifier: toy, title: Toy}")
    assert found.rule == "E309"


# ---- the digest -----------------------------------------------------------------------------------------------------


def test_the_digest_does_not_know_where_the_spec_lies(drive: Device, copies: Path) -> None:
    assert compile_file(copies / "drive.yaml").digest == drive.digest


def test_the_digest_of_a_copied_library(tmcm3230: Device, root: Path, tmp_path: Path) -> None:
    shutil.copytree(root / "spec", tmp_path / "elsewhere", ignore=shutil.ignore_patterns("__pycache__"))
    assert compile_file(tmp_path / "elsewhere" / "tmcm3230.yaml").digest == tmcm3230.digest


def as_json(text: str) -> str:
    return json.dumps(yaml.safe_load(text))


def as_narrow_blocks(text: str) -> str:
    return str(yaml.safe_dump(yaml.safe_load(text), indent=6, width=30, sort_keys=False, default_flow_style=False))


def with_remarks_and_dos_line_ends(text: str) -> str:
    return "".join(f"# a remark\r\n{line}\r\n" for line in text.splitlines())


@pytest.mark.parametrize("reformat", [as_json, as_narrow_blocks, with_remarks_and_dos_line_ends])
def test_the_digest_does_not_know_how_the_spec_is_formatted(
    drive: Device, copies: Path, reformat: Callable[[str], str]
) -> None:
    for path in (copies / "drive.yaml", copies.parent.parent / "golden" / "toy.yaml"):
        path.write_bytes(reformat(path.read_text(encoding="utf-8")).encode())
    assert compile_file(copies / "drive.yaml").digest == drive.digest


@pytest.mark.slow
def test_every_fact_counts_in_the_digest(drive: Device, root: Path) -> None:
    """Change one value of each kind in the two files: each change is refused, or gives a digest of its own."""
    spec = merge(load(root / "tests" / "unit" / "generator" / "drive.yaml", [data_folder("spec")]))
    digests = {drive.digest: "nothing"}
    refused = 0
    kinds = {}  # a kind: section, depth and key
    for address, node, key in leaves(spec, "", str(root / "tests")):
        kinds[address.split(".")[1], address.count("."), str(key)] = (address, node, key)
    for address, node, key in kinds.values():
        value = node[key]
        node[key] = another(value)
        try:
            digest = resolve(spec).digest
            assert digest not in digests, f"{address} counts as little as {digests[digest]}"
            digests[digest] = address
        except SpecError:
            refused += 1  # a name that something refers to, or a value that cannot be read
        finally:
            node[key] = value
    assert len(digests) > 120
    assert refused < 50


def leaves(node: Map | Seq, address: str, folder: str) -> Iterator[tuple[str, Any, str | int]]:
    """The scalars that files of a folder have written, with the mapping or list that holds them."""
    for key, value in node.items() if isinstance(node, Map) else enumerate(node):
        place = node.place(key)  # type: ignore[arg-type]  # a key of a mapping or an index of a list
        if isinstance(value, Map | Seq):
            yield from leaves(value, f"{address}.{key}", folder)
        elif place.path.startswith(folder) and key != "format":
            yield f"{address}.{key}", node, key


WORDS = {
    "UNSIGNED8": "UNSIGNED16", "UNSIGNED16": "UNSIGNED8", "UNSIGNED32": "INTEGER32", "INTEGER8": "UNSIGNED8",
    "INTEGER16": "UNSIGNED16", "INTEGER32": "UNSIGNED32", "VISIBLE_STRING": "OCTET_STRING",
    "OCTET_STRING": "VISIBLE_STRING", "ARRAY": "RECORD", "RECORD": "ARRAY", "rw": "wo", "ro": "const", "const": "ro",
    "rx": "tx", "tx": "both", "negative": "positive", "positive": "negative", "none": "negative", "axes": 3,
}  # fmt: skip
"""Words that cannot be lengthened, with others of their kind."""


def another(value: object) -> object:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    return WORDS.get(str(value), f"{value}1")
