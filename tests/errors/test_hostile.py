"""Texts of a spec that try to break out of where they are put: they stay text, in every artefact."""

from __future__ import annotations

import logging
import subprocess
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import canopen
import pytest
from markdown_it import MarkdownIt

from odsmith.compile import compile_spec
from odsmith.project import render_all
from odsmith.render import write

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def built(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("hostile")
    specs = [root / "spec" / "cia" / "cia.yaml", HERE / "hostile.yaml"]
    write(render_all([compile_spec(path) for path in specs]), folder)
    return folder


def test_c_compiles_and_has_no_new_line_of_code(built: Path, root: Path, tool: Callable[[str], str]) -> None:
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wcomment", "-Wtrigraphs", "-fsyntax-only"]
    includes = [f"-I{root / 'runtime_c' / 'include'}", f"-I{built / 'cia' / 'c'}", f"-I{built / 'toy' / 'c'}"]
    for source in sorted((built / "toy" / "c").glob("*.c")):
        subprocess.run([tool("gcc"), *flags, *includes, source], check=True)


def test_python_has_the_text_as_text(built: Path) -> None:
    for source in sorted((built / "toy" / "python").rglob("*.py")):
        compile(source.read_text(encoding="utf-8"), str(source), "exec")


def test_the_eds_keeps_its_lines(built: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    eds = built / "toy" / "eds" / "TOY-2.eds"
    dictionary = canopen.import_od(str(eds))
    assert not caplog.records
    assert sorted(dictionary) == sorted(item for item in dictionary if item < 0x10000)
    assert dictionary[0x2001].name.startswith("Hostile")
    assert dictionary[0x2201].name.endswith("2")
    assert eds.read_bytes().isascii()


def test_html_runs_no_foreign_script(built: Path) -> None:
    class Parser(HTMLParser):
        def __init__(self) -> None:
            super().__init__()
            self.scripts = 0
            self.handlers: list[str] = []

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.scripts += tag == "script"
            self.handlers += [name for name, value in attrs if name.startswith("on") or "javascript:" in (value or "")]

    parser = Parser()
    text = (built / "toy" / "docs" / "index.html").read_text(encoding="utf-8")
    parser.feed(text)
    assert not parser.handlers
    assert "<script>alert" not in text
    assert "<img" not in text
    assert "$(true) {{ 7*7 }}" in text  # Jinja in a text is not run
    assert parser.scripts == 1


def test_markdown_renders_to_no_html_of_the_spec(built: Path) -> None:
    for page in sorted((built / "toy" / "docs").glob("*.md")):
        rendered = MarkdownIt("commonmark", {"html": True}).enable("table").render(page.read_text(encoding="utf-8"))
        assert "<script" not in rendered, page
        assert "<img" not in rendered, page
        assert 'href="javascript:' not in rendered, page
