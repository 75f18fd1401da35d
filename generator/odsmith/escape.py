"""Text from a spec is hostile: each function here makes it harmless in one target language.

Every function takes any Unicode text and returns text that cannot leave the place it is put in: no line break,
no end of comment or string, no mark-up.
"""

from __future__ import annotations

import html
import re
import textwrap

_WHITE_SPACE = re.compile(r"\s+")
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")


def one_line(text: str) -> str:
    """Fold white space to single blanks and drop control and direction-changing characters."""
    return _CONTROL.sub("", _WHITE_SPACE.sub(" ", text)).strip()


def ascii_only(text: str) -> str:
    """Replace what is not ASCII by `?`; for formats that allow nothing else."""
    return one_line(text).encode("ascii", "replace").decode("ascii")


def c_comment(text: str) -> str:
    """Text inside a C comment: no end of comment, no trigraph, no line continuation."""
    safe = one_line(text).replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
    return re.sub(r"\\(?= |$)", "/", safe)


def c_string(text: str) -> str:
    """A C string literal in ASCII, quotes included; other bytes of its UTF-8 form as octal escapes."""
    out = []
    for byte in text.encode("utf-8"):
        char = chr(byte)
        if char in '"\\':
            out.append("\\" + char)
        elif char == "?" or not 0x20 <= byte < 0x7F:  # `?` could start a trigraph
            out.append(f"\\{byte:03o}")
        else:
            out.append(char)
    return '"' + "".join(out) + '"'


def py_string(text: str) -> str:
    """A Python string literal on one line with double quotes, as ruff format writes it."""
    literal = repr(text)
    if literal[0] == "'" and '"' not in text:
        literal = '"' + literal[1:-1].replace("\\'", "'") + '"'
    return "".join(char if char.isascii() else _python_escape(char) for char in literal)


def _python_escape(char: str) -> str:
    code = ord(char)
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def docstring(text: str) -> str:
    """Text inside a Python docstring or comment: no quotes that end it, no escapes, printable ASCII kept as is."""
    return one_line(text).replace("\\", "/").replace('"', "'")


def eds_value(text: str) -> str:
    """The right-hand side of an EDS line: ASCII on one line, nothing that a reader takes for a comment."""
    return ascii_only(text).replace(";", ",").replace("#", "No.").replace("[", "(").replace("]", ")")


_MARKDOWN = re.compile(r"([\\`*_{}\[\]<>#|~$])")


def markdown(text: str) -> str:
    """Text in Markdown, table cells included: no mark-up, no HTML."""
    return _MARKDOWN.sub(r"\\\1", one_line(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;"))


def html_text(text: str) -> str:
    """Text in HTML content or a quoted attribute."""
    return html.escape(one_line(text), quote=True)


def mermaid(text: str) -> str:
    """A label in a mermaid diagram: letters, digits and plain punctuation only."""
    return re.sub(r"[^A-Za-z0-9 .,()/+-]", " ", one_line(text))


def wrap(text: str, width: int) -> list[str]:
    """Break into lines of at most `width` columns without splitting words at hyphens."""
    return textwrap.wrap(text, width, break_long_words=False, break_on_hyphens=False) or [""]
