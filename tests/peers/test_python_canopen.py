"""python-canopen reads more of our EDS files than test_readers.py compares, and makes working nodes of them."""

from __future__ import annotations

from pathlib import Path

import canopen
import pytest
from canopen.objectdictionary import ODVariable

from odsmith.model import Device


@pytest.fixture(scope="module")
def dictionary(eds: Path, node_id: int) -> canopen.ObjectDictionary:
    return canopen.import_od(str(eds), node_id)


def test_objects_are_told_apart_by_their_names(dictionary: canopen.ObjectDictionary) -> None:
    assert len(dictionary.names) == len(dictionary.indices)


def test_no_dummy_is_mappable(dictionary: canopen.ObjectDictionary) -> None:
    assert min(dictionary) == 0x1000


def test_the_comments_name_the_model(device: Device, dictionary: canopen.ObjectDictionary) -> None:
    assert device.digest in dictionary.comments


def test_every_default_can_be_sent(dictionary: canopen.ObjectDictionary) -> None:
    variables = [
        variable
        for obj in dictionary.values()
        for variable in ([obj] if isinstance(obj, ODVariable) else obj.values())
        if variable.default is not None
    ]
    assert len(variables) > 30
    for variable in variables:
        assert isinstance(variable.default, int)
        assert variable.decode_raw(variable.encode_raw(variable.default)) == variable.default


def test_every_mapped_object_is_mappable(dictionary: canopen.ObjectDictionary, node_id: int) -> None:
    node = canopen.RemoteNode(node_id, dictionary)
    node.associate_network(canopen.Network())  # not connected: asking the device would be an error
    pdos = [*node.rpdo.values(), *node.tpdo.values()]
    for pdo in pdos:
        pdo.read(from_od=True)
    assert any(pdo.map for pdo in pdos)
    assert all(item.od.pdo_mappable for pdo in pdos for item in pdo.map)
