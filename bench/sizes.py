"""`make sizes`: flash and RAM of the C runtime and of the generated tables on a Cortex-M4 at -Os, file by file.

Ends with exit status 1 where more axes make the dictionary grow, 2 where the compiler is not installed.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from arm import (
    NO_SECTIONS,
    ROOT,
    Sections,
    compile_objects,
    device_sources,
    require,
    runtime_sources,
    sections,
    sizes_of,
    symbols,
)
from odsmith.backends.c import CBackend
from odsmith.compile import compile_file
from odsmith.render import write

DEVICES = ("tmcm3230", "tmcm6212")

MOST_FOR_SIX_AXES = 3200
"""Bytes of the rows and what leads to them."""

MOST_GROWTH = 1.10
"""Six axes against one. What grows is the base of each instance, and the entries that store one axis."""

POWER_ON = ("_defaults", "other_cob_ids", "node_ids", "areas")
"""Tables that hold power-on values rather than rows."""

MOTION = tuple(
    f"ods_{name}"
    for name in ["axis", "cyclic", "encoder", "fsa", "homing", "limits", "mode", "motion", "motor", "ramp"]
)
BEYOND_301 = ("ods_store", "ods_led", "ods_os_command", *MOTION)
"""Files that the peers' figures have nothing like."""

STATE = {
    "sdo": "the SDO server",
    "heartbeat": "heartbeat and guarding",
    "emcy": "emergencies",
    "leds": "LEDs",
    "io": "inputs and outputs",
    "store": "storing",
    "pdo": "PDOs, shared",
}
"""Members of a node; what is not among them is time and the node itself."""


def is_power_on(symbol: str) -> bool:
    return symbol.endswith(POWER_ON)


def dictionary_size(path: Path) -> tuple[int, int]:
    """Bytes of rows and search, and of the power-on values, of a compiled dictionary."""
    power_on = sum(size for name, size in symbols(path).items() if is_power_on(name))
    return sections(path).flash - power_on, power_on


def runtime_sizes(folder: Path, device: str = DEVICES[-1]) -> dict[str, Sections]:
    """Of each file of the runtime."""
    objects = compile_objects(runtime_sources(), device, folder / "runtime")
    return {path.stem: sections(path) for path in objects}


def table_sizes(device: str, folder: Path) -> dict[str, int]:
    """Flash of what is generated for a device, by what it is for."""
    sizes = {"dictionary: rows and search": 0, "dictionary: power-on values": 0, "device tables": 0, "memory": 0}
    for path in compile_objects(device_sources(device), device, folder / device):
        if path.stem == f"{device}_od":
            rows, power_on = dictionary_size(path)
            sizes["dictionary: rows and search"] += rows
            sizes["dictionary: power-on values"] += power_on
        elif path.stem == f"{device}_device":
            sizes["device tables"] += sections(path).flash
        else:
            sizes["memory"] += sections(path).flash
    return sizes


def memory_sizes(device: str, folder: Path) -> dict[str, int]:
    """RAM of a node of a device, by part; `all` of it and `values` among them."""
    whole = f"{device}_t"
    members = {name: f"(({whole} *)0)->node.{name}" for name in STATE}
    arrays = {name: f"(({whole} *)0)->{name}" for name in ("values", "axes", "rpdos", "tpdos", "mapped", "buffer")}
    return sizes_of({"all": whole, "node": "ods_node_t", **members, **arrays}, device, folder / device)


def spec_with(axes: int, folder: Path) -> Path:
    """The TMCM-3230 with another number of axes; six of them need the room where the device's own block lies."""
    shutil.copytree(ROOT / "spec", folder)
    path = folder / "tmcm3230.yaml"
    text = path.read_text(encoding="utf-8")
    for old, new in (
        ("  count: 3", f"  count: {axes}"),
        ("{first: 0x2700, last: 0x27FF}", "{first: 0x3000, last: 0x30FF}"),
        ("device_block: 0x2700", "device_block: 0x3000"),
    ):
        if old not in text:
            sys.exit(f"{path.name} no longer has `{old}`: say anew how its axes are changed")
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path


def size_with(axes: int, folder: Path) -> int:
    """Bytes of rows and search of the TMCM-3230 with another number of axes."""
    generated = folder / f"generated{axes}"
    write(CBackend().render(compile_file(spec_with(axes, folder / f"spec{axes}"))), generated)
    source = generated / "tmcm3230" / "c" / "tmcm3230_od.c"
    (path,) = compile_objects([source], "tmcm3230", folder / f"axes{axes}", generated=generated)
    return dictionary_size(path)[0]


def print_runtime(sizes: dict[str, Sections]) -> None:
    print("Runtime, bytes             text  rodata    data     bss")
    total = sum(sizes.values(), NO_SECTIONS)
    for name, size in {**sizes, "all": total}.items():
        print(f"  {name:<22} {size.text:>6}  {size.rodata:>6}  {size.data:>6}  {size.bss:>6}")
    beyond = sum(size.flash for name, size in sizes.items() if name in BEYOND_301)
    print(f"  without {', '.join(BEYOND_301)}: {total.flash - beyond}")


def print_device(device: str, folder: Path) -> None:
    tables, memory = table_sizes(device, folder), memory_sizes(device, folder)
    print(f"\n{device}, flash")
    for name, size in {**tables, "all": sum(tables.values())}.items():
        print(f"  {name:<30} {size:>6}")
    print(f"{device}, RAM")
    for name, text in STATE.items():
        print(f"  {text:<30} {memory[name]:>6}")
    print(f"  {'the node and its time':<30} {memory['node'] - sum(memory[name] for name in STATE):>6}")
    for name in ("axes", "rpdos", "tpdos", "mapped", "buffer"):
        print(f"  {name:<30} {memory[name]:>6}")
    print(f"  {'all state':<30} {memory['all'] - memory['values']:>6}")
    print(f"  {'values of the dictionary':<30} {memory['values']:>6}")


def main() -> int:
    require("arm-none-eabi-gcc", "arm-none-eabi-size", "arm-none-eabi-nm")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print("Cortex-M4, -Os\n")
        print_runtime(runtime_sizes(folder))
        for device in DEVICES:
            print_device(device, folder)
        sizes = {axes: size_with(axes, folder) for axes in (1, 3, 6)}
    print("\nRows and search of one device with 1, 3 and 6 axes: " + ", ".join(map(str, sizes.values())))
    growth = sizes[6] / sizes[1]
    fine = growth <= MOST_GROWTH and sizes[6] <= MOST_FOR_SIX_AXES
    print(
        f"  six axes take {growth:.3f} times what one takes, allowed {MOST_GROWTH:.2f}; most bytes {MOST_FOR_SIX_AXES}:"
        f" {'ok' if fine else 'MISSED'}"
    )
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
