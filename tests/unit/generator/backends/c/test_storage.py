"""Where values live in C."""

from __future__ import annotations

from dataclasses import replace

import pytest

from odsmith.backends.c.storage import Field, Location, Storage, by_size, is_constant, role_field, sized_by_device
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection
from odsmith.model import Allowed, Default, Device, Entry, Object
from odsmith.vocabulary import Role, Signature

ENTRY = Entry(
    sub=0,
    name="thing",
    title="Thing",
    parameter_name="Thing",
    type=DataType.UNSIGNED16,
    access=Access.RW,
    mapping=PdoDirection.NO,
    default=None,
    text="",
    effect="value",
)


def thing(*entries: Entry, **changes: object) -> Object:
    base = Object(0x2000, "thing", "Thing", "Thing", ObjectType.RECORD, entries or (ENTRY,), "", ())
    return replace(base, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "constant"),
    [
        pytest.param({}, False, id="a parameter"),
        pytest.param({"access": Access.RO, "effect": ""}, True, id="read-only"),
        pytest.param({"access": Access.CONST, "effect": ""}, True, id="const"),
        pytest.param(
            {"access": Access.RO, "effect": "", "role": "node_id"}, False, id="read-only, but a role moves it"
        ),
        pytest.param(
            {"access": Access.RO, "effect": "", "default": Default(0x600, True)}, False, id="with the node-ID"
        ),
        pytest.param({"signatures": (Signature("save", 0x65766173, ""),)}, True, id="a command keeps nothing"),
        pytest.param({"access": Access.WO}, True, id="never read back"),
        pytest.param({"access": Access.WO, "type": DataType.DOMAIN, "length": 9}, False, id="comes in piece by piece"),
        pytest.param({"access": Access.WO, "stored": "motor"}, False, id="what is stored has to be somewhere"),
        pytest.param({"allowed": Allowed(((2, 2),), listed=True), "default": Default(2)}, True, id="one allowed value"),
        pytest.param(
            {"allowed": Allowed(((2, 2),), listed=True), "default": Default(1)},
            False,
            id="one allowed value, another now",
        ),
        pytest.param(
            {"allowed": Allowed(((2, 3),), listed=False), "default": Default(2)}, False, id="two allowed values"
        ),
    ],
)
def test_what_needs_no_memory(changes: dict[str, object], constant: bool) -> None:
    assert is_constant(replace(ENTRY, **changes)) is constant  # type: ignore[arg-type]


def test_fields_are_ordered_by_size() -> None:
    """The largest first, so that no compiler has to leave a hole; otherwise as the vocabulary has them."""
    sizes = {"a": 1, "b": 4, "c": 2, "d": 8, "e": 1, "f": 4}
    fields = by_size(Field("", name, 0, size, "") for name, size in sizes.items())
    assert [field.name for field in fields] == ["d", "b", "f", "c", "a", "e"]


def test_role_fields() -> None:
    assert role_field(Role("r", "axis", DataType.INTEGER16, "")).declarator == "r"
    assert role_field(Role("r", "device", DataType.UNSIGNED32, "", count=4)).declarator == "r[4]"
    octets = role_field(Role("r", "device", DataType.OCTET_STRING, "", length=7))
    assert (octets.type, octets.declarator) == ("uint8_t", "r[7]")


def test_locations(io_module: Device) -> None:
    roles = {
        "single": Role("single", "device", DataType.UNSIGNED16, ""),
        "many": Role("many", "device", DataType.UNSIGNED16, "", count=4),
        "mapped": Role("mapped", "pdo", DataType.UNSIGNED16, "", count=8),
    }
    first = replace(ENTRY, sub=1, name="first")
    plain = thing(first)
    pdo = thing(replace(ENTRY, role="mapped", repeat=2), name="rpdo_mapping", pdo="rpdo_mapping")
    storage = Storage(replace(io_module, roles=roles, objects=(plain, pdo)))

    assert storage.location(thing(), ENTRY) == Location("device", ("thing",))
    assert storage.location(plain, first) == Location("device", ("thing_first",))
    assert storage.location(plain, replace(first, access=Access.RO)) is None
    assert storage.location(plain, replace(first, role="single")) == Location("device", ("common", "single"))
    assert storage.location(plain, replace(first, role="many", repeat=3)) == Location("device", ("common", "many"), 3)
    assert storage.location(pdo, pdo.entries[0]) == Location("pdo", ("mapped",), 2)
    assert Location("device", ("common", "many"), 3).designator == "common.many[3]"


def test_the_device_sizes_the_mapping_of_its_pdos(io_module: Device) -> None:
    """The vocabulary says how many there can be at most; a struct of values has as many as the device uses."""
    assert [role.name for role in io_module.roles.values() if sized_by_device(role)] == ["pdo_mapping"]
    (mapping, *_) = Storage(io_module).own_fields("pdo")
    assert mapping.declarator == f"pdo_mapping[{io_module.max_pdo_entries}]"


def test_each_variable_has_a_place_of_its_own(tmcm3230: Device) -> None:
    """No two entries of a struct share a field, and each field without a role belongs to an entry."""
    storage = Storage(tmcm3230)
    places = [
        (obj.pdo[:4], location.struct, location.designator)
        for obj in tmcm3230.objects
        for entry in obj.entries
        if (location := storage.location(obj, entry))
    ]
    assert len(places) == len(set(places))
    own = {field.name for struct in storage.structs for field in storage.own_fields(struct)}
    assert own == {name.partition("[")[0] for _, _, name in places if not name.startswith("common.")}
