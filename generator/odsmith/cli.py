"""The command `odsmith`.

Exit status: 0 fine; 1 stale outputs, or lint findings of the level of `--fail-on`; 2 cannot work on it (a bad spec, an
unreadable file, wrong options); 130 ended by Ctrl-C before its work was done.
"""

from __future__ import annotations

import argparse
import gc
import io
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from odsmith.errors import Diagnostic, SourceLines, SpecError, UsageError, format_diagnostic

if TYPE_CHECKING:
    from odsmith.render import Differences

# Nothing that needs the extra `generator` is imported up here: whoever installed the client side alone shall read a
# sentence, not a traceback.

Looked = tuple[Sequence[Diagnostic], Mapping[str, str]]

FINE, FINDINGS, FAILED = 0, 1, 2
INTERRUPTED = 130  # as shells have it
LEVELS = ("note", "warning", "error")

GENERATOR_NEEDS = frozenset({"jinja2", "jsonschema_rs", "rich", "yaml"})
"""The modules that come with the extra `generator`."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns the exit status."""
    options = _parser().parse_args(arguments)
    gc.disable()  # a short process: collecting garbage costs a tenth of a build and frees nothing that matters
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # not every terminal can show every unit
    try:
        status = _run(options)
        print(end="", flush=True)
    except BrokenPipeError:
        # Nobody reads on. What Python flushes at its end must go somewhere, or it would complain there.
        for stream in (sys.stdout, sys.stderr):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    return status


def _run(options: argparse.Namespace) -> int:
    try:
        return int(options.run(options))
    except SpecError as error:
        _print_diagnostics(error.diagnostics, error.texts, options)
        return FAILED
    except UsageError as error:
        return _fail(str(error), error.hint, options)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in GENERATOR_NEEDS:
            raise
        return _fail("the generator is not installed", "pip install 'odsmith[generator]'", options)
    except BrokenPipeError:
        raise
    except OSError as error:
        name = f"{error.filename}: " if error.filename else ""
        return _fail(f"{name}{error.strerror or error}", "", options)


def _fail(message: str, hint: str, options: argparse.Namespace) -> int:
    if options.json:
        print(json.dumps({"error": message, "hint": hint}))
    else:
        print(f"odsmith: error: {message}" + (f"\nhint: {hint}" if hint else ""), file=sys.stderr)
    return FAILED


BUS_COMMANDS = {
    "simulate": "put a virtual device on a bus, or serve it on a socket",
    "inject": "do something to a virtual device: a fault, a switch, lost frames",
    "replay": "feed a log to a bus, or compare a virtual device with it",
    "decode": "say in words what a log or a live bus says",
    "scan": "find the nodes of a bus, and say where they differ from their models",
    "engine": "compile the C engine of virtual devices",
}
"""Commands with a module of their own in `odsmith.commands`."""


class _Parser(argparse.ArgumentParser):
    """The parser of a command. Those of a bus load what they consist of when somebody gives them."""

    module = ""

    def parse_known_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]
        if self.module:
            from importlib import import_module

            command = import_module(self.module)
            command.add_arguments(self)
            self.set_defaults(run=command.run)
        return super().parse_known_args(args, namespace)


