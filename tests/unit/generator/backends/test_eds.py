"""The EDS backend, rule by rule, on devices of one or two objects."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.canopen_types import Access, DataType, ObjectType, PdoDirection, Source
from odsmith.model import Allowed, Default, Device, EdsInfo, Entry, Identity, NamedValue, Object, Pdo, PdoMapEntry
from odsmith.render import MARK
from odsmith.vocabulary import Signature

EDS = EdsInfo(
    file="Toy-1.eds",
    version=1,
    revision=7,
    description="A toy",
    created_by="odsmith",
    creation_date="11-22-2026",
    creation_time="09:00AM",
    modified_by="somebody",
    modification_date="12-24-2026",
    modification_time="05:30PM",
)
IDENTITY = Identity(
    identifier="toy1",
    name="Toy-1",
    title="A toy",
    text="",
    version="1.2.3",
    vendor="Toys Ltd",
    vendor_id=0x286,
    product_code=3230,
    revision_number=0x00030016,
    order_code="T-1",
    profile=402,
    manual="",
    bit_rates=(20, 125, 1000),
    digital_inputs=0,
    digital_outputs=0,
    analog_inputs=0,
    analog_outputs=0,
    eds=EDS,
)
EMPTY: dict[str, Any] = {
    **{word: {} for word in ["roles", "effects", "conditions", "reactions", "register_bits", "signatures", "units"]},
    **dict.fromkeys(["abort_codes", "nmt_states", "nmt_commands", "leds", "mode_codes", "transitions"], ()),
    **dict.fromkeys(["pds_states", "pds_commands", "pds_events"], ()),
    **dict.fromkeys(["areas", "modes", "homing_methods", "ramp", "emergencies", "errata"], ()),
    "storage_groups": {},
}


def device(*objects: Object, axes: int = 1, pdos: tuple[Pdo, ...] = (), **identity: Any) -> Device:
    return Device(
        identifier="toy1",
        title="A toy",
        digest="0123abcd",
        identity=replace(IDENTITY, **identity),
        axes=axes,
        objects=objects,
        pdos=pdos,
        max_pdo_entries=3,
        **EMPTY,
    )


def entry(sub: int = 0, **fields: Any) -> Entry:
    given: dict[str, Any] = {
        "name": f"entry_{sub}",
        "title": f"Entry {sub}",
        "parameter_name": f"Entry {sub}",
        "type": DataType.UNSIGNED8,
        "access": Access.RW,
        "mapping": PdoDirection.NO,
        "default": None,
        "text": "",
    }
    return Entry(sub=sub, **{**given, **fields})


def variable(index: int = 0x2000, name: str = "Thing", stride: int = 0, **fields: Any) -> Object:
    return compound(index, entry(**fields), name=name, object_type=ObjectType.VAR, stride=stride)


def compound(index: int, *entries: Entry, **fields: Any) -> Object:
    given: dict[str, Any] = {
        "name": f"object_{index:x}",
        "title": "A thing",
        "parameter_name": fields.pop("name", "Thing"),
        "object_type": ObjectType.RECORD,
        "text": "",
        "source": (Source("inferred", note="a toy"),),
    }
    return Object(index=index, entries=entries, **{**given, **fields})


def render(model: Device) -> str:
    (output,) = EdsBackend().render(model)
    return output.content.decode("ascii")


def sections(model: Device) -> dict[str, dict[str, str]]:
    """The file as a strict reader sees it: no line but sections, keys with one equals sign, and blank lines."""
    found: dict[str, dict[str, str]] = {}
    for line in render(model).split("\r\n"):
        if line.startswith("["):
            assert line.endswith("]")
            assert line[1:-1] not in found
            keys = found[line[1:-1]] = {}
        elif line:
            key, value = line.split("=")
            assert key not in keys
            keys[key] = value
    return found


def within(*intervals: tuple[int, int]) -> Allowed:
    return Allowed(intervals, listed=len(intervals) > 1)


def section_of(obj: Object, section: str = "2000") -> dict[str, str]:
    return sections(device(obj))[section]


# ---- the file as a whole -----------------------------------------------------------------------------------------


def test_the_file_has_the_name_that_the_spec_gives() -> None:
    (output,) = EdsBackend().render(device())
    assert output.path == "toy1/eds/Toy-1.eds"


def test_it_begins_with_file_info_and_every_line_ends_in_crlf() -> None:
    (output,) = EdsBackend().render(device(variable()))
    assert output.content.startswith(b"[FileInfo]\r\n")
    assert output.content.endswith(b"PDOMapping=0\r\n")
    assert output.content.count(b"\r") == output.content.count(b"\n") == output.content.count(b"\r\n")
    assert b"\r\n\r\n\r\n" not in output.content


def test_the_mark_of_generated_files_stands_where_the_build_looks_for_it() -> None:
    assert MARK in render(device())[:2048]


def test_sections_stand_in_the_order_of_cia_306() -> None:
    model = device(variable(0x2000), compound(0x1018, entry(0)), variable(0x6000), variable(0x1000))
    assert list(sections(model)) == [
        *("FileInfo", "DeviceInfo", "DummyUsage", "Comments"),
        *("MandatoryObjects", "OptionalObjects", "ManufacturerObjects"),
        *("1000", "1018", "1018sub0", "2000", "6000"),
    ]


def test_file_info() -> None:
    assert sections(device())["FileInfo"] == {
        "FileName": "Toy-1.eds",
        "FileVersion": "1",
        "FileRevision": "7",
        "EDSVersion": "4.0",
        "Description": "A toy",
        "CreationTime": "09:00AM",
        "CreationDate": "11-22-2026",
        "CreatedBy": "odsmith",
        "ModificationTime": "05:30PM",
        "ModificationDate": "12-24-2026",
        "ModifiedBy": "somebody",
    }


def test_device_info_is_complete() -> None:
    assert sections(device())["DeviceInfo"] == {
        "VendorName": "Toys Ltd",
        "VendorNumber": "0x00000286",
        "ProductName": "Toy-1",
        "ProductNumber": "0x00000C9E",
        "RevisionNumber": "0x00030016",
        "OrderCode": "T-1",
        "BaudRate_10": "0",
        "BaudRate_20": "1",
        "BaudRate_50": "0",
        "BaudRate_125": "1",
        "BaudRate_250": "0",
        "BaudRate_500": "0",
        "BaudRate_800": "0",
        "BaudRate_1000": "1",
        "SimpleBootUpMaster": "0",
        "SimpleBootUpSlave": "1",
        "Granularity": "0",
        "DynamicChannelsSupported": "0",
        "GroupMessaging": "0",
        "NrOfRXPDO": "0",
        "NrOfTXPDO": "0",
        "LSS_Supported": "0",
    }


def test_no_dummy_may_be_mapped() -> None:
    assert sections(device())["DummyUsage"] == {f"Dummy000{number}": "0" for number in range(1, 8)}


# ---- comments ----------------------------------------------------------------------------------------------------


def comments(model: Device) -> str:
    lines = sections(model)["Comments"]
    assert list(lines) == ["Lines", *(f"Line{number}" for number in range(1, int(lines["Lines"]) + 1))]
    return " ".join(value for key, value in lines.items() if key != "Lines")


def test_comments_name_the_version_and_the_digest_of_the_model() -> None:
    assert "1.2.3" in comments(device())
    assert "0123abcd" in comments(device())


def test_a_bit_rate_without_a_key_is_a_comment() -> None:
    model = device(bit_rates=(20, 100, 125))
    assert "100 kbit/s" in comments(model)
    assert not any("100" in key for key in sections(model)["DeviceInfo"] if key != "BaudRate_1000")
    assert "kbit/s" not in comments(device())


def test_the_counting_of_axes_is_told_where_there_are_several() -> None:
    assert "from 0 to 2" in comments(device(axes=3))
    assert "Axes" not in comments(device(axes=1))
    assert "Axes" not in comments(device(axes=0))


def test_the_comments_of_the_spec_come_last_and_long_ones_are_wrapped() -> None:
    long = "word " * 60
    lines = list(sections(device(eds=replace(EDS, comments=(long, "The end."))))["Comments"].values())
    assert lines[-1] == "The end."
    assert lines[-2].startswith("word")
    assert max(map(len, lines)) <= 100


# ---- lists of objects --------------------------------------------------------------------------------------------


def test_each_object_is_listed_once_and_in_its_list() -> None:
    indices = [0x1000, 0x1001, 0x1018, 0x1005, 0x1FFF, 0x2000, 0x5FFF, 0x6000, 0x9FFF]
    found = sections(device(*(variable(index) for index in reversed(indices))))
    assert found["MandatoryObjects"] == {"SupportedObjects": "3", "1": "0x1000", "2": "0x1001", "3": "0x1018"}
    assert found["OptionalObjects"] == {
        "SupportedObjects": "4",
        "1": "0x1005",
        "2": "0x1FFF",
        "3": "0x6000",
        "4": "0x9FFF",
    }
    assert found["ManufacturerObjects"] == {"SupportedObjects": "2", "1": "0x2000", "2": "0x5FFF"}


def test_an_empty_list_says_so() -> None:
    assert sections(device())["ManufacturerObjects"] == {"SupportedObjects": "0"}


# ---- objects -----------------------------------------------------------------------------------------------------


def test_a_variable_in_the_order_of_cia_306() -> None:
    obj = variable(type=DataType.UNSIGNED32, default=Default(0x80), allowed=within((1, 0x90)), mapping=PdoDirection.RX)
    assert list(section_of(obj).items()) == [
        ("ParameterName", "Thing"),
        ("ObjectType", "0x7"),
        ("DataType", "0x0007"),
        ("AccessType", "rww"),
        ("LowLimit", "0x00000001"),
        ("HighLimit", "0x00000090"),
        ("DefaultValue", "0x00000080"),
        ("PDOMapping", "1"),
    ]


@pytest.mark.parametrize(("object_type", "code"), [(ObjectType.ARRAY, "0x8"), (ObjectType.RECORD, "0x9")])
def test_sub_indices_are_counted_not_assumed(object_type: ObjectType, code: str) -> None:
    subs = (0, 1, 3, 9, 10, 16)
    found = sections(device(compound(0x1010, *map(entry, subs), object_type=object_type, name="With holes")))
    assert list(found["1010"].items()) == [("SubNumber", "6"), ("ParameterName", "With holes"), ("ObjectType", code)]
    names = [name for name in found if name.startswith("1010sub")]
    assert names == ["1010sub0", "1010sub1", "1010sub3", "1010sub9", "1010subA", "1010sub10"]
    assert found["1010subA"]["ParameterName"] == "Entry 10"


def test_each_axis_has_its_objects_and_names_count_from_one() -> None:
    found = sections(device(variable(0x6040, stride=0x800), variable(0x2000, stride=0x200), axes=3))
    assert [name for name in found if name[0].isdigit()] == ["2000", "2200", "2400", "6040", "6840", "7040"]
    assert [found[name]["ParameterName"] for name in ("2000", "2200", "7040")] == ["Thing 1", "Thing 2", "Thing 3"]


@pytest.mark.parametrize(
    ("data_type", "number", "printed"),
    [
        (DataType.BOOLEAN, 1, "0x1"),
        (DataType.UNSIGNED8, 10, "0x0A"),
        (DataType.UNSIGNED16, 0xBEEF, "0xBEEF"),
        (DataType.UNSIGNED32, 0xFFFC0192, "0xFFFC0192"),
        (DataType.UNSIGNED64, 1, "0x0000000000000001"),
        (DataType.INTEGER8, -3, "-3"),
        (DataType.INTEGER16, 2, "2"),
        (DataType.INTEGER32, -(1 << 31), "-2147483648"),
        (DataType.INTEGER64, -(1 << 63), "-9223372036854775808"),
    ],
)
def test_numbers_are_signed_decimal_or_unsigned_hexadecimal(data_type: DataType, number: int, printed: str) -> None:
    found = section_of(variable(type=data_type, default=Default(number), allowed=within((number, number))))
    assert [found["DefaultValue"], found["LowLimit"], found["HighLimit"]] == [printed] * 3
    assert found["DataType"] == f"0x{data_type.code:04X}"


def test_a_default_that_depends_on_the_node_id_begins_with_it() -> None:
    obj = variable(type=DataType.UNSIGNED32, default=Default(0x40000200, node_id=True))
    assert section_of(obj)["DefaultValue"] == "$NODEID+0x40000200"


@pytest.mark.parametrize(
    "fields",
    [
        {"default": None},
        {"default": Default(1), "hidden_default": "a PLC would write it into every node"},
        {"default": Default(text="Toy-1"), "type": DataType.VISIBLE_STRING, "length": 5},
        {"default": Default(text="ab"), "type": DataType.OCTET_STRING, "length": 2},
        {"default": Default(0), "type": DataType.REAL32},
        {"default": None, "type": DataType.DOMAIN},
    ],
)
def test_no_default_where_none_is_known_hidden_or_spelt_alike_by_all(fields: dict[str, Any]) -> None:
    assert not {"DefaultValue", "LowLimit", "HighLimit"} & set(section_of(variable(**fields)))


def test_the_limits_of_a_set_are_its_smallest_and_largest_member() -> None:
    found = section_of(variable(type=DataType.INTEGER16, allowed=within((-8, -8), (0, 0), (2, 15))))
    assert (found["LowLimit"], found["HighLimit"]) == ("-8", "15")


@pytest.mark.parametrize(
    "fields",
    [
        {"values": (NamedValue(1, "one", ""),)},
        {"allowed": within((5, 5)), "signatures": (Signature("save", 5, ""),)},
    ],
)
def test_no_limits_without_a_range_or_for_signatures(fields: dict[str, Any]) -> None:
    assert not {"LowLimit", "HighLimit"} & set(section_of(variable(**fields)))


@pytest.mark.parametrize(
    ("access", "mapping", "spelt"),
    [
        (Access.RO, PdoDirection.NO, ("ro", "0")),
        (Access.RO, PdoDirection.TX, ("ro", "1")),
        (Access.CONST, PdoDirection.NO, ("const", "0")),
        (Access.WO, PdoDirection.RX, ("wo", "1")),
        (Access.RW, PdoDirection.NO, ("rw", "0")),
        (Access.RW, PdoDirection.RX, ("rww", "1")),
        (Access.RW, PdoDirection.TX, ("rwr", "1")),
        (Access.RW, PdoDirection.BOTH, ("rw", "1")),
    ],
)
def test_access_says_the_direction_of_a_pdo(access: Access, mapping: PdoDirection, spelt: tuple[str, str]) -> None:
    found = section_of(variable(access=access, mapping=mapping))
    assert (found["AccessType"], found["PDOMapping"]) == spelt


def test_commands_refuse_to_be_written_on_scan_and_nothing_else_does() -> None:
    command = compound(0x1010, entry(0), entry(1, refuse_write_on_scan=True))
    found = sections(device(command, variable(0x2700, refuse_write_on_scan=True), variable(0x2701)))
    assert {name for name, keys in found.items() if "ObjFlags" in keys} == {"1010sub1", "2700"}
    assert found["2700"]["ObjFlags"] == "1"


# ---- PDOs --------------------------------------------------------------------------------------------------------


def drive(mapping_access: Access = Access.RW) -> Device:
    """Two axes, of one RPDO each that carries one object."""
    target = variable(0x607A, stride=0x800, type=DataType.INTEGER32, mapping=PdoDirection.RX)
    communication = compound(
        0x1400,
        entry(0, access=Access.RO, default=Default(2)),
        entry(1, type=DataType.UNSIGNED32, role="pdo_cob_id"),
        entry(2, role="pdo_transmission_type"),
        stride=0x40,
        pdo="rpdo_communication",
        name="RPDO {number} Communication Parameter",
    )
    mapping = compound(
        0x1600,
        entry(0, access=mapping_access, role="pdo_mapped_count"),
        entry(1, access=mapping_access, type=DataType.UNSIGNED32, role="pdo_mapping", repeat=0),
        entry(2, access=mapping_access, type=DataType.UNSIGNED32, role="pdo_mapping", repeat=1),
        stride=0x40,
        pdo="rpdo_mapping",
        name="RPDO {number} Mapping Parameter",
    )
    pdo = Pdo(
        kind="rpdo",
        number=1,
        cob_id=Default(0x40000200, node_id=True),
        other_axes_cob_id=Default(0xC0000000),
        transmission_type=0xFF,
        map=(PdoMapEntry(target, target.entries[0]),),
    )
    return device(communication, mapping, target, axes=2, pdos=(pdo,))


def test_pdos_are_counted() -> None:
    found = sections(drive())["DeviceInfo"]
    assert (found["NrOfRXPDO"], found["NrOfTXPDO"]) == ("2", "0")
    edges = (0x13FF, 0x1400, 0x15FF, 0x1600, 0x17FF, 0x1800, 0x1801, 0x19FF, 0x1A00)
    found = sections(device(*map(variable, edges)))["DeviceInfo"]
    assert (found["NrOfRXPDO"], found["NrOfTXPDO"]) == ("2", "3")


def test_pdo_parameters_of_the_first_and_of_another_axis() -> None:
    found = sections(drive())
    assert found["1400"]["ParameterName"] == "RPDO 1 Communication Parameter"
    assert found["1440"]["ParameterName"] == "RPDO 65 Communication Parameter"
    assert found["1400sub1"]["DefaultValue"] == "$NODEID+0x40000200"
    assert found["1440sub1"]["DefaultValue"] == "0xC0000000"
    assert found["1440sub2"]["DefaultValue"] == "0xFF"


def test_sub_index_0_of_a_mapping_is_the_number_mapped() -> None:
    found = sections(drive())
    assert found["1640"]["SubNumber"] == "3"
    assert (found["1640sub0"]["AccessType"], found["1640sub0"]["DefaultValue"]) == ("rw", "0x01")
    assert [found[f"1640sub{sub}"]["DefaultValue"] for sub in (1, 2)] == ["0x687A0020", "0x00000000"]


def test_granularity_tells_whether_the_mapping_can_be_changed() -> None:
    assert sections(drive())["DeviceInfo"]["Granularity"] == "8"
    assert sections(drive(Access.RO))["DeviceInfo"]["Granularity"] == "0"


# ---- hostile text ------------------------------------------------------------------------------------------------

HOSTILE = [
    "a\r\n[6040]\r\nParameterName=b",
    "a\n\n[evil]",
    "\ufeff[FileInfo]",
    "a = b == c",
    "a ; b",
    "a # b",
    "x" * 300,
    "x " * 300,
    "gr\u00f6\u00dfer \u2028 \u202e \x00 \x1a \x85",
    "{{ 1/0 }} {% endfor %} %s %(a)s ${HOME} \\",
]


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_text_changes_no_section_and_no_other_key(text: str) -> None:
    def toy(text: str) -> Device:
        info = replace(EDS, description=text, created_by=text, modified_by=text, creation_time=text)
        objects = (compound(0x1000, entry(0, parameter_name=text), name=text), variable(name=text))
        return device(*objects, vendor=text, name=text, order_code=text, version=text, eds=info)

    def numbers(model: Device) -> dict[str, dict[str, str]]:
        texts = {"Description", "CreatedBy", "ModifiedBy", "CreationTime", "ParameterName"}
        texts |= {"VendorName", "ProductName", "OrderCode"}
        return {
            section: {key: "" if key in texts else value for key, value in keys.items()}
            for section, keys in sections(model).items()
            if section != "Comments"
        }

    assert numbers(toy(text)) == numbers(toy("tame"))
    assert max(map(len, render(toy(text)).split("\r\n"))) <= 255


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_comment_stays_a_comment(text: str) -> None:
    model = device(eds=replace(EDS, comments=(text, text)))
    assert len(comments(model)) > len(comments(device()))
    assert list(sections(model)) == list(sections(device()))
    assert max(map(len, render(model).split("\r\n"))) <= 255
