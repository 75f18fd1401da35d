"""The TMCM-6212 is modelled whole: what its contents list and the vendor's EDS count, the model has."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from odsmith.compile import compile_spec
from odsmith.model import Default, Device, Entry, ExpandedObject, HomingMethod, Object

CONTENTS = {
    "3": "1000 1001 1005 1008 1009 100A 100C 100D 1010 1011 1014 1015 1016 1017 1018 1023 1029 1400 1600 1800 1A00",
    "4": (
        "2000 2001 2002 2003 2004 2005 200A 200B 200C 200F 2010 2011 2012 2013 2015 2089 208C 208E 2092 2093 2094 2095"
        " 2096 2097 2098 2099 209A 209B 209C 209D 209E 20A1 20A3 20A4 20A5 20B0 20B1 20B2 20B3 20B4 20B5 20B6 20B7 20B8"
        " 20B9 2100 2101 2102 2107 210B 2121 2122 3000 3001 3002 3003 3004 3005 3006 3007 3008 300E"
    ),
    "5": "605A 605B 605C 605D 605E 6060 6061 606A 608F 60FD 6502",
    "6": "6040 6041 6062 6063 6064 6065 6067 6068 606C 607A 607D 6081 6082 6083 6084 6085 60F2",
    "7": "6040 6041 6062 6063 6064 6065 606C 607D 6083 6085 60FF",
    "8": "6040 6041 606C 607C 6098 6099 609A",
    "9": "6040 6041 6062 6063 6064 606C 607A 607D 60B0 60C2",
    "10": "6040 6041 606C 60FF 607D 60B1 60C2",
}
"""The objects that have a section of their own in the manual, by chapter."""

VENDOR_ONLY = "20A2 3009 300B 300C 300F 67FF"
"""The objects that only the vendor's EDS has."""


def indices(text: str) -> list[int]:
    return [int(index, 16) for index in text.split()]


def by_index(device: Device) -> dict[int, Object]:
    return {obj.index: obj for obj in device.objects}


def entry(device: Device, index: int, sub: int = 0) -> Entry:
    found = by_index(device)[index].entry(sub)
    assert found
    return found


# ---- what exists -----------------------------------------------------------------------------------------------------


def test_every_section_of_the_contents_list_is_modelled(tmcm6212: Device) -> None:
    """146 sections about 119 objects; six more objects are those that only the vendor's EDS has."""
    sections = [index for chapter in CONTENTS.values() for index in indices(chapter)]
    assert (len(sections), len(set(sections))) == (146, 119)
    assert set(by_index(tmcm6212)) == {*sections, *indices(VENDOR_ONLY)}


def test_modes_use_the_objects_of_their_chapters(tmcm6212: Device) -> None:
    modes = {mode.short: {obj.index for obj in objects_of(tmcm6212, mode.objects)} for mode in tmcm6212.modes}
    chapters = {"pp": "6", "pv": "7", "hm": "8", "csp": "9", "csv": "10"}
    assert {short: modes[short] for short in chapters} == {
        short: set(indices(CONTENTS[chapter])) for short, chapter in chapters.items()
    }


def objects_of(device: Device, names: tuple[str, ...]) -> Iterator[Object]:
    for name in names:
        obj = device.object(name)
        assert obj
        yield obj


def test_the_dictionary_is_as_large_as_the_vendors(tmcm6212: Device) -> None:
    """667 objects with 1152 entries; 31 are there once, 106 for each axis."""
    axes = [[item for item in tmcm6212.expanded if item.axis == axis] for axis in (None, *range(6))]
    assert [len(items) for items in axes] == [31, 106, 106, 106, 106, 106, 106]
    assert sum(len(item.entries) for item in tmcm6212.expanded) == 1152


def test_sources_of_what_only_the_vendors_eds_has(tmcm6212: Device) -> None:
    for index in indices(VENDOR_ONLY):
        assert "vendor_eds" in {source.kind for source in by_index(tmcm6212)[index].source}
        assert "manual" not in {source.kind for source in by_index(tmcm6212)[index].source}


