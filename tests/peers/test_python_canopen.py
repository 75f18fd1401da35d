"""python-canopen reads our EDS files, and reads every fact of the model out of them."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import canopen
import pytest
from canopen.objectdictionary import ODArray, ODRecord, ODVariable
from canopen.pdo.base import PdoMap

from odsmith.backends.eds import EdsBackend
from odsmith.canopen_types import ObjectType
from odsmith.model import Device, ExpandedEntry, ExpandedObject, Pdo, PdoKind

NODE_IDS = [1, 127]


@pytest.fixture(scope="module", params=["tmcm3230", "io_module"])
def device(request: pytest.FixtureRequest) -> Device:
    """Every device that we ship."""
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(scope="module")
def eds(device: Device, tmp_path_factory: pytest.TempPathFactory) -> Path:
    (output,) = EdsBackend().render(device)
    path = tmp_path_factory.mktemp("eds") / Path(output.path).name
    path.write_bytes(output.content)
    return path


@pytest.fixture(scope="module", params=NODE_IDS)
def node_id(request: pytest.FixtureRequest) -> int:
    node_id: int = request.param
    return node_id


@pytest.fixture(scope="module")
def dictionary(eds: Path, node_id: int) -> canopen.ObjectDictionary:
    return canopen.import_od(str(eds), node_id)


def test_it_loads_without_a_word(eds: Path, node_id: int, caplog: pytest.LogCaptureFixture) -> None:
    with warnings.catch_warnings(), caplog.at_level(logging.DEBUG):
        warnings.simplefilter("error")
        canopen.import_od(str(eds), node_id)
    assert caplog.record_tuples == []


# ---- every fact --------------------------------------------------------------------------------------------------


class Fact(NamedTuple):
    """What an EDS says of one sub-index."""

    name: str
    data_type: int | None
    access: str
    default: int | None
    low: int | None
    high: int | None
    mappable: bool


def modelled(item: ExpandedEntry, obj: ExpandedObject, node_id: int) -> Fact:
    entry = item.entry
    default = item.eds_default.value(node_id) if item.eds_default else None
    limits = entry.allowed if entry.allowed and not entry.signatures else None
    return Fact(
        name=obj.parameter_name if obj.object.object_type is ObjectType.VAR else entry.parameter_name,
        data_type=entry.type.code,
        access=entry.eds_access,
        default=None if isinstance(default, str) else default,
        low=limits.low if limits else None,
        high=limits.high if limits else None,
        mappable=entry.mapping.receivable or entry.mapping.transmittable,
    )


def read_back(variable: ODVariable) -> Fact:
    return Fact(
        name=variable.name,
        data_type=variable.data_type,
        access=variable.access_type,
        default=variable.default,
        low=variable.min,
        high=variable.max,
        mappable=variable.pdo_mappable,
    )


def variables(dictionary: canopen.ObjectDictionary) -> dict[tuple[int, int], ODVariable]:
    found = {}
    for index, obj in dictionary.indices.items():
        for sub, variable in {0: obj}.items() if isinstance(obj, ODVariable) else obj.subindices.items():
            found[index, sub] = variable
    return found


def test_every_entry_is_read_back_as_modelled(
    device: Device, dictionary: canopen.ObjectDictionary, node_id: int
) -> None:
    expected = {
        (item.index, item.entry.sub): modelled(item, obj, node_id) for obj in device.expanded for item in obj.entries
    }
    assert {place: read_back(variable) for place, variable in variables(dictionary).items()} == expected


def test_every_object_is_read_back_with_its_name_and_kind(device: Device, dictionary: canopen.ObjectDictionary) -> None:
    kinds = {ObjectType.VAR: ODVariable, ObjectType.ARRAY: ODArray, ObjectType.RECORD: ODRecord}
    expected = {obj.index: (obj.parameter_name, kinds[obj.object.object_type]) for obj in device.expanded}
    assert {index: (obj.name, type(obj)) for index, obj in dictionary.indices.items()} == expected
    assert len(dictionary.names) == len(dictionary.indices), "objects cannot be told apart by their names"


def test_no_dummy_is_mappable(dictionary: canopen.ObjectDictionary) -> None:
    assert min(dictionary) == 0x1000


def test_the_device_is_read_back(device: Device, dictionary: canopen.ObjectDictionary) -> None:
    identity, found = device.identity, dictionary.device_information
    every = variables(dictionary)
    assert found.vendor_name == identity.vendor
    assert found.vendor_number == identity.vendor_id == read_back(every[0x1018, 1]).default
    assert found.product_name == identity.name
    assert found.product_number == identity.product_code == read_back(every[0x1018, 2]).default
    assert found.revision_number == identity.revision_number == read_back(every[0x1018, 3]).default
    assert found.order_code == identity.order_code
    assert found.allowed_baudrates == {1000 * rate for rate in identity.bit_rates if rate != 100}
    assert found.nr_of_RXPDO == len(device.pdos_of("rpdo")) * max(device.axes, 1)
    assert found.nr_of_TXPDO == len(device.pdos_of("tpdo")) * max(device.axes, 1)
    assert found.simple_boot_up_slave
    assert not found.simple_boot_up_master
    assert not found.LSS_supported
    assert device.digest in dictionary.comments


# ---- what the facts are for --------------------------------------------------------------------------------------


def test_every_default_can_be_sent(dictionary: canopen.ObjectDictionary) -> None:
    for variable in variables(dictionary).values():
        if variable.default is not None:
            assert variable.decode_raw(variable.encode_raw(variable.default)) == variable.default


def test_pdos_are_known_before_the_device_is_asked(
    device: Device, dictionary: canopen.ObjectDictionary, node_id: int
) -> None:
    node = canopen.RemoteNode(node_id, dictionary)
    node.associate_network(canopen.Network())  # not connected: asking the device would be an error
    found: dict[PdoKind, Mapping[int, PdoMap]] = {"rpdo": node.rpdo, "tpdo": node.tpdo}
    for kind, maps in found.items():
        records = [obj for obj in device.expanded if obj.object.pdo == f"{kind}_communication"]
        assert list(maps) == [obj.number for obj in records]
        for obj in records:
            axis = obj.axis or 0
            pdo = device.pdos_of(kind)[obj.index - obj.object.index - axis * obj.object.stride]
            assert_is_read(maps[obj.number], pdo, axis, node_id)


def assert_is_read(found: PdoMap, pdo: Pdo, axis: int, node_id: int) -> None:
    found.read(from_od=True)
    cob_id = int((pdo.other_axes_cob_id if axis else pdo.cob_id).value(node_id))
    assert found.enabled == (cob_id >> 31 == 0)
    assert found.cob_id == cob_id & 0x1FFF_FFFF
    assert found.trans_type == pdo.transmission_type
    assert [(item.index, item.subindex, item.length) for item in found.map] == [
        (item.object.index + axis * item.object.stride, item.entry.sub, item.entry.bit_length) for item in pdo.map
    ]
    assert all(item.od.pdo_mappable for item in found.map)
