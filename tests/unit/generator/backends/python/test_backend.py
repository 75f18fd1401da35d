"""The Python package of a device: complete, typed, quick to import, and harmless whatever the spec says."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import re
import subprocess
import sys
import zlib
from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from odsmith.backends.c import CBackend
from odsmith.backends.eds import EdsBackend
from odsmith.backends.python import PythonBackend
from odsmith.backends.python.names import RESERVED, declared_classes, word_bits
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.compile import compile_file
from odsmith.explain import source_text
from odsmith.model import (
    Allowed,
    AxisArea,
    Bit,
    Default,
    Device,
    Entry,
    ExpandedEntry,
    Identity,
    Mode,
    NamedValue,
    Object,
    Recipe,
    Step,
)
from odsmith.names import class_name
from odsmith.render import MARK, Output
from odsmith.vocabulary import Role, Vocabulary
from odsmith_runtime import ObjectDictionary, OutOfRangeError, ReadOnlyError, WrongSignatureError, codec, recipes
from odsmith_runtime.device.tables import Tables

HOSTILE = (
    'q" q\'\' """ \'\'\' \\ \\" {{ x }} {0} %s */ # \n\t\x00\x1b\u2028\u202e\u00e9 <script> $NODEID __import__("os")'
)
"""Text that would break out of anything that does not look."""


# ---- packages --------------------------------------------------------------------------------------------------------


def write_package(model: Device | Vocabulary, folder: Path) -> Path:
    """Render a model; the folder that has its package in it."""
    outputs = PythonBackend().render(model)
    for output in outputs:
        path = folder / output.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(output.content)
    return folder / outputs[0].path.split("/")[0] / "python"


def load_package(folder: Path, name: str, alias: str) -> ModuleType:
    """Import a package under another name, so that no installed one is meant."""
    spec = importlib.util.spec_from_file_location(
        alias, folder / name / "__init__.py", submodule_search_locations=[str(folder / name)]
    )
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[alias] = module
    spec.loader.exec_module(module)
    return module


class Package:
    """A generated package, its model, and where it lies."""

    def __init__(self, model: Device, folder: Path, alias: str) -> None:
        self.model = model
        self.folder = write_package(model, folder)
        self.module: Any = load_package(self.folder, model.identity.identifier, alias)

    @property
    def dictionary(self) -> ObjectDictionary:
        found: ObjectDictionary = self.module.DICTIONARY
        return found


def tiny_device(io_module: Device) -> Device:
    """Two axes, every data type, and what real devices rarely have."""

    def entry(sub: int, name: str, data_type: DataType, **facts: Any) -> Entry:
        common = {"title": name.title(), "parameter_name": name.title(), "text": f"About {name}.", "effect": "none"}
        required = {"access": Access.RW, "mapping": PdoDirection.NO, "default": None}
        return Entry(sub=sub, name=name, type=data_type, **{**common, **required, **facts})

    def variable(index: int, name: str, data_type: DataType, stride: int = 0, **facts: Any) -> Object:
        single = entry(0, name, data_type, **facts)
        source = (Source("manual", "1", (2,)),)
        return Object(
            index, name, single.title, single.parameter_name, ObjectType.VAR, (single,), single.text, source, stride
        )

    plain = [variable(0x2000 + number, f"a_{item.value.lower()}", item) for number, item in enumerate(DataType)]
    both = variable(
        0x2100,
        "both",
        DataType.INTEGER16,
        0x100,
        values=(NamedValue(-1, "low", "Low."), NamedValue(3, "high", "High.")),
        bits=(Bit(0, 0, "first", "First."), Bit(4, 7, "field", "Field.", supported=False)),
        allowed=Allowed(((-1, -1), (3, 3)), listed=True),
        default=Default(3),
    )
    record = Object(
        0x2110,
        "record",
        "Record",
        "Record",
        ObjectType.RECORD,
        (
            entry(0, "highest_sub_index", DataType.UNSIGNED8, access=Access.CONST, default=Default(200)),
            entry(5, "class_5", DataType.UNSIGNED32, access=Access.WO, default=Default(0x80, node_id=True)),
            entry(200, "enums", DataType.OCTET_STRING, length=4, default=Default(text="ab")),
        ),
        "",
        (),
        0x100,
    )
    steps = (
        Step("write", (("both", 3), ("record.class_5", 1))),
        Step("command", (("command", "go"),)),
        Step("input", (("home", 1),)),
        Step("wait", (("milliseconds", 5),)),
        Step("expect", (("state", "on"), ("status_bit", "ready"), ("both", -1)), "Text.", "E1"),
    )
    mode = Mode("spin", -3, "sp", "Spin", None, "", recipes=(Recipe("move", "Move", "", steps),))
    return dataclasses.replace(
        io_module,
        identity=dataclasses.replace(io_module.identity, identifier="tiny"),
        axes=2,
        areas=(AxisArea("manufacturer", 0x2100, 0x21FF, 0x100),),
        objects=(*plain, both, record),
        pdos=(),
        modes=(mode,),
        digest="d",
    )