def test_every_element_has_a_source(tmcm6212: Device) -> None:
    sections = (
        tmcm6212.objects, tmcm6212.pdos, tmcm6212.modes, tmcm6212.homing_methods, tmcm6212.ramp, tmcm6212.emergencies,
        tmcm6212.errata, tmcm6212.abort_codes, tmcm6212.nmt_states, tmcm6212.nmt_commands, tmcm6212.leds,
        tmcm6212.pds_states, tmcm6212.pds_commands, tmcm6212.transitions,
    )  # fmt: skip
    for section in sections:
        assert section
        for element in section:
            assert element.source, element


def test_every_device_compiles_without_a_warning(root: Path) -> None:
    for path in (root / "spec").glob("*.yaml"):
        assert compile_spec(path).warnings == (), path


# ---- axes ------------------------------------------------------------------------------------------------------------

STRIDES = {0x1: 0x40, 0x2: 0x200, 0x6: 0x800}


def of_axis(device: Device, axis: int) -> list[ExpandedObject]:
    return [item for item in device.expanded if item.axis == axis]


@pytest.mark.parametrize("axis", range(1, 6))
def test_every_axis_is_like_the_first_one(tmcm6212: Device, axis: int) -> None:
    """But for its indices, the suffix of its names, and COB-IDs and mappings of its PDOs."""
    for first, other in zip(of_axis(tmcm6212, 0), of_axis(tmcm6212, axis), strict=True):
        stride = STRIDES[first.index >> 12]
        assert other.index == first.index + axis * stride
        assert other.object is first.object
        if first.number:
            assert other.number == first.number + 64 * axis
        else:
            assert first.parameter_name.endswith(" 1")
            assert other.parameter_name == f"{first.parameter_name[:-2]} {axis + 1}"
        for one, same in zip(first.entries, other.entries, strict=True):
            assert same.entry is one.entry
            if one.entry.role == "pdo_cob_id":
                assert same.default == Default(0xC0000000)
            elif one.entry.role == "pdo_mapping":
                assert one.default
                mapped = one.default.number
                assert same.default == Default(mapped + (axis * 0x800 << 16) if mapped else 0)
            else:
                assert same.default == one.default


def test_the_last_axis_ends_where_the_profile_area_does(tmcm6212: Device) -> None:
    last = {item.index for item in of_axis(tmcm6212, 5)}
    assert max(last) == 0x8FFF
    assert {0x2A00, 0x2B22, 0x8840, 0x1540, 0x1743, 0x1943, 0x1B43} <= last
    assert all(0x1400 <= index < 0x1C00 or 0x2A00 <= index < 0x2C00 or 0x8800 <= index < 0x9000 for index in last)


def test_pdos(tmcm6212: Device) -> None:
    """24 RPDOs and 24 TPDOs; those of axis 0 are active, the others have prefilled mappings."""
    numbers = [64 * axis + number for axis in range(6) for number in (1, 2, 3, 4)]
    assert numbers[-4:] == [321, 322, 323, 324]
    for pdo, base in (("rpdo", 0x200), ("tpdo", 0x180)):
        found = [item for item in tmcm6212.expanded if item.object.pdo == f"{pdo}_communication"]
        assert [item.number for item in found] == numbers
        active = [Default(0x40000000 + base + 0x100 * i, node_id=True) for i in range(4)]
        assert [item.entries[1].default for item in found] == active + 20 * [Default(0xC0000000)]
        synchronous = [item.number for item in found if item.entries[2].default == Default(1)]
        assert synchronous == ([3, 67, 131, 195, 259, 323] if pdo == "tpdo" else [])
    mapping = {item.index: [part.default for part in item.entries] for item in tmcm6212.expanded}
    assert mapping[0x1742] == [Default(2), Default(0x88400010), Default(0x887A0020), Default(0)]
    assert mapping[0x1B43] == [Default(2), Default(0x88410010), Default(0x886C0020), Default(0)]


