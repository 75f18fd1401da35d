"""The runtime and the generated tables on a Cortex-M4 at -Os: compiling, sizes of sections, symbols and types."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
RUNTIME = ROOT / "runtime_c"
GENERATED = ROOT / "generated"
FLAGS = ("-mcpu=cortex-m4", "-mthumb", "-Os", "-std=c99")
TOOLS = "arm-none-eabi-"


def require(*programs: str) -> None:
    """Ends with exit status 2 and says what is missing."""
    missing = [program for program in programs if shutil.which(program) is None]
    for program in missing:
        print(f"{program} is not installed: nothing was measured", file=sys.stderr)
    if missing:
        sys.exit(2)


def run(command: Iterable[str | Path]) -> str:
    """What a program prints; ends with its messages where it fails."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    return done.stdout


def includes(device: str, generated: Path = GENERATED) -> list[str]:
    """Where the headers of a device, of the vocabulary and of the runtime are."""
    folders = (RUNTIME / "include", GENERATED / "cia" / "c", generated / device / "c")
    return [f"-I{folder}" for folder in folders]


def runtime_sources() -> list[Path]:
    return sorted((RUNTIME / "src").glob("*.c"))


def device_sources(device: str, generated: Path = GENERATED) -> list[Path]:
    return sorted((generated / device / "c").glob("*.c"))


def compile_objects(
    sources: Sequence[Path], device: str, out: Path, *flags: str, generated: Path = GENERATED
) -> list[Path]:
    """An object of each source."""
    out.mkdir(parents=True, exist_ok=True)
    objects = []
    for source in sources:
        objects.append(out / f"{source.stem}.o")
        run([f"{TOOLS}gcc", *FLAGS, *flags, *includes(device, generated), "-c", str(source), "-o", str(objects[-1])])
    return objects


@dataclass(frozen=True)
class Sections:
    """Bytes of an object."""

    text: int
    rodata: int
    data: int
    bss: int

    @property
    def flash(self) -> int:
        return self.text + self.rodata + self.data

    def __add__(self, other: Sections) -> Sections:
        return Sections(
            self.text + other.text, self.rodata + other.rodata, self.data + other.data, self.bss + other.bss
        )


NO_SECTIONS = Sections(0, 0, 0, 0)


def sections(path: Path) -> Sections:
    """Bytes of an object by kind of section."""
    sizes = dict.fromkeys(("text", "rodata", "data", "bss"), 0)
    for line in run([f"{TOOLS}size", "-A", path]).splitlines():
        found = re.match(r"\.(text|rodata|data|bss)[.\w]*\s+(\d+)", line)
        if found:
            sizes[found[1]] += int(found[2])
    return Sections(**sizes)


def symbols(path: Path) -> dict[str, int]:
    """Bytes of each symbol that an object defines."""
    lines = (line.split() for line in run([f"{TOOLS}nm", "-S", path]).splitlines())
    return {line[3]: int(line[1], 16) for line in lines if len(line) == 4}


def sizes_of(types: dict[str, str], device: str, out: Path) -> dict[str, int]:
    """Bytes of C types or expressions, by a name of each."""
    out.mkdir(parents=True, exist_ok=True)
    source = out / "sizes_of.c"
    lines = [f'#include "{device}.h"', *(f"char size_{name}[sizeof({text})];" for name, text in types.items())]
    source.write_text("\n".join(lines) + "\n", encoding="utf-8")
    (path,) = compile_objects([source], device, out, "-fno-common")
    return {name.removeprefix("size_"): size for name, size in symbols(path).items()}
