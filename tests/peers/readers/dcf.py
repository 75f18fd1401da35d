"""dcf-tools: what its library, which all of its commands share, reads."""

from __future__ import annotations

import dcf  # type: ignore[import-untyped]

from .program import Rows, Tables, main


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    device = dcf.Device.from_dcf(path, {"NODEID": node_id})
    return {
        "device": {"": device_facts(device)},
        "objects": {
            f"{index:04X}": {"name": obj.name, "kind": obj.object_type, "subs": len(obj)}
            for index, obj in device.items()
        },
        "entries": {
            f"{index:04X}:{sub:X}": entry(item, node_id) for index, obj in device.items() for sub, item in obj.items()
        },
        "pdos": {**pdos("rpdo", device.rpdo), **pdos("tpdo", device.tpdo)},
    }, []


def device_facts(device: dcf.Device) -> dict[str, object]:
    return {
        "vendor_number": device.vendor_id,
        "product_number": device.product_code,
        "revision_number": device.revision_number,
        "device_type": device.device_type,
    }


def entry(item: dcf.SubObject, node_id: int) -> dict[str, object]:
    limits = [getattr(item, name, None) for name in ("low_limit", "high_limit")]
    low, high = (None if limit is None else limit.parse({"NODEID": node_id}) for limit in limits)
    access = item.access_type
    return {
        "name": item.name,
        "type": item.data_type.index,
        "access": access.name,
        "readable": access.read,
        "writable": access.write,
        "value": text_or_number(item.default_value.parse({"NODEID": node_id})),
        "relative": item.default_value.has_nodeid(),
        "low": low,
        "high": high,
        "mappable": item.pdo_mapping,
    }


def text_or_number(value: object) -> object:
    return value.decode() if isinstance(value, bytes) else value


def pdos(kind: str, found: dict[int, dcf.PDO]) -> Rows:
    return {
        f"{kind} {number}": {
            "cob_id": pdo.cob_id,
            "transmission_type": pdo.transmission_type,
            "inhibit_time": pdo.inhibit_time,
            "event_timer": pdo.event_timer,
            "map": [[item.index, item.sub_index, item.data_type.bits()] for item in pdo.mapping.values()],
        }
        for number, pdo in found.items()
    }


if __name__ == "__main__":
    main("dcf-tools", read)