def test_names_of_the_vendors_eds(tmcm6212: Device) -> None:
    """A program that looks objects up by the vendor's names finds them; misprints are corrected."""
    names = {item.parameter_name: item.index for item in tmcm6212.expanded}
    for name, index in (
        ("Controlword 1", 0x6040),
        ("Controlword 6", 0x8840),
        ("Profile Velocity in pp-mode 1", 0x6081),
        ("Switch Parameters 1", 0x2005),
        ("Absolute Max Current 2", 0x2203),
        ("Encoder N Channel Latch 1", 0x200F),
        ("End Velocity 1", 0x6082),
        ("Target Velocity 2", 0x68FF),
        ("Positioning Option Code 4", 0x78F2),
        ("Device Analog Inputs", 0x300E),
        ("PDO Disabling", 0x3001),
        ("Single Device Type 6", 0x8FFF),
        ("RPDO 321 Communication Parameter", 0x1540),
        ("TPDO 324 Mapping Parameter", 0x1B43),
    ):
        assert names[name] == index
    subs = [part.parameter_name for part in by_index(tmcm6212)[0x200F].entries]
    assert subs[1:] == ["mode", "latchedInternalPosition", "latchedEncoderPosition"]
    assert [part.parameter_name for part in by_index(tmcm6212)[0x300E].entries][1:] == [f"AIN{i}" for i in range(8)]


# ---- what is special about this module -------------------------------------------------------------------------------


def test_identity(tmcm6212: Device) -> None:
    identity = tmcm6212.identity
    assert [part.parameter_name for part in by_index(tmcm6212)[0x1018].entries][1:] == [
        "Vendor Id", "Product Code", "Revision number", "Serial number",
    ]  # fmt: skip
    assert [entry(tmcm6212, 0x1018, sub).default for sub in (0, 1, 2, 3, 4)] == [
        Default(4), Default(identity.vendor_id), Default(6212), Default(0x00030018), None,
    ]  # fmt: skip
    assert (identity.product_code, identity.revision_number) == (6212, 0x00030018)
    assert entry(tmcm6212, 0x1008).default == Default(text="TMCM-6212")
    assert entry(tmcm6212, 0x1000).default == Default(0xFFFC0192)


def test_what_ten_sub_indices_save_and_restore(tmcm6212: Device) -> None:
    axis = ("motor", "profile")
    saved = [entry(tmcm6212, 0x1010, sub) for sub in range(1, 11)]
    assert [part.groups for part in saved] == [
        ("communication", "bus", "motor", "profile", "device"), ("bus",), ("profile",), *6 * [axis], ("device",),
    ]  # fmt: skip
    restored = [entry(tmcm6212, 0x1011, sub) for sub in range(1, 11)]
    assert [part.groups for part in restored] == [
        ("communication", "motor", "profile", "device"), (), ("profile",), *6 * [axis], ("device",),
    ]  # fmt: skip
    for parts in (saved, restored):
        assert [part.per_axis for part in parts] == [False, False, False, *6 * [True], False]
        assert [part.repeat for part in parts[3:9]] == list(range(6))
        assert all(part.hidden_default and part.refuse_write_on_scan for part in parts)
    assert [part.default for part in restored] == [Default(1), Default(0), *8 * [Default(1)]]
    assert {obj.index for obj in tmcm6212.objects for part in obj.entries if part.stored == "device"} == {
        0x3009, 0x300F,
    }  # fmt: skip


def test_inputs_and_outputs(tmcm6212: Device) -> None:
    """Four of each, at bits 16 to 19; eight analog channels, of which PDOs carry the first four."""
    for index, sub in ((0x3002, 0), (0x3003, 1), (0x3003, 2)):
        assert [bit.low for bit in entry(tmcm6212, index, sub).bits] == [16, 17, 18, 19]
    assert [bit.label for bit in entry(tmcm6212, 0x60FD).bits] == ["0", "1", "2", "16..19"]
    channels = [entry(tmcm6212, 0x300E, sub) for sub in range(1, 9)]
    assert [part.mapping.transmittable for part in channels] == 4 * [True] + 4 * [False]
    assert [part.repeat for part in channels] == list(range(8))
    assert {part.role for part in channels} == {"analog_inputs"}
    assert {(part.allowed.low, part.allowed.high) for part in channels if part.allowed} == {(0, 65535)}


