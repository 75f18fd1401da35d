"""`make bench-c`: what the C runtime costs, beside published figures of other stacks and what is to be reached.

Instructions are counted, not timed: on this machine by callgrind, on a Cortex-M4 by QEMU. `net` is without the harness,
whose own cost is measured in the same run; `as peers` holds as many instructions of harness as the peers' figures do.
Whatever is not installed is named and left out.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from arm import FLAGS, TOOLS, compile_objects, device_sources, includes, run, runtime_sources
from sizes import BEYOND_301, memory_sizes, runtime_sizes, table_sizes
from stack import report as report_stack

HERE = Path(__file__).parent
DEVICE = "tmcm6212"
PEERS = ("CANopenNode", "canopen-stack", "lely-core")

HARNESS = {
    "upload": "call_and_send",
    "download": "call_and_send",
    "tpdo": "call_and_send",
    "rpdo": "call",
    "find": "find_nothing",
    "tick": "no_tick",
    "motion": "no_tick",
}
"""The case that holds nothing but the harness of another one."""

WHAT = {
    "upload": "expedited upload",
    "download": "expedited download",
    "find": "look-up",
    "find_worst": "look-up, worst",
    "rpdo": "RPDO of 6 octets",
    "tpdo": "SYNC and TPDO of 6 octets",
    "tick": "1 ms with nothing to do",
    "motion": "1 ms of six moving axes",
    "code": "code of CiA 301",
    "state": "RAM of a node",
    "dictionary_flash": "dictionary in flash",
    "dictionary_ram": "dictionary in RAM",
    "values": "values in RAM",
}


RUNS = 5
NS_PER_TICK = 1_000_000


@dataclass(frozen=True)
class Count:
    """Instructions of one operation: mean and most of all in a case."""

    mean: float
    worst: float


def defines() -> list[str]:
    return [f'-DDEVICE_HEADER="{DEVICE}.h"', f"-DDEVICE={DEVICE}_t", f"-DINIT={DEVICE}_init"]


def sources() -> list[Path]:
    return [HERE / "c" / "cases.c", *runtime_sources(), *device_sources(DEVICE)]


def count_on_host(folder: Path) -> dict[str, Count]:
    """By case. callgrind writes a file for each dump that the program asks for."""
    binary = folder / "host"
    run(
        [
            "gcc",
            "-O2",
            "-g",
            "-std=gnu99",
            *defines(),
            *includes(DEVICE),
            *sources(),
            HERE / "c" / "host.c",
            "-o",
            binary,
        ]
    )
    run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder / 'callgrind.out'}", "-q", binary])
    means: dict[str, float] = {}
    single: dict[str, list[float]] = {}
    for path in folder.glob("callgrind.out.*"):
        text = path.read_text(encoding="utf-8")
        asked = re.search(r"^desc: Trigger: Client Request: (\w+) (\d+)$", text, re.MULTILINE)
        total = re.search(r"^(?:totals|summary): (\d+)$", text, re.MULTILINE)
        if asked and total:
            if asked[1].startswith("single_"):
                single.setdefault(asked[1].removeprefix("single_"), []).append(float(total[1]))
            else:
                means[asked[1]] = int(total[1]) / int(asked[2])
    return {name: Count(mean, max(single.get(name, [mean]))) for name, mean in means.items()}


def count_on_cortex_m4(folder: Path) -> dict[str, Count]:
    """By case, from the lines that the program prints."""
    objects = compile_objects([*sources(), HERE / "c" / "cortex_m4.c"], DEVICE, folder / "m4", *defines())
    binary = folder / "cortex_m4.elf"
    link = ["-nostartfiles", "--specs=nano.specs", "-T", str(HERE / "c" / "cortex_m4.ld")]
    run([f"{TOOLS}gcc", *FLAGS, *link, *map(str, objects), "-o", str(binary)])
    machine = ["-machine", "mps2-an386", "-icount", "shift=10,sleep=off"]
    console = ["-display", "none", "-chardev", "stdio,id=out", "-semihosting-config", "enable=on,chardev=out"]
    counts = {}
    for line in run(["qemu-system-arm", *machine, *console, "-kernel", str(binary)]).splitlines():
        name, operations, total, worst = line.split()
        counts[name] = Count(int(total) / int(operations) / 10, int(worst) / 10)
    return counts


def flat(counts: dict[str, Count]) -> dict[str, float]:
    """Net instructions by what is compared."""
    net = {name: counts[name].mean - counts[harness].mean for name, harness in HARNESS.items()}
    net["find_worst"] = counts["find"].worst - counts["find_nothing"].worst
    return net


def print_row(what: str, ours: float, shown: str, figures: dict[str, int]) -> None:
    peers = "  ".join(f"{figures.get(peer, '-'):>13}" for peer in PEERS)
    verdict = "ok" if round(ours) <= figures["target"] else "MISSED"
    print(f"  {what:<28} {shown:>18}  {figures['target']:>7}  {verdict:<6}  {peers}")


def print_head(title: str, columns: str) -> None:
    print(f"\n{title}\n  {'':<28} {columns:>18}  {'target':>7}  {'':<6}  " + "  ".join(f"{peer:>13}" for peer in PEERS))


def print_counts(title: str, counts: dict[str, Count], figures: dict[str, dict[str, int]], harness: int) -> None:
    """Look-ups and ticks are compared without any harness, as the peers' are; the rest with the peers'."""
    print_head(title, "net       as peers")
    for name, net in flat(counts).items():
        if name in figures:
            held = harness if HARNESS.get(name, "").startswith("call") else 0
            print_row(WHAT[name], net + held, f"{net:8.1f}  {net + held:8.1f}", figures[name])
    own = {name: counts[name].mean for name in dict.fromkeys(HARNESS.values())}
    print(
        "  our harness: " + ", ".join(f"{name} {mean:.1f}" for name, mean in own.items()) + f"; the peers': {harness}"
    )
    worst = ", ".join(f"{name} {counts[name].worst - counts[HARNESS[name]].worst:.0f}" for name in HARNESS)
    if any(count.worst != count.mean for name, count in counts.items() if not name.startswith("find")):
        print(f"  the worst single operation, net: {worst}")


def print_footprint(folder: Path, figures: dict[str, dict[str, int]]) -> None:
    runtime, tables, memory = runtime_sizes(folder), table_sizes(DEVICE, folder), memory_sizes(DEVICE, folder)
    ours = {
        "code": sum(size.flash for name, size in runtime.items() if name not in BEYOND_301),
        "state": memory["all"] - memory["values"],
        "dictionary_flash": tables["dictionary: rows and search"],
        "dictionary_ram": 0,
        "values": memory["values"],
    }
    print_head("Cortex-M4 -Os, bytes (make sizes has them by module)", "bytes")
    for name, size in ours.items():
        print_row(WHAT[name], size, str(size), figures[name])


def print_speed(folder: Path) -> None:
    """How much faster than the clock the node moves its axes, the best of some runs."""
    counted = (run([folder / "host", "motion"]).split() for _ in range(RUNS))
    best = max(int(operations) * NS_PER_TICK / float(nanoseconds) for operations, nanoseconds in counted)
    print(f"  six moving axes run {best:,.0f} times as fast as in real time, the best of {RUNS} runs")


def available(*programs: str) -> bool:
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        print(f"\n{', '.join(missing)}: not installed, so this part is left out")
    return not missing


def main() -> int:
    figures: dict[str, Any] = yaml.safe_load((HERE / "peers.yaml").read_text(encoding="utf-8"))
    print(f"{DEVICE}; the peers' figures are published ones, taken in the same way:")
    for name, stack in figures["stacks"].items():
        print(f"  {name} {stack['commit']}, {stack['repository']}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if available("gcc", "valgrind"):
            version = subprocess.run(["gcc", "-dumpversion"], capture_output=True, text=True, check=True).stdout.strip()
            counts = count_on_host(folder)
            print_counts(f"This machine, gcc {version} -O2, instructions", counts, figures["host"], figures["harness"])
            print_speed(folder)
        if available("arm-none-eabi-gcc", "qemu-system-arm"):
            counts = count_on_cortex_m4(folder)
            print_counts("Cortex-M4 -Os, instructions", counts, figures["cortex_m4"], figures["harness"])
        if available("arm-none-eabi-gcc"):
            print_footprint(folder, figures["footprint"])
            print()
            report_stack(runtime_sources(), folder / "calls")
    return 0


if __name__ == "__main__":
    sys.exit(main())
