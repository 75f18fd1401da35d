"""The reference: Markdown pages that a repository shows, and one HTML page that needs nothing else.

Each fact is put into words once (`objects`, `view`); the templates lay the words out, twice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from odsmith import escape
from odsmith.backends.docs import view as docs_view
from odsmith.backends.docs.coverage import coverage_view
from odsmith.backends.docs.diagram import Arrow, draw
from odsmith.backends.docs.links import element_links, hexadecimal, mentions, pages
from odsmith.backends.docs.objects import EDS_AXES, ObjectWriter
from odsmith.backends.docs.text import Reader, html, html_link, markdown, markdown_code
from odsmith.model import Device
from odsmith.render import MARK, Backend, Output, Templates
from odsmith.rules import RULES
from odsmith.vocabulary import Vocabulary


class DocsBackend(Backend):
    """Writes the Markdown reference and `index.html` of a device; of the vocabulary its words, the manual of the spec
    format and the list of rules."""

    name = "docs"
    filters: Mapping[str, Callable[..., Any]] = {
        "md": markdown,
        "md_code": markdown_code,
        "html": html,
        "target": html_link,
        "mermaid": escape.mermaid,
        "hex": hexadecimal,
    }

    def render(self, model: Device | Vocabulary) -> list[Output]:
        """All pages; of a device those that it has something to fill with."""
        outputs = super().render(model)
        if not isinstance(model, Device):
            return [*outputs, *self._rule_pages(model)]
        files = {"README.md", "index.html", *(page.file for page in pages(model))}
        return [output for output in outputs if output.path.rsplit("/", 1)[-1] in files]

    def _rule_pages(self, vocabulary: Vocabulary) -> Iterator[Output]:
        """A page for each rule, so that a finding can be looked up by a link of its own."""
        templates = Templates(self.template_root(), self.name)
        templates.filters.update(self.filters)
        context = self.vocabulary_context(vocabulary)
        for rule in RULES.values():
            text = templates.render("docs/vocabulary/_rule.md.j2", {**context, "rule": rule})
            yield Output(f"{vocabulary.identifier}/docs/rules/{rule.id}.md", text.encode())

    def device_context(self, device: Device) -> Mapping[str, object]:
        present = pages(device)
        elements = element_links(device, present)
        read = Reader(mentions(device, elements))
        objects = ObjectWriter(device, elements, read)
        writer = docs_view.DeviceWriter(device, elements, read)
        transitions = writer.transitions()
        return {
            "mark": MARK,
            "device": device,
            "identity": device.identity,
            "pages": present,
            "has": {page.file.removesuffix(".md") for page in present},
            "axes": range(device.axes),
            "eds_axes": EDS_AXES,
            "areas": list(docs_view.arithmetic(device)),
            "facts": list(docs_view.features(device)),
            "read": read,
            "object_pages": {page.file: page for page in objects.pages()},
            "pdo_tables": writer.pdo_tables(),
            "modes": writer.modes(),
            "homing": writer.homing(),
            "ramp": list(writer.ramp()),
            "states": writer.states(),
            "commands": writer.commands(),
            "transitions": transitions,
            "drawing": draw(
                [state.name for state in device.pds_states],
                [Arrow(str(t.number), t.label, t.starts, t.end) for t in transitions],
            ),
            "state_titles": {state.name: state.title for state in device.pds_states},
            "powered": {state.name: state.power for state in device.pds_states},
            "emergencies": writer.emergencies(),
            "leds": writer.leds(),
            "groups": list(writer.groups()),
            "errata": writer.errata_list(),
            "differences": writer.differences(),
            "coverage": coverage_view(device, elements, read),
            "source": writer.source,
        }

    def vocabulary_context(self, vocabulary: Vocabulary) -> Mapping[str, object]:
        from odsmith.backends.docs.format import manual, read_schema  # a device's build has no use for these

        read = Reader({})
        return {
            "mark": MARK,
            "vocabulary": vocabulary,
            "read": read,
            "state_pattern": docs_view.state_pattern,
            "command_pattern": docs_view.command_pattern,
            "phases": docs_view.phases,
            "words": docs_view.words,
            "format": manual(read_schema()),
            "rules": list(RULES.values()),
        }
