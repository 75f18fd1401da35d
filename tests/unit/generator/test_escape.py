"""Hostile text stays where it is put."""

from __future__ import annotations

import ast
import html.parser

from hypothesis import given
from hypothesis import strategies as st

from odsmith import escape

HOSTILE = [
    "*/ int x;",
    '"; system("x"); "',
    "\\",
    "??/",
    "a\r\nb",
    "<script>alert(1)</script>",
    "`|`",
    "$(x)",
    "\u202egnp.exe",
]
hostile = st.text() | st.sampled_from(HOSTILE)


@given(hostile)
def test_c_comment_never_ends(text: str) -> None:
    safe = escape.c_comment(text)
    assert "*/" not in safe
    assert "??" not in safe
    assert not safe.endswith("\\")
    assert "\n" not in safe


@given(hostile)
def test_c_string_is_its_utf8_bytes(text: str) -> None:
    literal = escape.c_string(text)
    assert literal.isascii()
    assert "?" not in literal
    decoded = literal[1:-1].encode().decode("unicode_escape").encode("latin-1")
    assert decoded == text.encode()


@given(hostile)
def test_py_string_round_trips(text: str) -> None:
    literal = escape.py_string(text)
    assert literal.isascii()
    assert "\n" not in literal
    assert ast.literal_eval(literal) == text


@given(hostile)
def test_docstring_stays_inside_its_quotes(text: str) -> None:
    assert ast.get_docstring(ast.parse(f'"""{escape.docstring(text)}."""')) is not None


@given(hostile)
def test_eds_value_is_one_plain_line(text: str) -> None:
    safe = escape.eds_value(text)
    assert safe.isascii()
    assert not set(safe) & set(";#[]\r\n")


@given(hostile)
def test_html_text_makes_no_tag(text: str) -> None:
    tags = set()

    class Parser(html.parser.HTMLParser):
        def handle_starttag(self, tag: str, attrs: object) -> None:
            tags.add(tag)

    parser = Parser()
    parser.feed(f"<p>{escape.html_text(text)}</p>")
    assert tags == {"p"}


@given(hostile)
def test_markdown_breaks_no_table(text: str) -> None:
    safe = escape.markdown(text)
    assert "\n" not in safe
    assert "<" not in safe
    assert "|" not in safe.replace("\\|", "")


@given(hostile)
def test_mermaid_label_has_no_syntax(text: str) -> None:
    assert not set(escape.mermaid(text)) & set(':;{}[]"<>|\n')


def test_wrap_keeps_every_word() -> None:
    text = "one-two three four five"
    assert escape.wrap(text, 10) == ["one-two", "three four", "five"]
    assert escape.wrap("", 10) == [""]
