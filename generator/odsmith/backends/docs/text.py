"""Text for the reference: written once as pieces, then spelled as Markdown or as HTML.

A text from the spec may mention things by the names that readers use: `6065h`, `E20`, `profile_velocity`. Where the
model has them, they become links. Everything else is plain text, whatever it contains.
"""

from __future__ import annotations

import html as html_module
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from odsmith import escape


class Piece(NamedTuple):
    """A stretch of text. `link` is `page.md#anchor`, relative to the folder of the reference; empty for none."""

    text: str
    link: str = ""
    code: bool = False


Rich = tuple[Piece, ...]
"""A text as its pieces, in order."""


def plain(text: str) -> Rich:
    return (Piece(text),)


def code(text: str, link: str = "") -> Rich:
    """A name or a number as it is typed."""
    return (Piece(text, link, code=True),)


def joined(texts: Iterable[Rich], separator: str = ", ") -> Rich:
    """Texts in a row with a separator between them."""
    pieces: list[Piece] = []
    for text in texts:
        if pieces:
            pieces.append(Piece(separator))
        pieces.extend(text)
    return tuple(pieces)


_MENTION = re.compile(
    r"`(?P<code>[^`\s](?:[^`]*[^`\s])?)`|\b(?P<name>[0-9A-F]{8}h|[0-9A-F]{4}h|E[0-9]+|[a-z][a-z0-9]*(?:_[a-z0-9]+)+)\b"
)


@dataclass
class Reader:
    """Finds what a text mentions. `links` maps a name as it stands in texts to `page.md#anchor`."""

    links: Mapping[str, str]
    _read: dict[str, Rich] = field(default_factory=dict)

    def __call__(self, text: str) -> Rich:
        """The pieces of a text; white space is folded first, so that pieces keep the blanks between them."""
        found = self._read.get(text)
        if found is None:
            plain_already = text.isascii() and text.isprintable()  # the usual case, and much faster to find out
            found = self._read[text] = tuple(self._pieces(text if plain_already else escape.one_line(text)))
        return found

    def _pieces(self, text: str) -> list[Piece]:
        pieces, done = [], 0
        for match in _MENTION.finditer(text):
            name = match["code"] or match["name"]
            link = self.links.get(name, "")
            if not link and not match["code"]:
                continue
            if match.start() > done:
                pieces.append(Piece(text[done : match.start()]))
            pieces.append(Piece(name, link, code=match["code"] is not None or "_" in name))
            done = match.end()
        if done < len(text):
            pieces.append(Piece(text[done:]))
        return pieces


# Most text is harmless as it is, and a search finds that out faster than escaping does: printable ASCII without the
# characters that mean something.
_NOT_PLAIN_IN_MARKDOWN = re.compile(r"[^ !\"%'()+-;=?-Z^a-z]")
_NOT_PLAIN_IN_HTML = re.compile(r"[^ !#-%(-;=?-~]")


def _spelled(text: str, not_plain: re.Pattern[str], escaped: Callable[[str], str]) -> str:
    """A stretch of text in a target language. Escaping strips it; between two pieces its outer blanks count."""
    if not not_plain.search(text):
        return text
    head = " " if text[:1] == " " else ""
    tail = " " if text[-1:] == " " and text.strip() else ""
    return head + escaped(text) + tail


# ---- Markdown --------------------------------------------------------------------------------------------------------

_BLOCK = re.compile(r"(?=[-+=])|[0-9]{1,9}(?=[.)](?:\s|$))")


def markdown(text: str | Rich) -> str:
    """Text on one line of Markdown, at its start or in a table cell; plain text is not searched for mentions."""
    if isinstance(text, str):
        line = _spelled(text, _NOT_PLAIN_IN_MARKDOWN, escape.markdown).strip()
    else:
        line = "".join(map(_markdown_piece, text))
    # No list, rule or underline of a heading at the start of a line.
    return _BLOCK.sub(lambda match: match[0] + "\\", line, count=1) if _BLOCK.match(line) else line


def _markdown_piece(piece: Piece) -> str:
    text, link, is_code = piece
    if is_code:
        spelled = markdown_code(text)
    else:
        spelled = _spelled(text, _NOT_PLAIN_IN_MARKDOWN, escape.markdown)
        if spelled.endswith("!"):  # a link may follow, which it would make an image
            spelled = spelled[:-1] + "\\!"
    return f"[{spelled}]({link})" if link else spelled


def markdown_code(text: str) -> str:
    """A code span; text that could end it, or a table cell around it, stays plain (no escapes work in there)."""
    safe = text if text.isascii() and text.isprintable() else escape.one_line(text)
    return escape.markdown(text) if not safe or "`" in safe or "|" in safe else f"`{safe}`"


# ---- HTML ------------------------------------------------------------------------------------------------------------


def html(text: str | Rich) -> str:
    """Text in the content of an element; in a quoted attribute too, unless it has pieces."""
    if isinstance(text, str):
        return _spelled(text, _NOT_PLAIN_IN_HTML, escape.html_text).strip()
    return "".join(map(_html_piece, text))


def _html_piece(piece: Piece) -> str:
    text, link, is_code = piece
    spelled = _spelled(text, _NOT_PLAIN_IN_HTML, escape.html_text)
    if is_code:
        spelled = f"<code>{spelled}</code>"
    return f'<a href="{html_link(link)}">{spelled}</a>' if link else spelled


def html_link(link: str) -> str:
    """A link as it is in the single page: there the anchors of all pages are unique, a page is its own anchor."""
    page, _, anchor = link.partition("#")
    return "#" + html_module.escape(anchor or page.removesuffix(".md"))
