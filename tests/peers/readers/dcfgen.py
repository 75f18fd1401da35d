"""dcfgen of dcf-tools: the master that it makes for one slave.

What the master must know of the slave stands in its objects.
"""

from __future__ import annotations

import tempfile
from configparser import ConfigParser
from pathlib import Path

from .commands import run
from .program import Rows, Tables, main

MASTER = 126


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    with tempfile.TemporaryDirectory() as folder:
        bus = Path(folder) / "bus.yml"
        bus.write_text(f"master: {{node_id: {MASTER}}}\nslave: {{node_id: {node_id}, dcf: '{path}'}}\n")
        printed, complaints = run("dcfgen.cli", "--remote-pdo", "--directory", folder, bus)
        master = ConfigParser(interpolation=None)
        master.read(Path(folder) / "master.dcf")
    return {
        "device": {"": device(master, str(node_id))},
        "active_pdos": {**pdos(master, node_id, "tpdo", 0x1400), **pdos(master, node_id, "rpdo", 0x1800)},
    }, printed.splitlines() + complaints


def device(master: ConfigParser, node_id: str) -> dict[str, object]:
    """What the master expects the slave to be (CiA 302: 1F84h to 1F86h), and the identifier of its emergencies."""
    return {
        "device_type": int(master["1F84Value"][node_id], 0),
        "vendor_number": int(master["1F85Value"][node_id], 0),
        "product_number": int(master["1F86Value"][node_id], 0),
        "emergency_cob_id": int(master["1028Value"][node_id], 0),
    }


def pdos(master: ConfigParser, node_id: int, kind: str, first: int) -> Rows:
    """The master's PDOs that mirror the slave's. 5800h to 5EFFh hold the slave's own number and mapping of each."""
    found: Rows = {}
    ordinal = 0
    while master.has_section(f"{first + ordinal:04X}"):
        communication = f"{first + ordinal:04X}"
        remote = 0x5800 + (0x400 if kind == "rpdo" else 0) + ordinal
        number = int(master[f"{remote:04X}"]["DefaultValue"], 0)
        assert number & 0xFF == node_id
        mapped = master[f"{remote + 0x200:04X}Value"]
        entries = [int(mapped[str(place + 1)], 0) for place in range(int(mapped["NrOfEntries"]))]
        found[f"{kind} {number >> 8}"] = {
            "cob_id": int(master[f"{communication}sub1"]["DefaultValue"], 0),
            "transmission_type": int(master[f"{communication}sub2"]["DefaultValue"], 0),
            "map": [[entry >> 16, entry >> 8 & 0xFF, entry & 0xFF] for entry in entries],
        }
        ordinal += 1
    return found


if __name__ == "__main__":
    main("dcf-tools", read)