def hostile(value: Any, field: str = "") -> Any:
    """A model with hostile text wherever a spec may have free text."""
    free = {
        *("text", "title", "why", "cause", "remedy", "clause", "note", "section", "symbol", "quantity", "base"),
        *("hidden_default", "vendor", "manual", "added"),
    }
    if isinstance(value, str) and type(value) is str and field in free:
        return HOSTILE
    if isinstance(value, tuple):
        return tuple(hostile(item) for item in value)
    if isinstance(value, dict):
        return {key: hostile(item) for key, item in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, (type, Default)):
        changed = {
            item.name: hostile(getattr(value, item.name), item.name)
            for item in dataclasses.fields(value)
            if item.name != "place"
        }
        if isinstance(value, Identity):
            changed["name"] = HOSTILE
        return dataclasses.replace(value, **changed)
    return value


@pytest.fixture(scope="module")
def packages(
    tmcm3230: Device, tmcm6212: Device, io_module: Device, root: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[str, Package]]:
    toy = compile_file(root / "tests" / "golden" / "toy.yaml")
    assert isinstance(toy, Device)
    models = {
        "tmcm3230": tmcm3230,
        "tmcm6212": tmcm6212,
        "io_module": io_module,
        "toy": toy,
        "tiny": tiny_device(io_module),
        "hostile": hostile(tmcm3230),
    }
    yield {
        name: Package(model, tmp_path_factory.mktemp(name), f"package_under_test_{name}")
        for name, model in models.items()
    }
    for name in list(sys.modules):
        if name.startswith("package_under_test_"):
            del sys.modules[name]


@pytest.fixture(scope="module", params=["tmcm3230", "tmcm6212", "io_module", "toy", "tiny", "hostile"])
def package(request: pytest.FixtureRequest, packages: dict[str, Package]) -> Package:
    return packages[request.param]


# ---- every fact of the model is in the package -----------------------------------------------------------------------


def test_every_object(package: Package) -> None:
    model, dictionary = package.model, package.dictionary
    assert list(dictionary) == [item.index for item in model.expanded]
    assert (dictionary.axis_count, dictionary.max_pdo_entries) == (model.axes, model.max_pdo_entries)
    for item in model.expanded:
        obj = dictionary[item.index]
        assert (obj.index, obj.base_index, obj.axis, obj.pdo) == (
            item.index,
            item.object.index,
            item.axis,
            item.object.pdo,
        )
        assert (obj.name, obj.title, obj.parameter_name) == (item.object.name, item.title, item.parameter_name)
        assert (obj.object_type, len(obj.entries)) == (item.object.object_type.value, len(item.entries))
        assert (obj.text, obj.source) == (item.object.text, source_text(item.object.source))
        assert dictionary[item.parameter_name] is obj


def test_every_entry(package: Package) -> None:
    for item in package.model.expanded:
        for expanded, entry in zip(item.entries, package.dictionary[item.index].entries, strict=True):
            check_entry(expanded, entry)


def check_entry(expanded: ExpandedEntry, entry: Any) -> None:
    model = expanded.entry
    assert (entry.sub, entry.index, entry.axis, entry.name) == (model.sub, expanded.index, expanded.axis, model.name)
    assert (entry.type, entry.access, entry.mapping) == (model.type.value, model.access.value, model.mapping.value)
    assert (entry.bit_length, entry.length, entry.constant) == (model.bit_length, model.length, model.constant)
    assert (entry.readable, entry.writable) == (model.access.readable, model.access.writable)
    assert (entry.receivable, entry.transmittable) == (model.mapping.receivable, model.mapping.transmittable)
    assert entry.allowed == (model.allowed.intervals if model.allowed else ())
    assert entry.listed == (model.allowed is not None and model.allowed.listed)
    assert entry.signatures == tuple((signature.name, signature.value) for signature in model.signatures)
    for column in ("writable_in", "stored", "groups", "effect", "role", "hidden_default"):
        assert getattr(entry, column) == getattr(model, column)
    for column in ("refuse_write_on_scan", "repeat", "per_axis", "text"):
        assert getattr(entry, column) == getattr(model, column)
    assert entry.source == source_text(model.source)
    if not entry.parent.is_variable:
        assert (entry.title, entry.parameter_name) == (model.title, model.parameter_name)
    check_default(expanded, entry)
    check_unit(model, entry)
    check_values(model.values, entry.values)
    check_bits(model.bits, entry.bits)


def check_default(expanded: ExpandedEntry, entry: Any) -> None:
    for node_id in (1, 127):
        if expanded.default is None:
            assert entry.default(node_id) is None
            assert not entry.initial(node_id)
            continue
        value = expanded.default.value(node_id)
        if isinstance(value, str) and expanded.entry.type is DataType.OCTET_STRING:
            assert entry.default(node_id) == value.encode()
        else:
            assert entry.default(node_id) == value
        assert entry.decode(entry.encode(entry.initial(node_id))) == entry.default(node_id)


def check_unit(model: Entry, entry: Any) -> None:
    if model.unit is None:
        assert entry.unit is None
        return
    assert entry.unit.scale == Fraction(model.unit.numerator, model.unit.denominator)
    for column in ("name", "symbol", "quantity", "base", "text", "selected_by", "options"):
        assert getattr(entry.unit, column) == getattr(model.unit, column)


