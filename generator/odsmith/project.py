"""Where specs are found, and what a build of them consists of."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from odsmith.backends import BUILT_IN, backend
from odsmith.compile import Compiled, compile_spec
from odsmith.errors import SpecError, UsageError
from odsmith.model import Device
from odsmith.render import Output, data_folder

_ROOT = re.compile(rb"^(device|vocabulary):", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Root:
    """A YAML file that describes a device or a vocabulary, under the name that the command line knows it by."""

    name: str
    path: Path


def roots(folder: Path) -> list[Root]:
    """The files of a project: `spec/*.yaml` and `spec/cia/*.yaml` that have a `device:` or `vocabulary:` section."""
    spec = folder / "spec"
    if not spec.is_dir():
        raise UsageError(
            f"there is no folder spec/ in {folder}", "change to a project, or name a file: odsmith build my_drive.yaml"
        )
    candidates = [*sorted((spec / "cia").glob("*.yaml")), *sorted(spec.glob("*.yaml"))]
    found = [Root(path.stem, path) for path in candidates if _is_root(path)]
    if not found:
        raise UsageError(f"no file in {spec} has a `device:` section", "add one, see the manual of the format")
    return found


def _is_root(path: Path) -> bool:
    try:
        return bool(_ROOT.search(path.read_bytes()))
    except OSError:
        return True  # let the loader say what is wrong with it


def select(folder: Path, wanted: Sequence[str]) -> list[Root]:
    """The roots that a command line names: files, names of the project, or names of the packaged spec library."""
    if not wanted:
        return roots(folder)
    return list(dict.fromkeys(_select_one(folder, name) for name in wanted))


def _select_one(folder: Path, name: str) -> Root:
    path = Path(name)
    if path.suffix in (".yaml", ".yml") or path.is_file():
        return Root(path.stem, path)
    known = {root.name: root for root in roots(folder)} if (folder / "spec").is_dir() else {}
    if name in known:
        return known[name]
    if (packaged := packaged_spec(name)) is not None:
        return Root(name, packaged)
    raise UsageError(f"there is no device `{name}`", known_hint([*known, *packaged_names()]))


def packaged_spec(name: str) -> Path | None:
    """The file of a device or vocabulary that odsmith brings along."""
    library = data_folder("spec")
    for packaged in (library / f"{name}.yaml", library / name / f"{name}.yaml"):
        if isinstance(packaged, Path) and packaged.is_file():
            return packaged
    return None


def packaged_names() -> list[str]:
    """The devices that odsmith brings along."""
    files = (file for file in data_folder("spec").iterdir() if isinstance(file, Path) and file.suffix == ".yaml")
    return sorted(file.stem for file in files if b"\ndevice:" in file.read_bytes())


def known_hint(names: Iterable[str]) -> str:
    """What somebody could have meant who named nothing that there is."""
    return f"known: {', '.join(dict.fromkeys(names)) or 'none'}; or name a YAML file"


def compile_all(selected: Iterable[Root]) -> list[Compiled]:
    """Compile every root. Raises SpecError with the errors of all of them."""
    compiled: list[Compiled] = []
    failed: list[SpecError] = []
    for root in selected:
        try:
            compiled.append(compile_spec(root.path))
        except SpecError as error:
            failed.append(error)
    if failed:
        raise SpecError(
            (diagnostic for error in failed for diagnostic in error.diagnostics),
            {path: text for error in failed for path, text in error.texts.items()},
        )
    return compiled


def devices(compiled: Iterable[Compiled]) -> list[Device]:
    """The devices among the models."""
    return [item.model for item in compiled if isinstance(item.model, Device)]


def render_all(compiled: Iterable[Compiled], names: Sequence[str] = ()) -> list[Output]:
    """The outputs of the backends called `names` (all built-in ones if empty) for every model.

    Raises UsageError where two models would write the same files, UnknownBackendError for a name that nobody has, and
    SpecError for a model that a backend cannot put into its language.
    """
    compiled = list(compiled)
    for identifier, models in Counter(item.model.identifier for item in compiled).items():
        if models > 1:
            raise UsageError(f"{models} of these files describe `{identifier}`", "build them into different folders")
    chosen = [backend(name) for name in dict.fromkeys(names or BUILT_IN)]
    outputs: list[Output] = []
    for item in compiled:
        try:
            outputs += [output for each in chosen for output in each.render(item.model)]
        except SpecError as error:
            error.texts = item.loaded.texts
            raise
    return outputs
