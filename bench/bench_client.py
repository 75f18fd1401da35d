"""`python bench/bench_client.py`: the client beside python-canopen's, in one run, in turn.

Round trips: reading and writing objects by SDO on the same bus. Three buses: function calls with a server that always
says the same (what a client costs), function calls with a device (what a test costs), and python-can's virtual
interface with a server in another thread (what a thread costs). Start: from a new process to the first value read.
Memory: that of a process that only knows the device, beside one that loads the EDS. `make bench` has the time.
"""

from __future__ import annotations

import argparse
import importlib
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
FOLDERS = [str(ROOT / "generated" / name / "python") for name in ("cia", "tmcm6212")]
sys.path[:0] = FOLDERS


from measure import Series, measure, report  # noqa: E402
from odsmith_runtime.client.virtual import VirtualNetwork  # noqa: E402

EDS = ROOT / "generated" / "tmcm6212" / "eds" / "TMCM-6212.eds"
ANSWER = 0x581


def ours(network: Any) -> Callable[[], None]:
    package = importlib.import_module("tmcm6212")
    waiter = network.waiter() if hasattr(network, "waiter") else None
    axis = package.TMCM6212(network, 1, waiter=waiter).axes[0]

    def trip() -> None:
        _ = axis.statusword.raw
        axis.controlword.raw = 0

    return trip


def theirs(network: Any) -> Callable[[], None]:
    node = network.add_node(1, str(EDS))

    def trip() -> None:
        _ = node.sdo[0x6041].raw
        node.sdo[0x6040].raw = 0

    return trip


def rate(trip: Callable[[], None], trips: int) -> float:
    """Round trips per second; a trip is two of them."""
    start = time.perf_counter()
    for _ in range(trips):
        trip()
    return 2 * trips / (time.perf_counter() - start)


def bench_trips(title: str, make: Callable[[], Any], trips: int, runs: int) -> None:
    networks = make(), make()
    both = ours(networks[0]), theirs(networks[1])
    pairs = [tuple(rate(trip, trips) for trip in both) for _ in range(runs + 1)][1:]
    for network in networks:
        network.disconnect()
    mine, other = (statistics.median(pair[each] for pair in pairs) for each in (0, 1))
    ratio = statistics.median(pair[0] / pair[1] for pair in pairs)
    print(f"  {title:<44} {mine:9.0f} /s   python-canopen {other:9.0f} /s   x {ratio:.2f}")


PATH = f"import sys; sys.path[:0] = {FOLDERS!r}; "
IMPORTS = {
    "Python alone": PATH,
    "import of TMCM6212": PATH + "from tmcm6212 import TMCM6212",
    "import of the dictionary": PATH + "from tmcm6212 import DICTIONARY",
    "... and every entry of it made": PATH
    + "from tmcm6212 import DICTIONARY\nfor key in DICTIONARY: len(DICTIONARY[key])",
    "import of canopen": PATH + "import canopen",
    "canopen.import_od of the EDS": PATH + f"import canopen; canopen.import_od({str(EDS)!r})",
}
"""What a process knows of the device, or of nothing; nobody talks to a bus."""


PEAK = "\nprint(open('/proc/self/status').read().partition('VmHWM:')[2].split()[0])"
"""Peak memory in KiB as the process itself sees it; what its parent is told begins with the parent's own."""


def bench_memory() -> None:
    found = {
        name: int(subprocess.run([sys.executable, "-c", script + PEAK], capture_output=True, check=True).stdout) / 1024
        for name, script in IMPORTS.items()
    }
    base = list(found.values())[-1]
    print("\nPeak memory of a process")
    for name, mebibytes in found.items():
        print(f"  {name:<42} {mebibytes:6.1f} MiB   x {mebibytes / base:.3f}")


START = """
import sys
sys.path[:0] = {folders!r}
import canopen
class Echo(canopen.Network):
    def send_message(self, can_id, data, remote=False):
        self.notify({answer}, bytearray([0x4B, *data[1:4], 0x37, 2, 0, 0]), 0.0)
"""
OURS = START + "from tmcm6212 import TMCM6212\nTMCM6212(Echo()).axes[0].statusword.raw"
THEIRS = START + "Echo().add_node(1, {eds!r}).sdo[0x6041].raw"


def bench_start(runs: int) -> None:
    scripts = (script.format(folders=FOLDERS, answer=ANSWER, eds=str(EDS)) for script in (START, OURS, THEIRS))
    names = ("import canopen, the share of both", "TMCM6212, first value", "python-canopen with the EDS, first value")
    series = [Series(name, [sys.executable, "-c", script]) for name, script in zip(names, scripts, strict=True)]
    measure(series, runs)
    report("Start", series, series[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--trips", type=int, default=500)
    options = parser.parse_args()
    bench_memory()
    bench_start(options.runs)  # first, while this process is small: a child starts with the memory of its parent
    from client_buses import Echo, Threads

    package = importlib.import_module("tmcm6212")
    print(f"\nSDO round trips ({options.runs} runs each, in turn; medians)")
    bench_trips("function calls, a server that always says one", Echo, options.trips, options.runs)
    bench_trips(
        "function calls, the device", lambda: VirtualNetwork(package, engine="auto"), options.trips, options.runs
    )
    bench_trips("python-can's virtual interface", Threads, max(1, options.trips // 5), options.runs)


if __name__ == "__main__":
    main()
