"""What the model says of a device, as plain tables, and what foreign readers made of our EDS file, in the same form.

A table is rows of facts by field, `{"60C2:2": {"name": "Interpolation time index", "low": -3, ...}, ...}`. A reader's
table has the fields that the reader exposes; the model's has all of them:

    device          one row, "": [FileInfo] and [DeviceInfo]
    objects         by index, `60C2`
    entries         by index and sub-index, `60C2:2`
    numbers         those entries whose type has a fixed length
    pdos            by kind and number, `tpdo 65`
    active_pdos     those PDOs that are valid and map something
    frames          all PDOs by the name that a bus database gives them
    signals         what they map, `TPDO_1_Communication_Parameter/0`
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.canopen_types import Access, ObjectType
from odsmith.compile import compile_file
from odsmith.model import Device, ExpandedEntry, ExpandedObject, Pdo, PdoKind

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
SPEC = ROOT / "spec"

DEVICES = {path.stem: path for folder in (SPEC, SPEC / "examples") for path in sorted(folder.glob("*.yaml"))}
"""Every device that we ship."""

NODE_IDS = (1, 127)

Rows = dict[str, dict[str, object]]
Tables = dict[str, Rows]


@pytest.fixture(scope="session")
def devices() -> dict[str, Device]:
    models = {name: compile_file(path) for name, path in DEVICES.items()}
    return {name: model for name, model in models.items() if isinstance(model, Device)}


@pytest.fixture(scope="session")
def eds_files(devices: dict[str, Device], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The EDS file of every device, under its own name."""
    folder = tmp_path_factory.mktemp("eds")
    files = {}
    for name, device in devices.items():
        (output,) = EdsBackend().render(device)
        files[name] = folder / Path(output.path).name
        files[name].write_bytes(output.content)
    return files


@pytest.fixture(scope="session", params=DEVICES)
def device_name(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


@pytest.fixture(scope="session")
def device(devices: dict[str, Device], device_name: str) -> Device:
    return devices[device_name]


@pytest.fixture(scope="session")
def eds(eds_files: dict[str, Path], device_name: str) -> Path:
    return eds_files[device_name]


@pytest.fixture(scope="session", params=NODE_IDS)
def node_id(request: pytest.FixtureRequest) -> int:
    node_id: int = request.param
    return node_id


# ---- readers -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Reading:
    """What a reader made of one file for one node-ID; `messages` is all that it said."""

    version: str
    messages: list[str]
    tables: Tables


Readings = dict[tuple[str, int], Reading]
"""By device and node-ID."""


@pytest.fixture(scope="session")
def readings(eds_files: dict[str, Path], tool: Callable[[str], str]) -> Callable[[str], Readings]:
    """`readings("npm_canopen")` runs a reader over all files, once."""
    known: dict[str, Readings] = {}

    def get(reader: str) -> Readings:
        if reader not in known:
            known[reader] = _read(_program(reader, tool), eds_files)
        return known[reader]

    return get


def _program(reader: str, tool: Callable[[str], str]) -> list[str]:
    """The beginning of the command that runs a reader; those of `tests/peers/install` need not be there."""
    if reader == "npm_canopen":
        node = tool("node")
        _installed(HERE / "npm" / "node_modules", tool)
        return [node, "npm/read.js"]
    if reader == "eds_utils":
        return [str(_installed(HERE / "python" / ".venv" / "bin" / "python", tool)), "-m", f"readers.{reader}"]
    return [sys.executable, "-m", f"readers.{reader}"]


def _installed(path: Path, tool: Callable[[str], str]) -> Path:
    if not path.exists():
        tool(f"what tests/peers/install makes ({path.relative_to(ROOT)})")  # no such program: skips, or fails in CI
    return path


def _read(program: list[str], files: dict[str, Path]) -> Readings:
    command = [*program, ",".join(map(str, NODE_IDS)), *map(str, files.values())]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=120, env=_environment(), cwd=HERE
    )
    assert done.returncode == 0, done.stderr
    printed = json.loads(done.stdout)
    names = {str(path): name for name, path in files.items()}
    return {
        (names[reading["file"]], reading["node_id"]): Reading(
            version=printed["version"],
            messages=[*reading["messages"], *done.stderr.splitlines()],
            tables=reading["tables"],
        )
        for reading in printed["readings"]
    }