def test_homing_methods(tmcm6212: Device, tmcm3230: Device) -> None:
    """Those of the family, and with an index pulse behind it each search that the family knows without one."""
    methods = {method.method: method for method in tmcm6212.homing_methods}
    assert sorted(methods) == [0, 1, 2, 3, 5, 17, 18, 19, 21, 33, 34, 35]
    assert [number for number, method in methods.items() if method.index_pulse] == [1, 2, 3, 5, 33, 34]
    assert [value.value for value in entry(tmcm6212, 0x6098).values] == sorted(methods)
    for with_index, without in ((1, 17), (2, 18), (3, 19), (5, 21)):
        assert search(methods[with_index]) == search(methods[without])
    assert [(methods[n].switch, methods[n].direction, methods[n].edge) for n in (33, 34)] == [
        ("none", -1, -1),
        ("none", 1, 1),
    ]
    family = {method.method: method for method in tmcm3230.homing_methods}
    assert family == {number: methods[number] for number in family}


def search(method: HomingMethod) -> tuple[str, int, int, str, bool]:
    """How the switch is looked for."""
    return method.switch, method.direction, method.edge, method.reverse_at, method.needs_power


def test_encoder(tmcm6212: Device) -> None:
    """Nothing is made up: no limits but those of a type, no default but those of the vendor's EDS."""
    roles = {
        (0x200B, 1): "encoder_polarity",
        (0x200B, 2): "encoder_direction",
        (0x200B, 3): "encoder_init_position",
        (0x200F, 1): "encoder_latch_mode",
        (0x200F, 2): "latched_internal_position",
        (0x200F, 3): "latched_encoder_position",
        (0x606A, 0): "sensor_selection_code",
        (0x608F, 1): "encoder_increments",
        (0x608F, 2): "encoder_motor_revolutions",
        (0x2001, 0): "fullstep_resolution",
    }
    assert {place: entry(tmcm6212, *place).role for place in roles} == roles
    stated = {(0x200F, 1): 0, (0x200F, 2): 0, (0x200F, 3): 0, (0x608F, 2): 1, (0x2001, 0): 200}
    for place in roles:
        found = entry(tmcm6212, *place)
        assert found.default == (Default(stated[place]) if place in stated else None)
        assert found.allowed is None or (found.allowed.low, found.allowed.high) == (found.type.low, found.type.high)
        assert found.mapping == "no"
        if found.access.writable:
            assert found.effect in ("encoder_parameter", "encoder_latch")
    assert all(
        "inferred" in {source.kind for source in by_index(tmcm6212)[index].source}
        for index in (0x200B, 0x200F, 0x606A, 0x608F)
    )


def test_a_module_without_encoder_has_none_of_its_roles(tmcm3230: Device) -> None:
    roles = {part.role for obj in tmcm3230.objects for part in obj.entries}
    assert not {role for role in roles if "encoder" in role or "latched" in role or role == "fullstep_resolution"}


# ---- errata ----------------------------------------------------------------------------------------------------------


def test_errata_of_one_device_do_not_show_at_the_other(tmcm3230: Device, tmcm6212: Device) -> None:
    ids = [{erratum.id for erratum in device.errata} for device in (tmcm3230, tmcm6212)]
    assert ids[0] - ids[1] == {"E32", "E37", "E86", "E136"}
    assert ids[1] - ids[0] == {f"E{number}" for number in range(137, 155)}
    shared = {erratum.id: erratum for erratum in tmcm3230.errata}
    assert all(erratum == shared.get(erratum.id, erratum) for erratum in tmcm6212.errata)


def test_differences_from_the_vendors_eds(tmcm6212: Device) -> None:
    """Each is an erratum that says what the vendor's EDS says."""
    vendor = {erratum.id: dict(erratum.vendor) for erratum in tmcm6212.errata if erratum.vendor}
    assert {fact for facts in vendor.values() for fact in facts} == {
        "name", "access", "mapping", "default", "limits", "flags",
    }  # fmt: skip
    assert vendor["E41"] == {"default": "FF7C0192h"}
    assert vendor["E113"] == {"default": "0"}
    assert vendor["E148"] == {"name": "Enoder N Channel Latch"}
    assert vendor["E150"] == {"limits": "none"}


def test_defaults_that_the_vendors_eds_leaves_out(tmcm6212: Device) -> None:
    """Each is one that we state."""
    paths = next(erratum.paths for erratum in tmcm6212.errata if erratum.id == "E151")
    for path in paths:
        _, name, *sub, fact = path.split(".")
        (obj,) = objects_of(tmcm6212, (name,))
        assert fact == "default"
        assert entry(tmcm6212, obj.index, int(sub[1]) if sub else 0).eds_default, path
