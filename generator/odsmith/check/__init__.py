"""The fourth pass: do the facts make sense together? The model is complete by now; nothing here changes it."""

from __future__ import annotations

from odsmith.check.dictionary import check_dictionary
from odsmith.check.drive import check_drive, check_vocabulary
from odsmith.check.errata import check_errata
from odsmith.check.identifiers import check_identifiers, check_roles
from odsmith.check.pdos import check_pdos
from odsmith.check.places import Places
from odsmith.errors import Diagnostic
from odsmith.load import Map
from odsmith.model import Device
from odsmith.vocabulary import Vocabulary


def check(model: Device | Vocabulary, spec: Map) -> list[Diagnostic]:
    """Every finding about a model, errors and warnings; `spec` is the merged tree that it was resolved from."""
    findings = [*check_vocabulary(model), *check_roles(model)]
    if isinstance(model, Device):
        places = Places(spec)
        findings += check_dictionary(model, places)
        findings += check_pdos(model, places)
        findings += check_drive(model)
        findings += check_identifiers(model)
        findings += check_errata(model, spec)
    return findings