def _environment() -> dict[str, str]:
    """Without the switches of the running interpreter, which might make a reader say more or less."""
    return {key: value for key, value in os.environ.items() if not key.startswith("PYTHON") and key != "NODE_OPTIONS"}


# ---- the model ---------------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def facts(devices: dict[str, Device]) -> Callable[[str, int], Tables]:
    """`facts("tmcm3230", 1)` gives what the model says of this device at this node-ID."""

    def get(name: str, node_id: int) -> Tables:
        device = devices[name]
        pdos = list(_expanded_pdos(device))
        return {
            "device": {"": _device(device, node_id)},
            "objects": {f"{obj.index:04X}": _object(obj) for obj in device.expanded},
            "entries": {key: row for key, row, _ in _entries(device, node_id)},
            "numbers": {key: row for key, row, item in _entries(device, node_id) if item.entry.type.bits},
            "pdos": {pdo.key: pdo.row(node_id) for pdo in pdos},
            "active_pdos": {pdo.key: pdo.row(node_id) for pdo in pdos if pdo.active},
            "frames": {pdo.symbol: pdo.row(node_id) for pdo in pdos},
            "signals": {f"{pdo.symbol}/{place}": row for pdo in pdos for place, row in enumerate(pdo.signals())},
        }

    return get


def _symbol(name: str) -> str:
    """A name as bus databases take it."""
    return re.sub("[^A-Za-z0-9]", "_", name)


def _device(device: Device, node_id: int) -> dict[str, object]:
    identity, eds = device.identity, device.identity.eds
    every = {(item.index, item.entry.sub): item for obj in device.expanded for item in obj.entries}
    mapping = [item for obj in device.expanded if obj.object.pdo.endswith("mapping") for item in obj.entries]
    return {
        "symbol": _symbol(identity.name),
        "file_name": Path(eds.file).name,
        "file_version": eds.version,
        "file_revision": eds.revision,
        "eds_version": "4.0",
        "description": eds.description,
        "created": _moment(eds.creation_date, eds.creation_time),
        "created_by": eds.created_by,
        "modified": _moment(eds.modification_date, eds.modification_time),
        "modified_by": eds.modified_by,
        "vendor_name": identity.vendor,
        "vendor_number": identity.vendor_id,
        "product_name": identity.name,
        "product_number": identity.product_code,
        "revision_number": identity.revision_number,
        "order_code": identity.order_code,
        "bit_rates": sorted(rate for rate in identity.bit_rates if rate != 100),  # CiA 306 has no key for that one
        "boot_up_master": False,
        "boot_up_slave": True,
        "granularity": 8 if any(item.entry.access.writable for item in mapping) else 0,
        "dynamic_channels": False,
        "group_messaging": False,
        "rpdos": len(device.pdos_of("rpdo")) * max(device.axes, 1),
        "tpdos": len(device.pdos_of("tpdo")) * max(device.axes, 1),
        "lss": False,
        "device_type": _value(every[0x1000, 0], node_id),
        "emergency_cob_id": _value(every[0x1014, 0], node_id),
    }


def _moment(date: str, time: str) -> str:
    return datetime.strptime(f"{date} {time}", "%m-%d-%Y %I:%M%p").isoformat()


def _object(obj: ExpandedObject) -> dict[str, object]:
    return {
        "name": obj.parameter_name,
        "kind": obj.object.object_type.code,
        "subs": len(obj.entries),
        **_place(obj),
    }


def _place(obj: ExpandedObject) -> dict[str, object]:
    """Not read, but what a known bug may depend on."""
    area = "manufacturer" if 0x2000 <= obj.index < 0x6000 else "profile" if obj.index >= 0x6000 else "communication"
    return {"index": obj.index, "area": area, "axis": obj.axis, "object": obj.object.object_type.value}


def _entries(device: Device, node_id: int) -> Iterator[tuple[str, dict[str, object], ExpandedEntry]]:
    for obj in device.expanded:
        for item in obj.entries:
            yield f"{item.index:04X}:{item.entry.sub:X}", _entry(obj, item, node_id), item