def check_values(values: tuple[NamedValue, ...], enumeration: Any) -> None:
    if not values:
        assert enumeration is None
        return
    expected = {value.name.upper(): (value.value, value.text) for value in values}
    assert {name: (int(member), member.text) for name, member in enumeration.__members__.items()} == expected


def check_bits(bits: tuple[Bit, ...], flags: Any) -> None:
    if not bits:
        assert flags is None
        return
    expected = {bit.name.upper(): (bit.low, bit.high, bit.text, bit.supported) for bit in bits}
    actual = {
        name: (member.low, member.high, member.text, member.supported) for name, member in flags.__members__.items()
    }
    assert actual == expected


@pytest.mark.slow
def test_exactly_these_addresses_are_there(package: Package) -> None:
    expected = {(item.index, entry.entry.sub) for item in package.model.expanded for entry in item.entries}
    dictionary = package.dictionary
    found = set()
    for index in range(0x10000):
        obj = dictionary.get(index)
        if obj is not None:
            found |= {(index, sub) for sub in range(256) if sub in obj}
    assert found == expected


def test_every_pdo(package: Package) -> None:
    model = package.model
    axes = range(model.axes) if model.axes else (None,)
    expected = [(pdo.kind, axis, pdo.number) for axis in axes for pdo in model.pdos]
    assert [(pdo.kind, pdo.axis, pdo.number) for pdo in package.dictionary.pdos] == expected
    for pdo in package.dictionary.pdos:
        folded = model.pdos_of(pdo.kind)[pdo.number - 1]  # type: ignore[arg-type]
        assert [entry.full_name for entry in pdo.entries] == [
            mapped.object.name + (f".{mapped.entry.name}" if len(mapped.object.entries) > 1 else "")
            for mapped in folded.map
        ]
        mapping = [entry.index << 16 | entry.sub << 8 | entry.bit_length for entry in pdo.entries]
        assert [pdo.mapping[sub].default() for sub in range(1, len(mapping) + 1)] == mapping
        assert pdo.mapping[0].default() == len(mapping)


def columns(rows: Iterable[Any], names: str) -> list[tuple[Any, ...]]:
    """The named columns of rows of the model or of the package; sources as text."""

    def one(row: Any, name: str) -> Any:
        value = getattr(row, name)
        return source_text(value) if name == "source" and isinstance(value, tuple) else value

    return [tuple(one(row, name) for name in names.split()) for row in rows]


def test_every_row_of_the_tables(package: Package) -> None:
    module, model = package.module, package.model
    machine = module.STATE_MACHINE
    tables = [
        (module.ABORT_CODES.values(), model.abort_codes, "name code title used why source"),
        (
            module.EMERGENCIES,
            model.emergencies,
            "name code title bytes register condition reaction momentary driver_flag cause remedy source per_axis",
        ),
        (machine.states.values(), model.pds_states, "name title mask value power text source"),
        (machine.commands.values(), model.pds_commands, "name title mask value edge text source"),
        (machine.events.values(), model.pds_events, "name title text"),
        (machine.transitions, model.transitions, "number start end by text source"),
        (module.MODES.values(), model.modes, "name code short title bit objects slow_down_ramp text source"),
        (
            module.HOMING_METHODS.values(),
            model.homing_methods,
            "name method title switch direction edge reverse_at index_pulse needs_power text source",
        ),
        (module.RAMP.values(), model.ramp, "name symbol object text source"),
        (module.STORAGE_GROUPS.values(), model.storage_groups.values(), "name title text"),
        (module.NMT_STATES.values(), model.nmt_states, "name code title services text source"),
        (module.NMT_COMMANDS.values(), model.nmt_commands, "name code to title text source"),
        (module.LEDS.values(), model.leds, "name title colour source"),
    ]
    for actual, expected, names in tables:
        assert columns(actual, names) == columns(expected, names)
    assert module.EMERGENCIES.axis_count == model.axes
    for led, folded in zip(module.LEDS.values(), model.leds, strict=True):
        names = "name title steady phases when priority text"
        assert columns(led.patterns, names) == columns(folded.patterns, names)


def test_the_name_plate(package: Package) -> None:
    plate, model = package.module.IDENTITY, package.model
    names = "name title vendor_id product_code revision_number"
    channels = "digital_inputs digital_outputs analog_inputs analog_outputs"
    assert columns([plate], f"{names} {channels}") == columns([model.identity], f"{names} {channels}")
    assert (plate.bit_rates, plate.axes) == (tuple(sorted(model.identity.bit_rates)), model.axes)


def test_bit_rates_ascend_in_whatever_order_the_spec_has_them(io_module: Device, tmp_path: Path) -> None:
    identity = dataclasses.replace(io_module.identity, bit_rates=(500, 1000, 20))
    mixed = Package(dataclasses.replace(io_module, identity=identity), tmp_path, "package_under_test_mixed")
    assert mixed.module.IDENTITY.bit_rates == (20, 500, 1000)


