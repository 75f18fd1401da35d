"""The linter of EDS and DCF files: does every tool that reads such files understand this one, and does it make sense?

A rule is a function that looks at a `Sheet` for one idea and yields findings; its explanation stands in the registry
of all rules, `odsmith.rules`. None of them changes anything, and none fails whatever the file contains.
"""

from __future__ import annotations

from odsmith.eds_file import EdsFile
from odsmith.errors import Diagnostic, in_order
from odsmith.lint import axes, dcf, device, form, keys, lists, objects, pdos, sections, values
from odsmith.lint.sheet import Rule, sheet

RULES: tuple[Rule, ...] = tuple(
    rule for module in (form, sections, keys, lists, device, dcf, objects, values, pdos, axes) for rule in module.RULES
)


def lint(file: EdsFile) -> tuple[Diagnostic, ...]:
    """Everything that is wrong with a file, in the order of its lines."""
    examined = sheet(file)
    return in_order(finding for rule in RULES for finding in rule(examined))