def _entry(obj: ExpandedObject, item: ExpandedEntry, node_id: int) -> dict[str, object]:
    """`default` is None where the file has none; `value` is what the entry then starts with. `least` and `most` are the
    limits, or those of the type where the file has none."""
    entry = item.entry
    name = obj.parameter_name if obj.object.object_type is ObjectType.VAR else entry.parameter_name
    limits = entry.allowed if entry.allowed and not entry.signatures else None
    numeric = entry.type.bits > 0
    return {
        "name": name,
        "symbol": _symbol(name),
        "type": entry.type.code,
        "bits": entry.type.bits,
        "signed": entry.type.signed,
        "access": entry.eds_access,
        "sdo_access": "ro" if entry.access is Access.CONST else entry.access.value,
        "readable": entry.access.readable,
        "writable": entry.access.writable,
        "default": _value(item, node_id) if item.eds_default and numeric else None,
        "value": _value(item, node_id),
        "relative": bool(item.eds_default and item.eds_default.node_id),
        "low": limits.low if limits else None,
        "high": limits.high if limits else None,
        "least": (limits.low if limits else entry.type.low) if numeric else None,
        "most": (limits.high if limits else entry.type.high) if numeric else None,
        "mappable": entry.mapping.receivable or entry.mapping.transmittable,
        "refuse_write_on_scan": entry.refuse_write_on_scan,
        "sub": entry.sub,
        **_place(obj),
    }


def _value(item: ExpandedEntry, node_id: int) -> int | str:
    """Strings have no default in the file: readers do not agree on how to spell one."""
    if not item.entry.type.bits:
        return ""
    value = item.eds_default.value(node_id) if item.eds_default else 0
    assert isinstance(value, int)
    return value


@dataclass(frozen=True)
class _ExpandedPdo:
    """A PDO of one axis."""

    kind: PdoKind
    number: int
    symbol: str
    axis: int
    pdo: Pdo

    @property
    def key(self) -> str:
        return f"{self.kind} {self.number}"

    @property
    def active(self) -> bool:
        return bool(self.pdo.map) and not self.cob_id(0) >> 31

    def cob_id(self, node_id: int) -> int:
        return int((self.pdo.other_axes_cob_id if self.axis else self.pdo.cob_id).value(node_id))

    def row(self, node_id: int) -> dict[str, object]:
        cob_id = self.cob_id(node_id)
        mapped = [(item.object.index + self.axis * item.object.stride, item.entry) for item in self.pdo.map]
        return {
            "cob_id": cob_id,
            "can_id": cob_id & 0x1FFF_FFFF,
            "enabled": not cob_id >> 31,
            "rtr_allowed": not cob_id >> 30 & 1,
            "transmission_type": self.pdo.transmission_type,
            "inhibit_time": self.pdo.inhibit_time,
            "event_timer": self.pdo.event_timer,
            "map": [[index, entry.sub, entry.bit_length] for index, entry in mapped],
            "bytes": (sum(entry.bit_length for _, entry in mapped) + 7) // 8,
            "sent": self.kind == "tpdo",
        }

    def signals(self) -> Iterator[dict[str, object]]:
        start = 0
        for item in self.pdo.map:
            entry, limits = item.entry, item.entry.allowed
            suffix = f" {self.axis + 1}" if item.object.per_axis else ""
            single = item.object.object_type is ObjectType.VAR
            yield {
                "symbol": _symbol(item.object.parameter_name + suffix if single else entry.parameter_name),
                "start": start,
                "bits": entry.bit_length,
                "signed": entry.type.signed,
                "least": limits.low if limits else entry.type.low,
                "most": limits.high if limits else entry.type.high,
                "factor": 1,
                "offset": 0,
                "limited": limits is not None,
            }
            start += entry.bit_length


def _expanded_pdos(device: Device) -> Iterator[_ExpandedPdo]:
    kinds: dict[str, PdoKind] = {"rpdo_communication": "rpdo", "tpdo_communication": "tpdo"}
    for obj in device.expanded:
        if kind := kinds.get(obj.object.pdo):
            axis = obj.axis or 0
            ordinal = obj.index - obj.object.index - axis * obj.object.stride
            yield _ExpandedPdo(kind, obj.number, _symbol(obj.parameter_name), axis, device.pdos_of(kind)[ordinal])