def test_a_node_finds_all_tables_that_it_needs(package: Package) -> None:
    found, module, model = Tables.of(package.module), package.module, package.model
    assert found.identity is module.IDENTITY
    assert found.dictionary is package.dictionary
    assert list(found.nmt_states) == [state.code for state in model.nmt_states]
    assert list(found.nmt_commands) == [command.code for command in model.nmt_commands]
    assert found.error_behaviour == {value: state.code for value, state in model.error_behaviour.items()}
    assert len(found.emergencies) == len(model.emergencies)
    assert list(found.leds) == [led.name for led in model.leds]
    assert list(found.pds_states) == [state.name for state in model.pds_states]
    assert (found.layout, found.storage_groups) == (model.layout, tuple(model.storage_groups))


def test_error_behaviour(package: Package) -> None:
    """As in the model: the value of 1029h, and the code of the state that it leads to."""
    model = package.model
    assert {value: state.code for value, state in model.error_behaviour.items()} == package.module.ERROR_BEHAVIOUR
    assert set(package.module.ERROR_BEHAVIOUR.values()) <= package.module.NMT_STATES.keys()


def test_the_layout_follows_from_the_package(package: Package) -> None:
    """A program that has the package alone can put the stored entries in order, and finds the same CRC-32."""

    def instance(obj: Any) -> tuple[int, int, int]:
        """Its scope, the axis, and the PDO of the axis."""
        scope = ("", "rpdo", "tpdo").index(obj.pdo[:4]) + 1 if obj.pdo or obj.axis is not None else 0
        return scope, obj.axis or 0, obj.number

    lines = [
        f"{obj.index:04X}:{entry.sub:02X} {entry.type} {entry.length} {entry.stored}\n"
        for obj in sorted(package.dictionary.values(), key=lambda obj: (instance(obj), obj.index))
        for entry in obj
        if entry.stored != "never"
    ]
    assert len(lines) == len(package.model.record)
    assert zlib.crc32("".join(lines).encode()) == package.module.LAYOUT


def test_words_of_emergencies(package: Package) -> None:
    module, model = package.module, package.model
    for row in module.EMERGENCIES:
        condition, reaction = module.CONDITIONS[row.condition], module.REACTIONS[row.reaction]
        assert columns([condition], "name scope text") == columns([model.conditions[row.condition]], "name scope text")
        assert columns([reaction], "name title text") == columns([model.reactions[row.reaction]], "name title text")
        bits = [number for number in range(8) if row.register_mask >> number & 1]
        assert bits == sorted(model.register_bits[name].bit for name in row.register)


def test_bits_of_the_words_in_each_mode(package: Package) -> None:
    for mode, found in zip(package.model.modes, package.module.MODES.values(), strict=True):
        check_bits(word_bits(package.model, mode, "controlword"), found.controlword)
        check_bits(word_bits(package.model, mode, "statusword"), found.statusword)


def test_every_recipe(package: Package) -> None:
    expected = {(mode.name, recipe.name): recipe for mode in package.model.modes for recipe in mode.recipes}
    assert set(package.module.RECIPES) == set(expected)
    for key, recipe in package.module.RECIPES.items():
        assert (recipe.mode, recipe.name) == key
        assert columns([recipe], "title text source") == columns([expected[key]], "title text source")
        assert [as_step(step) for step in recipe.steps] == [
            (step.kind, sorted(step.arguments), step.text, step.added) for step in expected[key].steps
        ]


def as_step(step: Any) -> tuple[str, list[tuple[str, Any]], str, str]:
    """A step of the package as the model has it."""
    match step:
        case recipes.Write():
            kind, arguments = "write", list(step.values)
        case recipes.Command():
            kind, arguments = "command", [("command", step.name)]
        case recipes.Expect():
            kind, arguments = "expect", list(step.values)
            arguments += [("state", step.state)] if step.state else []
            arguments += [("status_bit", bit) for bit in step.status_bits]
        case recipes.Wait():
            kind, arguments = "wait", [("milliseconds", step.milliseconds)]
        case recipes.Input():
            kind, arguments = "input", list(step.levels)
    return kind, sorted(arguments), step.text, step.added


def test_recipes_name_entries_that_take_their_values(packages: dict[str, Package]) -> None:
    package = packages["tmcm3230"]
    written = 0
    for recipe in package.module.RECIPES.values():
        for step in recipe.steps:
            if isinstance(step, recipes.Write):
                for name, value in step.values:
                    package.dictionary.entry(name, axis=1).check(value)
                    written += 1
    assert written > 20


def test_every_name_is_an_attribute(package: Package) -> None:
    dictionary: Any = package.dictionary
    for item in package.model.expanded:
        holder = dictionary.device if item.axis is None else dictionary.axes[item.axis]
        found = getattr(holder, item.object.name)
        obj = dictionary[item.index]
        if item.object.pdo:
            found = found[obj.number]
        if item.object.object_type is ObjectType.VAR:
            assert found is obj[0]
        else:
            assert type(found).__name__ == class_name(item.object.name)
            for entry in obj:
                assert getattr(found, entry.name) is entry


def test_version_and_digest_stand_once(package: Package) -> None:
    model = package.model
    assert package.module.__spec_version__ == model.identity.version
    assert package.module.__spec_digest__ == model.digest
    for word in (f'"{model.identity.version}"', f'"{model.digest}"'):
        holders = [path for path in package.folder.rglob("*.py") if word in path.read_text("utf-8")]
        assert [path.name for path in holders] == ["__init__.py"] or model.identity.identifier == "tiny"


