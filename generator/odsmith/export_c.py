"""A device and the C runtime as a CMake project that builds on its own.

    CMakeLists.txt README.md PORTING.md LICENSE
    include/ods/        headers of the runtime, those of the vocabulary included
    src/                the runtime
    device/             what the C backend makes of the device
    port/               examples of programs around it
    .odsmith-export.json    what was written, so that the next export knows its own files from those of others

The examples and the guide are written for one device, so that they are real C where they are kept. Here the name of the
exported device takes its place.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import distributions
from importlib.resources.abc import Traversable
from pathlib import Path, PurePosixPath

from odsmith import escape, names
from odsmith.compile import Compiled, compile_spec
from odsmith.errors import UsageError, listed, quoted
from odsmith.model import Device
from odsmith.project import render_all
from odsmith.render import Differences, Output, Templates, data_folder, write

RECORD = ".odsmith-export.json"

EXAMPLE = "tmcm6212"
"""The device of the examples and of the guide."""

_MARK = "Written by `odsmith export-c`."


@dataclass(frozen=True, slots=True)
class Record:
    """What an earlier export wrote: the device, and the SHA-256 of each file by its path."""

    device: str
    files: Mapping[str, str]


def project(compiled: Compiled) -> list[Output]:
    """The files of the project of a device, by path; the record is the last one.

    Raises UsageError for a model that is no device, and SpecError for one that C cannot express.
    """
    device = compiled.model
    if not isinstance(device, Device):
        raise UsageError(f"{quoted(device.identifier)} is no device but a vocabulary", "`odsmith list` names devices")
    identifier = device.identity.identifier
    outputs = [*_generated(compiled, "device/"), *_generated(_vocabulary(), "include/"), *_runtime(identifier)]
    outputs.append(Output("LICENSE", _licence()))
    outputs += _described(device, [output.path for output in outputs])
    outputs.sort(key=lambda output: output.path)
    record = {"device": identifier, "files": {output.path: _digest(output.content) for output in outputs}}
    return [*outputs, Output(RECORD, (json.dumps(record, indent=2) + "\n").encode())]


def _vocabulary() -> Compiled:
    """What the runtime speaks: the vocabulary that is packaged with it, not one of somebody's project."""
    return compile_spec(Path(str(data_folder("spec"))) / "cia" / "cia.yaml")


def _generated(compiled: Compiled, folder: str) -> Iterator[Output]:
    for output in render_all([compiled], ["c"]):
        yield Output(folder + output.path.split("/", 2)[2], output.content)


def _runtime(identifier: str) -> Iterator[Output]:
    root = data_folder("runtime_c")
    for folder in ("include", "src", "port"):
        for path, file in _files(root.joinpath(folder), f"{folder}/"):
            if path.endswith((".c", ".h")):
                yield Output(path, _renamed(file, identifier) if folder == "port" else file.read_bytes())
    yield Output("PORTING.md", _renamed(root.joinpath("README.md"), identifier))


def _files(folder: Traversable, prefix: str) -> Iterator[tuple[str, Traversable]]:
    for item in folder.iterdir():
        if item.is_dir():
            yield from _files(item, f"{prefix}{item.name}/")
        else:
            yield prefix + item.name, item


def _renamed(file: Traversable, identifier: str) -> bytes:
    text = file.read_text(encoding="utf-8").replace(EXAMPLE, identifier)
    return text.replace(names.constant(EXAMPLE), names.constant(identifier)).encode()


def _licence() -> bytes:
    """The licence as the installed distribution has it; an editable installation has it too.

    The first distribution of this name need not be that one: a build leaves an egg-info in the checkout, without it.
    """
    texts = (found.read_text("licenses/LICENSE") for found in distributions(name="odsmith"))
    text = next(filter(None, texts), None)
    if text is None:
        raise UsageError("the licence is missing from the installed odsmith", "install it again")
    return text.encode()


def _described(device: Device, paths: Sequence[str]) -> list[Output]:
    """The files that describe the others."""
    templates = Templates(data_folder("templates"), "export_c")
    templates.filters["markdown"] = escape.markdown
    sources = sorted(path for path in paths if path.endswith(".c"))
    identifier = device.identity.identifier
    context = {
        "export_mark": _MARK,
        "identity": device.identity,
        "prefix": identifier,
        "PREFIX": names.constant(identifier),
        "library": [path for path in sources if path.startswith(("src/", "device/"))],
        "host": [path for path in sources if path.startswith("port/host/")],
        "linux": ["port/host/nvm_file.c", *(path for path in sources if path.startswith("port/linux/"))],
    }
    return [
        Output(
            name.removeprefix("export_c/project/").removesuffix(".j2"), templates.render(name, context).encode("utf-8")
        )
        for name in templates.names("project")
    ]


def export(outputs: Sequence[Output], folder: Path, *, force: bool = False) -> Differences:
    """Make a folder hold the project; each file that differs is written in one step, the record last.

    Files that are no part of the project are left alone. Raises UsageError, before anything is written, where a file
    is in the way that no export wrote or that was changed since, unless `force` says to overwrite it; and where the
    folder has another device.
    """
    earlier = _read_record(folder)
    this = json.loads(outputs[-1].content)["device"]
    if earlier.device not in ("", this) and not force:
        raise UsageError(
            f"{folder} has an export of {quoted(earlier.device)}", "name another folder, or put this one there: --force"
        )
    foreign = [output.path for output in outputs if not _may_write(folder, output, earlier)]
    if foreign and not force:
        shown = (
            listed(foreign[:3], "and") if len(foreign) <= 3 else f"{listed(foreign[:1])} and {len(foreign) - 1} more"
        )
        raise UsageError(
            f"in {folder} {shown} would be overwritten, which odsmith did not write as it is now",
            "name another folder, or overwrite: --force",
        )
    left_over = _left_over(folder, earlier, {output.path for output in outputs})
    differences = write(outputs, folder)
    for path in left_over:
        (folder / path).unlink()
    return Differences(differences.changed, differences.missing, tuple(sorted({*differences.left_over, *left_over})))


def _read_record(folder: Path) -> Record:
    """The record of a folder; an empty one where there is none, or something else of its name."""
    try:
        record = json.loads((folder / RECORD).read_bytes())
        return Record(str(record["device"]), {str(path): str(digest) for path, digest in record["files"].items()})
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return Record("", {})


def _may_write(folder: Path, output: Output, earlier: Record) -> bool:
    """Whether nothing would be lost: there is no such file, or it is as an export left it, or as this one wants it."""
    content = _content(folder / output.path)
    if content is None or content == output.content:
        return True
    if output.path == RECORD:
        return bool(earlier.device)
    return earlier.files.get(output.path) == _digest(content)


def _left_over(folder: Path, earlier: Record, wanted: set[str]) -> list[str]:
    """What an earlier export wrote, nobody has changed, and this one has no more."""
    found = []
    for path, digest in earlier.files.items():
        pure = PurePosixPath(path)
        if path in wanted or pure.is_absolute() or ".." in pure.parts:
            continue
        content = _content(folder / path)
        if content is not None and _digest(content) == digest:
            found.append(path)
    return found


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        return None


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
