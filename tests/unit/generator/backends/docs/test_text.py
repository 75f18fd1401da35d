"""Text in the reference: whatever it is, a reader sees it as it was written."""

from __future__ import annotations

import html as html_module
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from odsmith import escape
from odsmith.backends.docs.text import Piece, Reader, code, html, html_link, joined, markdown, plain

LINKS = {"6040h": "objects-profile.md#6040h", "E20": "errata.md#E20", "target_position": "objects-profile.md#607Ah"}
TRICKY = st.lists(
    st.sampled_from(
        [*"-+=*_`|\\<>[]()!#&~$.:;'\"\n\t 1a", "6040h", "E20", "target_position", "```", "&lt;", "1. ", "  "]
    )
    | st.characters(),
    max_size=30,
).map("".join)


def folded(text: str) -> str:
    """The text on one line, single blanks between words."""
    return re.sub(" +", " ", escape.one_line(text))


def shown(markdown_text: str) -> str:
    """What a reader sees of one line of Markdown."""
    tokens = MarkdownIt("commonmark").enable("table").parse(markdown_text)
    assert [token.type for token in tokens] == ["paragraph_open", "inline", "paragraph_close"], markdown_text
    children = tokens[1].children or []
    assert not [child for child in children if child.type not in ("text", "text_special")], markdown_text
    return "".join(child.content for child in children)


@given(TRICKY)
def test_plain_text_survives_markdown(text: str) -> None:
    line = markdown(text)
    assert "\n" not in line
    if escape.one_line(text):
        assert folded(shown(line)) == folded(text)


@given(TRICKY)
def test_plain_text_survives_a_cell_of_a_table(text: str) -> None:
    table = f"| a | b |\n|---|---|\n| {markdown(text)} | end |\n"
    tokens = MarkdownIt("commonmark").enable("table").parse(table)
    cells = [token.content for token in tokens if token.type == "inline"]
    assert len(cells) == 4
    assert cells[3] == "end"


@given(TRICKY)
def test_text_with_mentions_survives_a_cell_of_a_table(text: str) -> None:
    table = f"| a | b |\n|---|---|\n| {markdown(Reader(LINKS)(text))} | end |\n"
    tokens = MarkdownIt("commonmark").enable("table").parse(table)
    inline = [token for token in tokens if token.type == "inline"]
    assert len(inline) == 4
    assert inline[3].content == "end"
    pieces = inline[2].children or []
    seen = "".join(piece.content for piece in pieces)
    assert folded(seen.replace("`", "")) == folded(escape.one_line(text).replace("`", ""))
    links = {piece.attrs["href"] for piece in pieces if piece.type == "link_open"}
    assert links <= set(LINKS.values())
    assert not [piece for piece in pieces if piece.type in ("image", "html_inline", "em_open", "strong_open")]


@given(TRICKY)
def test_text_survives_html(text: str) -> None:
    assert folded(html_module.unescape(html(text))) == folded(text)
    assert not re.search(r"[<>\"']", html(text))


@given(TRICKY)
def test_text_with_mentions_survives_html(text: str) -> None:
    spelled = html(Reader(LINKS)(text))
    bare = re.sub(r'<a href="#[\w-]+">|</a>|<code>|</code>', "", spelled)
    assert not re.search(r"[<>\"']", bare)
    assert folded(html_module.unescape(bare).replace("`", "")) == folded(escape.one_line(text).replace("`", ""))


def test_mentions_become_links() -> None:
    read = Reader(LINKS)
    assert read("See 6040h, E20 and target_position.") == (
        Piece("See "),
        Piece("6040h", LINKS["6040h"]),
        Piece(", "),
        Piece("E20", LINKS["E20"]),
        Piece(" and "),
        Piece("target_position", LINKS["target_position"], code=True),
        Piece("."),
    )
    assert read("`save` or `6040h`") == (
        Piece("save", code=True),
        Piece(" or "),
        Piece("6040h", LINKS["6040h"], code=True),
    )


@pytest.mark.parametrize(
    "text", ["7777h", "16040h", "6040hx", "E21", "E200", "not_known", "6040", "my_target_position"]
)
def test_what_only_looks_like_a_mention_stays_text(text: str) -> None:
    assert Reader(LINKS)(text) == (Piece(text),)


def test_an_exclamation_mark_before_a_link_makes_no_image() -> None:
    assert markdown(Reader(LINKS)("Beware!6040h")) == r"Beware\![6040h](objects-profile.md#6040h)"


def test_code_that_would_end_its_span_or_cell_is_plain() -> None:
    assert markdown(code("a_b")) == "`a_b`"
    assert markdown(code("a`b")) == r"a\`b"
    assert markdown(code("a|b")) == r"a\|b"
    assert html(code("a<b")) == "<code>a&lt;b</code>"


@pytest.mark.parametrize(
    ("text", "line"), [("- a", r"\- a"), ("1. a", r"1\. a"), ("12) a", r"12\) a"), ("3.22", "3.22"), ("=", r"\=")]
)
def test_text_starts_no_list_and_underlines_nothing(text: str, line: str) -> None:
    assert markdown(text) == line


def test_joined_puts_separators_between() -> None:
    assert joined([plain("a"), plain("b")], " or ") == (Piece("a"), Piece(" or "), Piece("b"))
    assert joined([]) == ()


def test_a_page_is_its_own_anchor_in_html() -> None:
    assert html_link("pdos.md") == "#pdos"
    assert html_link("pdos.md#rpdo-1") == "#rpdo-1"