def test_public_names(package: Package) -> None:
    public = [name for name in dir(package.module) if not name.startswith("_")]
    assert {"DICTIONARY", "find_emergency", "objects"} <= set(public)
    assert all(getattr(package.module, name) is not None for name in public)
    with pytest.raises(AttributeError, match="has no attribute 'Nothing'"):
        _ = package.module.Nothing


# ---- use -------------------------------------------------------------------------------------------------------------


def test_look_ups_in_the_3230(packages: dict[str, Package]) -> None:
    dictionary: Any = packages["tmcm3230"].dictionary
    assert dictionary[0x6840].label == "controlword of axis 1 (6840h)"
    assert dictionary["Controlword 2"] is dictionary[0x6840] is dictionary.object("controlword", axis=1)
    assert dictionary.axes[2].homing_speeds.fast.index == 0x7099
    assert dictionary.device.identity.vendor_id.default() == 0x286
    assert dictionary.axes[1].rpdo_communication[1].cob_id.index == 0x1440


def test_checks_in_the_3230(packages: dict[str, Package]) -> None:
    dictionary = packages["tmcm3230"].dictionary
    with pytest.raises(ReadOnlyError, match=r"statusword of axis 2 \(7041h\): cannot be written"):
        dictionary.entry("statusword", axis=2).check(0)
    with pytest.raises(OutOfRangeError, match=r"switch_parameters of axis 1 \(2205h\): 64 is not in 0\.\.63"):
        dictionary.entry("switch_parameters", axis=1).check(64)
    with pytest.raises(WrongSignatureError, match=r"store_parameters\.all \(1010h:01\)"):
        dictionary.entry("store_parameters.all").check(1)
    dictionary.entry("store_parameters.all").check(0x65766173)


def test_values_at_the_limits_pass_and_beyond_they_do_not(package: Package) -> None:
    for obj in package.dictionary.values():
        for entry in obj:
            if entry.low is None or entry.high is None or not entry.writable or entry.signatures:
                continue
            entry.check(entry.low)
            entry.check(entry.high)
            for value in (entry.low - 1, entry.high + 1):
                with pytest.raises(OutOfRangeError):
                    entry.check(value)
            assert codec.size(entry.type) == len(entry.encode(entry.high))


def test_emergencies_of_the_3230(packages: dict[str, Package]) -> None:
    find = packages["tmcm3230"].module.find_emergency
    for row in packages["tmcm3230"].model.emergencies:
        for axis in range(3):
            found = find(row.code, bytes(axis if byte == "axis" else byte for byte in row.bytes))
            assert (found.name, found.axis) == (row.name, axis if row.per_axis else None)
    assert find(0x1234, bytes(5)) is None


def test_abort_codes_of_the_3230(packages: dict[str, Package]) -> None:
    module = packages["tmcm3230"].module
    assert module.find_abort_code(0x06090030).name == "invalid_value"
    assert module.find_abort_code(0x06090030).used
    assert module.find_abort_code(1) is None


def test_states_of_the_3230(packages: dict[str, Package]) -> None:
    module = packages["tmcm3230"].module
    for state in packages["tmcm3230"].model.pds_states:
        assert module.decode_state(state.value).name == state.name
        assert module.decode_state(state.value | 0xFFFF & ~state.mask).name == state.name
    route = module.STATE_MACHINE.route("switch_on_disabled", "operation_enabled")
    assert [transition.number for transition in route] == [2, 3, 4]


def test_entries_with_one_table_share_its_class(packages: dict[str, Package]) -> None:
    module = packages["tmcm3230"].module
    assert module.ModesOfOperationDisplay is module.ModesOfOperation
    assert packages["tmcm3230"].dictionary["modes_of_operation_display"][0].values is module.ModesOfOperation


def test_an_entry_may_have_values_and_bits(packages: dict[str, Package]) -> None:
    entry = packages["tiny"].dictionary["both"][0]
    module = packages["tiny"].module
    assert entry.values is module.Both
    assert entry.bits is module.BothBits


def test_a_device_without_axes(packages: dict[str, Package]) -> None:
    package = packages["io_module"]
    assert package.dictionary.axes == ()
    assert all(obj.axis is None for obj in package.dictionary.values())


# ---- names that cannot both be had -----------------------------------------------------------------------------------


def test_declared_classes_are_the_ones_in_the_modules(package: Package) -> None:
    declared = {(item.module, item.name) for item in declared_classes(package.model)}
    declared |= {(module, name) for module, names in RESERVED.items() for name in names}
    for module in ("enums", "flags", "objects"):
        source = (package.folder / package.model.identity.identifier / f"{module}.py").read_text("utf-8")
        found = set()
        for statement in ast.parse(source).body:
            if isinstance(statement, ast.ClassDef):
                found.add(statement.name)
            elif isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Name):
                found |= {target.id for target in statement.targets if isinstance(target, ast.Name)}
        assert found == {name for home, name in declared if home == module}


def test_a_collision_shows_in_the_declared_classes(tmcm3230: Device) -> None:
    obj = tmcm3230.object("statusword")
    assert obj
    other = dataclasses.replace(obj, index=0x6777, name="homing_statusword")
    names = [item.name for item in declared_classes(dataclasses.replace(tmcm3230, objects=(*tmcm3230.objects, other)))]
    assert names.count("HomingStatusword") == 2