class _Version(argparse.Action):
    """argparse's own version action wants the text beforehand, and finding it costs 30 ms."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        print(f"odsmith {version('odsmith')}")
        parser.exit()


def _parser() -> argparse.ArgumentParser:
    common = _Parser(add_help=False)
    common.add_argument("--json", action="store_true", help="answer in JSON, for machines")
    common.add_argument(
        "--project", type=Path, default=Path(), metavar="DIR", help="the folder that has spec/ (default: .)"
    )
    parser = argparse.ArgumentParser(
        prog="odsmith", description="Compile one YAML model of a CANopen device into EDS, C tables, Python and docs."
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND", parser_class=_Parser)

    build = commands.add_parser("build", parents=[common], help="generate everything, or prove that it is fresh")
    build.add_argument("device", nargs="*", help="a device of the project, or a YAML file (default: all of spec/)")
    build.add_argument("--check", action="store_true", help="write nothing; exit 1 and name what is stale")
    build.add_argument("--out", type=Path, metavar="DIR", help="where outputs go (default: generated/ of the project)")
    build.add_argument("--backend", action="append", default=[], metavar="NAME", help="run only this one; repeatable")
    build.set_defaults(run=_build)

    export = commands.add_parser(
        "export-c", parents=[common], help="write the C runtime and a device as a CMake project of its own"
    )
    export.add_argument("folder", type=Path, metavar="DIR", help="where the project goes")
    export.add_argument("device", help="a device of the project, or a YAML file")
    export.add_argument("--force", action="store_true", help="overwrite files that were not written by this command")
    export.set_defaults(run=_export_c)

    lint = commands.add_parser("lint", parents=[common], help="report what is wrong with specs, EDS and DCF files")
    lint.add_argument(
        "device", nargs="*", help="a device of the project, or a YAML, EDS or DCF file (default: all of spec/)"
    )
    lint.add_argument(
        "--format", choices=("text", "json", "sarif"), default="text", help="how findings are written (default: text)"
    )
    lint.add_argument(
        "--fail-on", choices=(*LEVELS, "never"), default="warning", help="the level that makes exit status 1"
    )
    lint.set_defaults(run=_lint)

    listing = commands.add_parser("list", parents=[common], help="list the devices and what they have")
    listing.add_argument("device", nargs="*", help="a device of the project, or a YAML file (default: all of spec/)")
    listing.set_defaults(run=_list)

    explain = commands.add_parser("explain", parents=[common], help="say what an index, name, EMCY or abort code is")
    explain.add_argument(
        "term", nargs="+", help="6040, 0x6840, 607D:1, TargetPosition, EMCY 8611, 06090030, pp, E40 ..."
    )
    explain.add_argument("--device", action="append", default=[], help="look only here; repeatable")
    explain.set_defaults(run=_explain)

    coverage = commands.add_parser(
        "coverage", parents=[common], help="say what of its manual a device models, and where it differs"
    )
    coverage.add_argument("device", nargs="*", help="a device of the project, or a YAML file (default: all of spec/)")
    coverage.add_argument(
        "--manual", type=Path, metavar="FILE", help="the text of the manual, to be compared cell by cell; of one device"
    )
    coverage.set_defaults(run=_coverage)

    for name, text in BUS_COMMANDS.items():
        commands.add_parser(name, parents=[common], help=text).module = f"odsmith.commands.{name}"
    return parser


def _build(options: argparse.Namespace) -> int:
    from odsmith.backends import BUILT_IN, UnknownBackendError
    from odsmith.project import compile_all, render_all, select
    from odsmith.render import compare, write

    compiled = compile_all(select(options.project, options.device))
    warnings = list(dict.fromkeys(warning for item in compiled for warning in item.warnings))
    if not options.json:
        _print_diagnostics(
            warnings, {path: text for item in compiled for path, text in item.loaded.texts.items()}, options
        )
    try:
        outputs = render_all(compiled, options.backend)
    except UnknownBackendError as error:
        raise UsageError(f"there is no backend `{error}`", f"built in: {', '.join(BUILT_IN)}") from error
    folder = options.out or options.project / "generated"
    differences = compare(outputs, folder) if options.check else write(outputs, folder)
    if options.json:
        _print_json(_written(folder, len(outputs), differences, warnings))
    else:
        report = _print_stale if options.check else _print_written
        report(differences, len(outputs), folder)
    return FINDINGS if options.check and differences else FINE


def _export_c(options: argparse.Namespace) -> int:
    from odsmith.export_c import export, project
    from odsmith.project import compile_all, select

    (compiled,) = compile_all(select(options.project, [options.device]))
    if not options.json:
        _print_diagnostics(compiled.warnings, compiled.loaded.texts, options)
    outputs = project(compiled)
    differences = export(outputs, options.folder, force=options.force)
    if options.json:
        _print_json(_written(options.folder, len(outputs), differences, compiled.warnings))
    else:
        _print_written(differences, len(outputs), options.folder)
    return FINE


def _written(folder: Path, files: int, differences: Differences, warnings: Iterable[Diagnostic]) -> dict[str, object]:
    return {
        "folder": str(folder),
        "files": files,
        "changed": differences.changed,
        "missing": differences.missing,
        "left_over": differences.left_over,
        "warnings": [warning.to_json() for warning in warnings],
    }


def _print_stale(differences: Differences, files: int, folder: Path) -> None:
    for verb, paths in (
        ("changed", differences.changed),
        ("missing", differences.missing),
        ("left over", differences.left_over),
    ):
        for path in paths:
            print(f"stale: {folder / path} ({verb})")
    if differences:
        print("run `odsmith build` and commit the result", file=sys.stderr)
    else:
        print(f"{files} files in {folder} are fresh")


def _print_written(differences: Differences, files: int, folder: Path) -> None:
    for path in sorted({*differences.changed, *differences.missing}):
        print(f"wrote {folder / path}")
    for path in differences.left_over:
        print(f"removed {folder / path}")
    written = len(differences.changed) + len(differences.missing)
    print(f"{files} files in {folder}, {written} written")


def _lint(options: argparse.Namespace) -> int:
    options.json = options.json or options.format == "json"
    findings: list[Diagnostic] = []
    texts: dict[str, str] = {}
    broken = False
    for look in _subjects(options):
        try:
            found, read = look()
        except SpecError as error:
            found, read = error.diagnostics, error.texts
            broken = True
        findings += found
        texts |= read
    unique = list(dict.fromkeys(findings))
    if options.format == "sarif":
        from odsmith.lint.sarif import sarif

        _print_json(sarif(unique))
    else:
        _print_diagnostics(unique, texts, options, stream=sys.stdout)
        if not options.json:
            print(f"{len(unique)} finding{'' if len(unique) == 1 else 's'}")
    if broken:
        return FAILED
    levels = LEVELS[LEVELS.index(options.fail_on) :] if options.fail_on in LEVELS else ()
    return FINDINGS if any(finding.severity in levels for finding in unique) else FINE


def _subjects(options: argparse.Namespace) -> Iterator[Callable[[], Looked]]:
    """What is to be looked at: each gives its findings, and the texts of the files that they are about."""
    from odsmith.eds_file import is_eds

    specs = [name for name in options.device if not is_eds(Path(name))]
    for name in dict.fromkeys(options.device):
        if name not in specs:
            yield partial(_lint_eds, Path(name))
    if specs or not options.device:
        from odsmith.project import select  # a data sheet alone needs no YAML

        for root in select(options.project, specs):
            yield partial(_lint_spec, root.path)


def _lint_eds(path: Path) -> Looked:
    from odsmith.eds_file import read
    from odsmith.lint import lint

    file = read(path)
    return lint(file), {file.path: file.text}


def _lint_spec(path: Path) -> Looked:
    from odsmith.compile import compile_spec

    compiled = compile_spec(path)
    return compiled.warnings, compiled.loaded.texts


def _list(options: argparse.Namespace) -> int:
    from odsmith.project import compile_all, devices, select

    found = devices(compile_all(select(options.project, options.device)))
    rows = [
        {
            "identifier": device.identity.identifier,
            "name": device.identity.name,
            "title": device.identity.title,
            "version": device.identity.version,
            "axes": device.axes,
            "objects": len(device.expanded),
            "entries": sum(len(item.entries) for item in device.expanded),
            "pdos": sum(item.number > 0 for item in device.expanded) // 2,
            "emergencies": len(device.emergencies),
            "digest": device.digest,
        }
        for device in found
    ]
    if options.json:
        _print_json(rows)
    else:
        from odsmith.console import print_table

        print_table(rows)
    return FINE


def _explain(options: argparse.Namespace) -> int:
    from odsmith.explain import explain, explain_rule, known_names
    from odsmith.project import compile_all, devices, select

    term = " ".join(options.term)
    found = devices(compile_all(select(options.project, options.device)))
    answers = [*(answer for device in found for answer in explain(device, term)), *explain_rule(term)]
    if not answers:
        import difflib

        names = sorted({name for device in found for name in known_names(device)})
        close = difflib.get_close_matches(term.lower().replace(" ", "_"), names, 3)
        hint = f"did you mean {' or '.join(close)}?" if close else "try an index such as 6040, a name, or EMCY 8611"
        raise UsageError(f"nothing here is called `{term}`", hint)
    if options.json:
        _print_json([answer.to_json() for answer in answers])
    else:
        from odsmith.console import print_explanations

        print_explanations(answers)
    return FINE


def _coverage(options: argparse.Namespace) -> int:
    from odsmith.coverage.command import cover
    from odsmith.coverage.report import print_summary, print_tables, to_json
    from odsmith.project import compile_all, select

    compiled = compile_all(select(options.project, options.device))
    found, texts = cover(compiled, options.manual, named=bool(options.device))
    if options.json:
        _print_json([to_json(item) for item in found])
    for position, item in enumerate(found if not options.json else ()):
        print(end="\n" if position else "")
        print_tables(item)
        _print_diagnostics(item.findings, texts, options, stream=sys.stdout)
        print_summary(item)
    broken = any(finding.severity == "error" for item in found for finding in item.findings)
    return FINDINGS if broken else FINE


def _print_diagnostics(
    found: Sequence[Diagnostic], texts: Mapping[str, str], options: argparse.Namespace, stream: TextIO | None = None
) -> None:
    if options.json:
        _print_json([diagnostic.to_json() for diagnostic in found])
        return
    lines = SourceLines(texts)
    for diagnostic in found:
        print(format_diagnostic(diagnostic, lines), file=stream or sys.stderr)


def _print_json(value: object) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False))


if __name__ == "__main__":
    sys.exit(main())
