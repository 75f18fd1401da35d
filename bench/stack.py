"""How deep the stack of a Cortex-M4 gets: the frames that the compiler states, along the calls that it states.

    stack.py [FILE...]      of these C files, or of the runtime

Both come from `gcc -fcallgraph-info=su`, after inlining. A cycle of calls is recursion and ends it with exit status 1.
Calls through a pointer are the callbacks of the port, whose depth is the firmware's business; that no function of the
runtime is called through a pointer follows from nobody taking the address of one, which is looked up in the objects.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from arm import RUNTIME, TOOLS, compile_objects, require, run, runtime_sources

INDIRECT = "__indirect_call"
NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]*)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
FRAME = re.compile(r"(\d+) bytes \((\w+)")
FUNCTION = re.compile(r"\bF\s+\.text\S*\s+[0-9a-f]+\s+(?:\.hidden )?(\S+)$")


@dataclass
class Calls:
    """What functions need themselves, in bytes, and what they call."""

    frames: dict[str, int] = field(default_factory=dict)
    called: dict[str, set[str]] = field(default_factory=dict)
    foreign: set[str] = field(default_factory=set)
    """Functions of the C library and of the compiler: their frames are not known."""


def plain(title: str) -> str:
    """A function of one file alone is called `file.c:name`, without the folder."""
    return title.rsplit("/", 1)[-1]


def read_calls(files: Sequence[Path]) -> Calls:
    """The calls of all `.ci` files together."""
    calls = Calls()
    for path in files:
        for line in path.read_text(encoding="utf-8").splitlines():
            if (node := NODE.match(line)) and (frame := FRAME.search(node[2])):
                if frame[2] != "static":
                    sys.exit(f"{node[1]}: its frame is not of constant size ({frame[2]})")
                calls.frames[plain(node[1])] = int(frame[1])
            elif edge := EDGE.match(line):
                calls.called.setdefault(plain(edge[1]), set()).add(plain(edge[2]))
    named = {name for names in calls.called.values() for name in names}
    calls.foreign = named - set(calls.frames) - {INDIRECT}
    return calls


def check_no_pointers(objects: Sequence[Path]) -> None:
    """Ends where the address of a function is taken: then a call through a pointer could lead to it."""
    functions: set[str] = set()
    for path in objects:
        functions |= {
            found[1] for line in run([f"{TOOLS}objdump", "-t", path]).splitlines() if (found := FUNCTION.search(line))
        }
    for path in objects:
        for line in run([f"{TOOLS}objdump", "-r", path]).splitlines():
            words = line.split()
            if len(words) == 3 and words[1] == "R_ARM_ABS32" and words[2].split("+")[0] in functions | {".text"}:
                sys.exit(f"{path.stem}: takes the address of {words[2]}; the depth of its stack is not known")


def depths(calls: Calls) -> dict[str, int]:
    """Bytes of stack of every function with all that it calls. Ends with the names where functions call in a circle."""
    path: list[str] = []

    @cache
    def depth(name: str) -> int:
        if name in path:
            sys.exit(f"recursion: {' > '.join([*path[path.index(name) :], name])}")
        path.append(name)
        deepest = max((depth(callee) for callee in sorted(calls.called.get(name, ()))), default=0)
        path.pop()
        return calls.frames.get(name, 0) + deepest

    return {name: depth(name) for name in sorted(calls.frames)}


def deepest_path(calls: Calls, name: str) -> list[str]:
    """The calls that make a function as deep as it is."""
    depth = depths(calls)
    path = [name]
    while callees := [callee for callee in calls.called.get(path[-1], ()) if callee in depth]:
        path.append(max(callees, key=lambda callee: depth[callee]))
    return path


def is_public(name: str) -> bool:
    """Whether a firmware calls this function."""
    header = (RUNTIME / "include" / "ods" / "node.h").read_text(encoding="utf-8")
    return re.search(rf"\b{re.escape(name)}\(", header) is not None


def report(sources: Sequence[Path], folder: Path) -> None:
    """Print the depth of every public function and the way to it."""
    objects = compile_objects(sources, "tmcm6212", folder, "-fcallgraph-info=su", "-ffunction-sections")
    check_no_pointers(objects)
    calls = read_calls(sorted(folder.glob("*.ci")))
    deep = depths(calls)
    print("Stack on a Cortex-M4 at -Os, bytes, without the callbacks of the port; nothing calls itself")
    for name in sorted(filter(is_public, deep), key=lambda name: -deep[name]):
        print(f"  {name:<22} {deep[name]:>5}  {' > '.join(deepest_path(calls, name)[1:])}")
    print(f"  not counted, as they are the compiler's or the C library's: {', '.join(sorted(calls.foreign))}")


def main() -> int:
    require(f"{TOOLS}gcc", f"{TOOLS}objdump")
    with tempfile.TemporaryDirectory() as name:
        report([Path(word) for word in sys.argv[1:]] or runtime_sources(), Path(name))
    return 0


if __name__ == "__main__":
    sys.exit(main())