# ---- the text of the files -------------------------------------------------------------------------------------------


def outputs(model: Device | Vocabulary) -> list[Output]:
    return PythonBackend().render(model)


def test_files_carry_the_mark(tmcm3230: Device, vocabulary: Vocabulary) -> None:
    for output in (*outputs(tmcm3230), *outputs(vocabulary)):
        first = output.content.decode("utf-8").split("\n", 1)[0]
        assert MARK in first or output.path.endswith("py.typed")


def test_rendering_twice_gives_the_same_bytes(tmcm3230: Device) -> None:
    assert outputs(tmcm3230) == outputs(tmcm3230)


def test_hostile_text_is_nothing_but_text(packages: dict[str, Package]) -> None:
    for path in packages["hostile"].folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Call):
                assert ast.unparse(node.func) in CALLED


CALLED = {
    *("load_on_use", "Dictionary", "StateMachine", "EmergencyTable", "_Variable", "_Sub", "_Group", "_Family"),
    *("Emergency", "AbortCodeInfo", "ConditionInfo", "Named", "PdsStateInfo", "PdsCommandInfo", "Transition", "Unit"),
    *("NmtStateInfo", "NmtCommandInfo", "Led", "LedPattern", "ModeInfo", "HomingMethodInfo", "RampParameter", "Recipe"),
    "Identity",
    *("Write", "Expect", "Wait", "Input", "ABORT_CODES.get", "EMERGENCIES.find", "STATE_MACHINE.decode"),
}
"""All that a generated package calls."""


def ruff(root: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "ruff", arguments[0], "--config", str(root / "pyproject.toml"), *arguments[1:]]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_ruff_has_nothing_to_say(package: Package, vocabulary: Vocabulary, root: Path, tmp_path: Path) -> None:
    folders = [str(package.folder), str(write_package(vocabulary, tmp_path))]
    formatted = ruff(root, "format", "--diff", *folders)
    assert formatted.stdout == ""
    assert formatted.returncode == 0, formatted.stderr
    if package.model.identity.name == HOSTILE:
        return  # ambiguous characters and words longer than a line are what such text has
    checked = ruff(root, "check", *folders)
    assert checked.returncode == 0, checked.stdout


USER_PROGRAM = """
from tmcm3230 import DICTIONARY, ChopperMode, Controlword, HomingMethod, ProfilePositionControlword, SwitchParameters
from tmcm3230 import MODES, RECIPES, STATE_MACHINE, decode_state, find_abort_code, find_emergency
from tmcm3230.objects import AxisObjects


def start(axis: AxisObjects) -> bytes:
    axis.chopper_mode.check(ChopperMode.SPREAD_CYCLE)
    axis.homing_method.check(HomingMethod.NEGATIVE_LIMIT)
    speed: int = axis.homing_speeds.fast.initial()
    cob_id: int = axis.rpdo_communication[1].cob_id.initial(node_id=2)
    switches: SwitchParameters = axis.switch_parameters.decode(bytes(4))
    assert not switches & SwitchParameters.LEFT_LIMIT_OFF, (speed, cob_id)
    word = Controlword.SWITCH_ON | ProfilePositionControlword.NEW_SET_POINT
    return axis.controlword.encode(word)


name: str | None = DICTIONARY.device.device_name.default()
for axis in DICTIONARY.axes:
    print(name, start(axis), axis.profile_velocity.unit, axis.profile_velocity.low)
found = find_emergency(0x8611, bytes((0, 1, 0, 0, 0)))
if found is not None:
    print(found.title, found.cause, found.remedy, found.axis, found.reaction, found.register)
state = decode_state(0x0637)
if state is not None:
    print(state.title, STATE_MACHINE.next_states(state.name), find_abort_code(0x08000022))
for recipe in RECIPES.values():
    print(recipe.title, len(recipe.steps), MODES[1].statusword)
"""

WRONG_PROGRAM = """
from tmcm3230 import DICTIONARY, Nothing

axis = DICTIONARY.axes[0]
axis.controlwrod
axis.homing_speeds.faster
speed: str = axis.homing_speeds.fast.initial()
axis.profile_velocity = 5
"""


def mypy(folders: Iterable[Path], program: Path) -> list[str]:
    """The errors that mypy --strict finds in a program, with the packages in these folders."""
    path = ":".join(str(folder) for folder in folders)
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--no-error-summary",
        "--cache-dir",
        str(program.parent / "cache"),
    ]
    run = subprocess.run(
        [*command, "--config-file", "", str(program)],
        capture_output=True,
        text=True,
        check=False,
        env={"MYPYPATH": path, "PATH": ""},
    )
    assert run.returncode in (0, 1), run.stdout + run.stderr
    return run.stdout.splitlines()


