"""python-canopen: the object dictionary, and the PDOs as a node that was never asked knows them."""

from __future__ import annotations

import canopen
from canopen.objectdictionary import ODArray, ODRecord, ODVariable

from .program import Rows, Tables, main

KINDS = {ODVariable: 7, ODArray: 8, ODRecord: 9}


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    od = canopen.import_od(path, node_id)
    return {
        "device": {"": device(od)},
        "objects": {f"{i:04X}": {"name": obj.name, "kind": KINDS[type(obj)]} for i, obj in od.indices.items()},
        "entries": entries(od),
        "pdos": pdos(od, node_id),
    }, []


def device(od: canopen.ObjectDictionary) -> dict[str, object]:
    info = od.device_information
    return {
        "vendor_name": info.vendor_name,
        "vendor_number": info.vendor_number,
        "product_name": info.product_name,
        "product_number": info.product_number,
        "revision_number": info.revision_number,
        "order_code": info.order_code,
        "bit_rates": sorted(rate // 1000 for rate in info.allowed_baudrates),
        "boot_up_master": info.simple_boot_up_master,
        "boot_up_slave": info.simple_boot_up_slave,
        "granularity": info.granularity,
        "dynamic_channels": info.dynamic_channels_supported,
        "group_messaging": info.group_messaging,
        "rpdos": info.nr_of_RXPDO,
        "tpdos": info.nr_of_TXPDO,
        "lss": info.LSS_supported,
    }


def entries(od: canopen.ObjectDictionary) -> Rows:
    found: Rows = {}
    for index, obj in od.indices.items():
        for sub, variable in {0: obj}.items() if isinstance(obj, ODVariable) else obj.subindices.items():
            found[f"{index:04X}:{sub:X}"] = {
                "name": variable.name,
                "type": variable.data_type,
                "access": variable.access_type,
                "default": variable.default,
                "relative": variable.relative,
                "low": variable.min,
                "high": variable.max,
                "mappable": variable.pdo_mappable,
            }
    return found


def pdos(od: canopen.ObjectDictionary, node_id: int) -> Rows:
    node = canopen.RemoteNode(node_id, od)
    node.associate_network(canopen.Network())  # not connected: asking the device would be an error
    found: Rows = {}
    for kind, maps in (("rpdo", node.rpdo), ("tpdo", node.tpdo)):
        for number, pdo in maps.items():
            pdo.read(from_od=True)
            found[f"{kind} {number}"] = {
                "can_id": pdo.cob_id,
                "enabled": pdo.enabled,
                "rtr_allowed": pdo.rtr_allowed,
                "transmission_type": pdo.trans_type,
                "inhibit_time": pdo.inhibit_time or 0,
                "event_timer": pdo.event_timer or 0,
                "map": [[item.index, item.subindex, item.length] for item in pdo.map],
            }
    return found


if __name__ == "__main__":
    main("canopen", read)
