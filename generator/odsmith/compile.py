"""The passes in the order in which they run: load, validate, merge, resolve, check. Rendering is the caller's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from odsmith.check import check
from odsmith.errors import Diagnostic, SpecError, in_order
from odsmith.load import Loaded, load
from odsmith.merge import merge
from odsmith.model import Device
from odsmith.render import data_folder
from odsmith.resolve import resolve
from odsmith.validate import validate
from odsmith.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class Compiled:
    """A model with what was noticed on the way, and the files that it was read from."""

    model: Device | Vocabulary
    warnings: tuple[Diagnostic, ...]
    loaded: Loaded


def compile_spec(path: Path) -> Compiled:
    """Compile one root YAML file. Raises SpecError with all errors of the first pass that finds any."""
    loaded = load(path, [data_folder("spec")])
    try:
        validate(loaded)
        spec = merge(loaded)
        model = resolve(spec)
        findings = check(model, spec)
        if any(finding.severity == "error" for finding in findings):
            raise SpecError(findings)
    except SpecError as error:
        error.texts = loaded.texts
        raise
    return Compiled(model, in_order(findings), loaded)


def compile_file(path: Path) -> Device | Vocabulary:
    """The model of one root YAML file; see `compile_spec`."""
    return compile_spec(path).model