@pytest.mark.slow
def test_types_are_complete(packages: dict[str, Package], vocabulary: Vocabulary, root: Path, tmp_path: Path) -> None:
    folders = [root / "runtime_py", write_package(vocabulary, tmp_path), packages["tmcm3230"].folder]
    program = tmp_path / "program.py"
    imports = "".join(f"import tmcm3230.{path.stem}\n" for path in (folders[2] / "tmcm3230").glob("[a-z]*.py"))
    imports += "".join(f"import odsmith_cia.{path.stem}\n" for path in (folders[1] / "odsmith_cia").glob("[a-z]*.py"))
    program.write_text(imports + USER_PROGRAM, encoding="utf-8")
    assert mypy(folders, program) == []
    program.write_text(WRONG_PROGRAM, encoding="utf-8")
    errors = mypy(folders, program)
    assert [int(line.split(":")[1]) for line in errors if ": error:" in line] == [2, 5, 6, 7, 8]


@pytest.mark.slow
def test_the_program_runs(packages: dict[str, Package], root: Path) -> None:
    path = [str(root / "runtime_py"), str(packages["tmcm3230"].folder)]
    script = f"import sys; sys.path[:0] = {path!r}\n{USER_PROGRAM}"
    run = subprocess.run([sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "Following error" in run.stdout


def test_the_readme_runs(package: Package, root: Path) -> None:
    readme = (package.folder / "README.md").read_text("utf-8")
    code = readme.split("```python\n")[1].split("```")[0]
    script = f"import sys; sys.path[:0] = {[str(root / 'runtime_py'), str(package.folder)]!r}\n{code}"
    run = subprocess.run([sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout


# ---- import ----------------------------------------------------------------------------------------------------------


def test_the_import_loads_four_modules_and_makes_no_enumeration(packages: dict[str, Package], root: Path) -> None:
    path = [str(root / "runtime_py"), str(packages["tmcm3230"].folder)]
    script = f"""
import sys
sys.path[:0] = {path!r}
before = set(sys.modules)
from tmcm3230 import DICTIONARY
print(*sorted(set(sys.modules) - before))
DICTIONARY[0x6840][0].check(15)
print(*sorted(set(sys.modules) & {{"enum", "dataclasses", "typing", "fractions", "struct", "tmcm3230.enums"}}))
from tmcm3230 import ChopperMode
print("enum" in sys.modules, "tmcm3230.flags" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True, check=True)
    modules, heavy, enumerations = run.stdout.splitlines()
    assert modules.split() == ["odsmith_runtime", "odsmith_runtime.dictionary", "tmcm3230", "tmcm3230.dictionary"]
    assert heavy == ""
    assert enumerations == "True False"


@pytest.mark.slow
def test_the_import_works_twenty_times_less_than_reading_the_eds(
    packages: dict[str, Package], tmcm3230: Device, root: Path, tmp_path: Path
) -> None:
    """Counted in calls of functions, which do not depend on the machine; `make bench` tells the time."""
    pytest.importorskip("canopen")
    eds = next(output for output in EdsBackend().render(tmcm3230) if output.path.endswith(".eds"))
    (tmp_path / "device.eds").write_bytes(eds.content)
    path = [str(root / "runtime_py"), str(packages["tmcm3230"].folder)]

    def calls(before: str, code: str) -> int:
        script = f"""
import sys
{before}
calls = 0
def count(frame, event, argument):
    global calls
    calls += event in ("call", "c_call")
sys.setprofile(count)
{code}
sys.setprofile(None)
print(calls)
"""
        run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
        return int(run.stdout)

    ours = f"sys.path[:0] = {path!r}", "from tmcm3230 import DICTIONARY"
    theirs = "import canopen", f"canopen.import_od({str(tmp_path / 'device.eds')!r}, 1)"
    calls(*ours)  # compiles the package
    assert calls(*theirs) / calls(*ours) >= 20


# ---- the vocabulary --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cia(vocabulary: Vocabulary, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    folder = write_package(vocabulary, tmp_path_factory.mktemp("cia"))
    yield load_package(folder, "odsmith_cia", "package_under_test_cia")
    for name in list(sys.modules):
        if name.startswith("package_under_test_cia"):
            del sys.modules[name]


def test_codes_of_the_standards(cia: Any, vocabulary: Vocabulary) -> None:
    tables: list[tuple[Any, Iterable[Any], str, str]] = [
        (cia.AbortCode, vocabulary.abort_codes, "code", "title"),
        (cia.ModeCode, vocabulary.mode_codes, "code", "title"),
        (cia.NmtState, vocabulary.nmt_states, "code", "text"),
        (cia.NmtCommand, vocabulary.nmt_commands, "code", "text"),
        (cia.Signature, vocabulary.signatures.values(), "value", "text"),
    ]
    for enumeration, rows, value, text in tables:
        members = [(member.name.lower(), member.value, member.text) for member in enumeration]
        assert members == [(row.name, getattr(row, value), getattr(row, text)) for row in rows]
    for bit in vocabulary.register_bits.values():
        assert (cia.ErrorRegister[bit.name.upper()].low, cia.ErrorRegister[bit.name.upper()].text) == (
            bit.bit,
            bit.text,
        )


def test_words_of_the_standards(cia: Any, vocabulary: Vocabulary) -> None:
    tables: list[tuple[Any, Iterable[Any]]] = [
        (cia.Condition, vocabulary.conditions.values()),
        (cia.Effect, vocabulary.effects.values()),
        (cia.PdsCommand, vocabulary.pds_commands),
        (cia.PdsEvent, vocabulary.pds_events),
        (cia.PdsState, vocabulary.pds_states),
        (cia.Reaction, vocabulary.reactions.values()),
    ]
    for words, rows in tables:
        assert [(word.value, word.text) for word in words] == [(row.name, row.text) for row in rows]
    assert [word for word in cia.Effect if word.to_driver] == [
        row.name for row in vocabulary.effects.values() if row.to_driver
    ]


def test_tables_of_the_standards(cia: Any, vocabulary: Vocabulary) -> None:
    machine = cia.STATE_MACHINE
    assert columns(machine.states.values(), "name mask value power") == columns(
        vocabulary.pds_states, "name mask value power"
    )
    assert columns(machine.transitions, "number start end by") == columns(vocabulary.transitions, "number start end by")
    assert columns(cia.ROLES.values(), "name scope count length text") == columns(
        vocabulary.roles.values(), "name scope count length text"
    )
    assert [role.type for role in cia.ROLES.values()] == [role.type.value for role in vocabulary.roles.values()]
    assert columns(cia.UNITS.values(), "name symbol numerator denominator options") == columns(
        vocabulary.units.values(), "name symbol numerator denominator options"
    )
    assert columns(cia.CONDITIONS.values(), "name scope text") == columns(
        vocabulary.conditions.values(), "name scope text"
    )
    assert list(cia.REACTIONS) == list(vocabulary.reactions)
    assert list(cia.LEDS) == [led.name for led in vocabulary.leds]
    assert cia.__spec_digest__ == vocabulary.digest


STRUCTS = {"device": "DeviceValues", "axis": "AxisValues", "pdo": "PdoValues"}


def test_values_are_those_of_the_structs_in_c(cia: Any, vocabulary: Vocabulary) -> None:
    """The same names with as many elements; only the mapping of a PDO stands outside the struct."""
    header = next(item.content.decode() for item in CBackend().render(vocabulary) if item.path.endswith("/values.h"))
    for scope, name in STRUCTS.items():
        body = re.search(rf"typedef struct {{([^}}]*)}} ods_{scope}_values_t;", header)
        assert body
        fields = re.findall(r"^    \w+ (\w+)(?:\[(\d+)\])?;", body[1], re.MULTILINE)
        expected = {field: int(length or 0) for field, length in fields} | (
            {"pdo_mapping": 8} if scope == "pdo" else {}
        )
        values = getattr(cia, name)()
        found = {field: getattr(values, field) for field in values.__slots__}
        assert {field: 0 if type(zero) is int else len(zero) for field, zero in found.items()} == expected


def test_values_are_zeros_of_the_types_of_their_roles(cia: Any, vocabulary: Vocabulary) -> None:
    held = {scope: getattr(cia.values, name) for scope, name in STRUCTS.items()}
    roles = {scope: [role for role in vocabulary.roles.values() if role.scope == scope] for scope in held}
    for scope, holder in held.items():
        assert holder is getattr(cia, STRUCTS[scope])
        assert holder.__slots__ == {role.name: role.text for role in roles[scope]}
        values = holder()
        for role in roles[scope]:
            zero = bytes(role.length) if role.type.string else [0] * role.count if role.count > 1 else 0
            value = getattr(values, role.name)
            assert (type(value), value) == (type(zero), zero)
        with pytest.raises(AttributeError):
            values.nothing = 1


def test_values_begin_anew_with_another_init(cia: Any) -> None:
    values, other = cia.DeviceValues(), cia.DeviceValues()
    values.node_id, values.os_command = 5, b"command"
    values.analog_inputs[7] = 9
    assert other.analog_inputs == [0] * 8
    values.__init__()
    assert (values.node_id, values.os_command, values.analog_inputs) == (0, bytes(7), [0] * 8)


def test_values_of_any_type(vocabulary: Vocabulary, root: Path, tmp_path: Path) -> None:
    """Every kind of role alone in its scope, and a scope that has none."""
    roles = (
        Role("torque", "axis", DataType.REAL32, HOSTILE),
        Role("flag", "axis", DataType.BOOLEAN, "A flag."),
        Role("a10", "axis", DataType.INTEGER8, "Sorts behind a9.", count=2),
        Role("area", "axis", DataType.UNSIGNED64, "Sorts behind a10."),
        Role("a9", "axis", DataType.DOMAIN, "Octets.", length=3),
    )
    bare = dataclasses.replace(vocabulary, roles={role.name: role for role in roles})
    folder = write_package(bare, tmp_path)
    values = load_package(folder, "odsmith_cia", "package_under_test_bare").values
    axis = values.AxisValues()
    assert list(axis.__slots__) == ["a9", "a10", "area", "flag", "torque"]
    assert (axis.torque, axis.flag, axis.a10, axis.a9) == (0, 0, [0, 0], bytes(3))
    assert values.DeviceValues().__slots__ == values.PdoValues().__slots__ == ()
    for name in ("package_under_test_bare", "package_under_test_bare.values"):
        del sys.modules[name]
    module = str(folder / "odsmith_cia" / "values.py")
    formatted = ruff(root, "format", "--diff", module)
    assert (formatted.stdout, formatted.returncode) == ("", 0)
    sorting = ruff(root, "check", "--select", "RUF023", module)
    assert sorting.returncode == 0, sorting.stdout
