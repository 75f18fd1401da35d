"""eds-utils: what its reader hands to its checker, its editor and its writers. It keeps numbers as text."""

from __future__ import annotations

from eds_utils.core.eds import EDS  # type: ignore[import-not-found]
from eds_utils.core.file_io.read_eds import read_eds  # type: ignore[import-not-found]
from eds_utils.core.objects import Variable  # type: ignore[import-not-found]

from .program import Tables, main


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    eds, complaints = read_eds(path)
    objects = {index: eds[index] for index in eds.indexes}
    return {
        "device": {"": device(eds)},
        "objects": {
            f"{index:04X}": {"name": obj.parameter_name, "kind": obj.object_type.value}
            for index, obj in objects.items()
        },
        "entries": {
            f"{index:04X}:{sub:X}": entry(obj if isinstance(obj, Variable) else obj[sub])
            for index, obj in objects.items()
            for sub in ([0] if isinstance(obj, Variable) else obj.subindexes)
        },
    }, complaints


def device(eds: EDS) -> dict[str, object]:
    file, info = eds.file_info, eds.device_info
    return {
        "file_name": file.file_name,
        "file_version": file.file_version,
        "file_revision": file.file_revision,
        "eds_version": file.eds_version,
        "description": file.description,
        "created": file.creation_dt.isoformat(),
        "created_by": file.created_by,
        "modified": file.modification_dt.isoformat(),
        "modified_by": file.modified_by,
        "vendor_name": info.vendor_name,
        "vendor_number": info.vendor_number,
        "product_name": info.product_name,
        "product_number": info.product_number,
        "revision_number": info.revision_number,
        "order_code": info.order_code,
        "bit_rates": [rate for rate, supported in info.baud_rate.items() if supported],
        "boot_up_master": info.simple_boot_up_master,
        "boot_up_slave": info.simple_boot_up_slave,
        "granularity": info.grandularity,
        "dynamic_channels": info.dynamic_channel_supperted,
        "group_messaging": info.group_messaging,
        "rpdos": info.num_of_rpdo,
        "tpdos": info.num_of_tpdo,
        "lss": info.lss_supported,
    }


def entry(variable: Variable) -> dict[str, object]:
    return {
        "name": variable.parameter_name,
        "type": variable.data_type.value,
        "access": variable.access_type.to_str(),
        "value": variable.default_value,
        "low": variable.low_limit or None,
        "high": variable.high_limit or None,
        "mappable": variable.pdo_mapping,
    }


if __name__ == "__main__":
    main("eds-utils", read)
