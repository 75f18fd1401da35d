"""`odsmith export-c`: what it writes, what it refuses to overwrite, and that the project builds as its README says."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import pytest

from odsmith.cli import main
from odsmith.compile import compile_spec
from odsmith.export_c import RECORD, export, project
from odsmith.render import Output

WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

Files = Callable[[str], list[Output]]


class Result(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Result]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """`run("export-c", folder, device)` runs the command in this process."""

    def call(*arguments: str | Path) -> Result:
        return Result(main([str(argument) for argument in arguments]), *capsys.readouterr())

    return call


@pytest.fixture(scope="module")
def files(root: Path) -> Files:
    """`files("toy")` gives the project of a device, rendered once."""
    specs = {
        "toy": "tests/golden/toy.yaml",
        "hostile": "tests/errors/hostile.yaml",
        "io_module": "spec/examples/io_module.yaml",
        "tmcm3230": "spec/tmcm3230.yaml",
        "tmcm6212": "spec/tmcm6212.yaml",
    }
    made: dict[str, list[Output]] = {}

    def render(name: str) -> list[Output]:
        if name not in made:
            made[name] = project(compile_spec(root / specs[name]))
        return made[name]

    return render


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# ---- what is written ------------------------------------------------------------------------------------------------


def test_the_files_of_a_project(files: Files, root: Path) -> None:
    made = {output.path: output.content for output in files("tmcm6212")}
    assert {path for path in made if "/" not in path} == {
        "CMakeLists.txt", "LICENSE", "PORTING.md", "README.md", RECORD,
    }  # fmt: skip
    assert made["LICENSE"] == (root / "LICENSE").read_bytes()
    assert made["PORTING.md"] == (root / "runtime_c" / "README.md").read_bytes()
    for part in ("include", "src", "port"):
        ours = {
            path.relative_to(root / "runtime_c").as_posix(): path.read_bytes()
            for path in (root / "runtime_c" / part).rglob("*.[ch]")
        }
        assert len(ours) > 3
        assert ours.items() <= made.items()
    for source, part in (("cia/c/ods", "include/ods"), ("tmcm6212/c", "device")):
        for path in (root / "generated" / source).iterdir():
            assert made[f"{part}/{path.name}"] == path.read_bytes()


@pytest.mark.parametrize("device", ["toy", "io_module", "tmcm3230", "tmcm6212"])
def test_a_project_is_whole(files: Files, device: str) -> None:
    """Every header that is included is there, and CMake hears of every source file."""
    made = {output.path: output.content.decode() for output in files(device)}
    folders = ("include", "device", "src", "port/host", "port/linux", "port/cortex_m", "port/simulation", "port/engine")
    for path, text in made.items():
        for name in re.findall(r'^#include "(.+)"', text, re.MULTILINE):
            assert any(f"{folder}/{name}" in made for folder in folders), f"{path} includes {name}"
    library = {path for path in made if path.endswith(".c") and path.startswith(("src/", "device/"))}
    programs = {path for path in made if re.match(r"port/(host|linux)/.*\.c$", path)}
    assert set(re.findall(r"[\w/]+\.c\b", made["CMakeLists.txt"])) == library | programs
    assert f"static {device}_t drive;" in made["port/cortex_m/main.c"]


def test_only_one_device_is_named(files: Files) -> None:
    """The runtime may have a device as an example in its comments; what a user reads and copies may not."""
    for output in files("toy"):
        if not output.path.startswith(("include/", "src/")):
            assert b"6212" not in output.content, output.path


def test_text_of_a_spec_breaks_out_of_nothing(tmp_path: Path, root: Path) -> None:
    """The names of a device go into Markdown as text, and nowhere into CMake."""
    spec = tmp_path / "hostile.yaml"
    text = (root / "tests" / "golden" / "toy.yaml").read_text()
    text = re.sub(r"(?m)^  name: .*", '  name: "x)\\n<b>|`$(y)"', text, count=1)
    text = re.sub(r"(?m)^  title: .*", '  title: "${z} \\")\\nmessage(FATAL_ERROR hi) *_#<i>"', text, count=1)
    spec.write_text(text)
    made = {output.path: output.content.decode() for output in project(compile_spec(spec))}
    plain = {output.path: output.content.decode() for output in project(compile_spec(root / "tests/golden/toy.yaml"))}
    assert made["CMakeLists.txt"] == plain["CMakeLists.txt"]
    assert made["README.md"].splitlines()[0] == r"# x) &lt;b&gt;\|\`\$(y) as a CANopen node in C"
    assert "<i>" not in made["README.md"]
    assert made["README.md"].count("\n") == plain["README.md"].count("\n")


def test_the_record(files: Files) -> None:
    *others, record = files("toy")
    assert record.path == RECORD
    answer = json.loads(record.content)
    assert answer["device"] == "toy"
    assert list(answer["files"]) == sorted(output.path for output in others)


def test_the_command(run: Run, tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No project around it; names of files are as they were given."""
    shutil.copy(root / "tests" / "golden" / "toy.yaml", tmp_path / "my_drive.yaml")
    monkeypatch.chdir(tmp_path)
    first = run("export-c", "deep/toy node", "my_drive.yaml")
    made = contents(tmp_path / "deep" / "toy node")
    assert (first.status, first.err) == (0, "")
    assert first.out.splitlines() == [
        *(f"wrote deep/toy node/{path}" for path in sorted(made)),
        f"{len(made)} files in deep/toy node, {len(made)} written",
    ]
    assert str(tmp_path).encode() not in b"".join(made.values())
    answer = json.loads(run("export-c", "other", "my_drive.yaml", "--json").out)
    assert answer == {
        "folder": "other", "files": len(made), "changed": [], "missing": sorted(made), "left_over": [], "warnings": [],
    }  # fmt: skip
    assert contents(tmp_path / "other") == made


# ---- a folder that is not empty -------------------------------------------------------------------------------------


def test_again_writes_nothing(files: Files, tmp_path: Path) -> None:
    assert len(export(files("toy"), tmp_path).missing) == len(files("toy"))
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
    assert not export(files("toy"), tmp_path)
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


def test_an_update_replaces_its_own_files_only(files: Files, tmp_path: Path) -> None:
    """An older export, simulated: one file was other, one is gone today, and one was lost."""
    outputs = files("toy")
    old = [
        Output(output.path, b"old\n" if output.path == "src/ods_od.c" else output.content) for output in outputs[:-1]
    ]
    old.append(Output("src/ods_gone.c", b"gone\n"))
    record = json.loads(outputs[-1].content)
    record["files"] |= {
        path: _sha256(content) for path, content in (("src/ods_od.c", b"old\n"), ("src/ods_gone.c", b"gone\n"))
    }
    export([*old, Output(RECORD, json.dumps(record).encode())], tmp_path)
    (tmp_path / "LICENSE").unlink()
    (tmp_path / "src" / "mine.c").write_bytes(b"mine\n")

    differences = export(outputs, tmp_path)
    assert differences.changed == (RECORD, "src/ods_od.c")
    assert differences.missing == ("LICENSE",)
    assert differences.left_over == ("src/ods_gone.c",)
    assert contents(tmp_path) == {output.path: output.content for output in outputs} | {"src/mine.c": b"mine\n"}


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@pytest.mark.parametrize("had", ["a foreign file", "a changed file", "a broken record"])
def test_what_would_be_lost_is_refused(had: str, run: Run, root: Path, tmp_path: Path) -> None:
    spec = root / "tests" / "golden" / "toy.yaml"
    folder = tmp_path / "node"
    if had != "a foreign file":
        assert run("export-c", folder, spec).status == 0
    folder.mkdir(exist_ok=True)
    path = folder / (RECORD if had == "a broken record" else "README.md")
    path.write_bytes(b"written by hand\n")
    before = contents(folder)

    refused = run("export-c", folder, spec)
    assert refused == (
        2,
        "",
        f"odsmith: error: in {folder} `{path.name}` would be overwritten, which odsmith did not write as it is now\n"
        "hint: name another folder, or overwrite: --force\n",
    )
    assert contents(folder) == before
    assert set(json.loads(run("export-c", folder, spec, "--json").out)) == {"error", "hint"}

    forced = run("export-c", folder, spec, "--force")
    assert (forced.status, forced.err) == (0, "")
    assert f"wrote {path}" in forced.out.splitlines()
    assert run("export-c", folder, spec).out.endswith(" 0 written\n")


def test_many_files_in_the_way(files: Files, run: Run, root: Path, tmp_path: Path) -> None:
    """The first is named, the others are counted: a folder that somebody copied without its record."""
    for output in files("toy"):
        (tmp_path / output.path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / output.path).write_bytes(output.content + b"x")
    refused = run("export-c", tmp_path, root / "tests" / "golden" / "toy.yaml")
    assert refused.status == 2
    assert f"`CMakeLists.txt` and {len(files('toy')) - 1} more would be overwritten" in refused.err


def test_the_same_bytes_are_nobodys_loss(files: Files, tmp_path: Path) -> None:
    """An export that was cut short, or whose record is gone, is completed."""
    export(files("toy"), tmp_path)
    (tmp_path / RECORD).unlink()
    (tmp_path / "README.md").unlink()
    assert export(files("toy"), tmp_path).missing == (RECORD, "README.md")


def test_a_folder_with_another_device(files: Files, run: Run, root: Path, tmp_path: Path) -> None:
    export(files("io_module"), tmp_path)
    before = contents(tmp_path)
    spec = root / "tests" / "golden" / "toy.yaml"
    assert run("export-c", tmp_path, spec) == (
        2,
        "",
        f"odsmith: error: {tmp_path} has an export of `io_module`\n"
        "hint: name another folder, or put this one there: --force\n",
    )
    assert contents(tmp_path) == before
    assert run("export-c", tmp_path, spec, "--force").status == 0
    assert contents(tmp_path) == {output.path: output.content for output in files("toy")}


def test_a_record_cannot_name_what_is_outside(files: Files, tmp_path: Path) -> None:
    """A record is somebody's file: it must not make an export delete things."""
    folder, secret = tmp_path / "node", tmp_path / "secret"
    export(files("toy"), folder)
    secret.write_bytes(b"secret\n")
    (folder / "mine.c").write_bytes(b"mine\n")
    record = json.loads((folder / RECORD).read_bytes())
    record["files"] |= dict.fromkeys(("../secret", "src/../../secret", str(secret), "mine.c"), _sha256(b"secret\n"))
    (folder / RECORD).write_text(json.dumps(record))
    assert export(files("toy"), folder).left_over == ()
    assert secret.exists()
    assert (folder / "mine.c").exists()


# ---- what cannot be done --------------------------------------------------------------------------------------------


def test_what_is_no_device(run: Run, root: Path, tmp_path: Path) -> None:
    for device, message in (
        ("cia", "`cia` is no device but a vocabulary\nhint: `odsmith list` names devices\n"),
        ("tmcm6213", "there is no device `tmcm6213`\nhint: known: "),
    ):
        refused = run("export-c", tmp_path / "node", device, "--project", root)
        assert (refused.status, refused.out) == (2, "")
        assert refused.err.startswith(f"odsmith: error: {message}")
    (tmp_path / "broken.yaml").write_text("format: 1\ndevice: {identifier: 7}\n")
    broken = run("export-c", tmp_path / "node", tmp_path / "broken.yaml")
    assert broken.status == 2
    assert "broken.yaml:2:" in broken.err
    assert not (tmp_path / "node").exists()


def test_a_folder_that_is_a_file(run: Run, root: Path, tmp_path: Path) -> None:
    (tmp_path / "node").write_text("a file")
    refused = run("export-c", tmp_path / "node", root / "tests" / "golden" / "toy.yaml")
    assert (refused.status, refused.out) == (2, "")
    assert refused.err.startswith(f"odsmith: error: {tmp_path / 'node'}")
    assert (tmp_path / "node").read_text() == "a file"


# ---- the project builds ---------------------------------------------------------------------------------------------

slow = pytest.mark.slow


def shell(command: str | list[str], folder: Path, given: str = "") -> str:
    done = subprocess.run(
        command, cwd=folder, input=given, capture_output=True, text=True, shell=isinstance(command, str), check=False
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout


def answers(program: Path, device_type: str) -> None:
    """The example announces itself and answers an upload of 1000h."""
    lines = shell([str(program)], program.parent, "(12.000000) can0 601#4000100000000000\n").splitlines()
    assert lines == [
        "(0000000012.000000) can0 701#00",
        f"(0000000012.000000) can0 581#43001000{device_type}",
    ]


DEVICE_TYPES = {"tmcm3230": "9201FCFF", "tmcm6212": "9201FCFF", "io_module": "91010F00"}


@slow
def test_as_its_readme_says(files: Files, tool: Callable[[str], str], tmp_path: Path) -> None:
    """Every command of the README, as it stands there."""
    tool("cmake")
    tool("cc")
    export(files("tmcm6212"), tmp_path)
    commands = re.findall(r"^\$ (.+)$", (tmp_path / "README.md").read_text(), re.MULTILINE)
    assert len(commands) == 3
    build, ask, compile_alone = (shell(command, tmp_path) for command in commands)
    assert "warning" not in build + compile_alone
    assert ask == "(0000000000.000000) can0 701#00\n(0000000000.000000) can0 581#430010009201FCFF\n"
    answers(tmp_path / "tmcm6212_host", DEVICE_TYPES["tmcm6212"])
    assert (tmp_path / "build" / "tmcm6212_linux").exists()


@slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_as_part_of_another_project(files: Files, tool: Callable[[str], str], tmp_path: Path, compiler: str) -> None:
    """Two devices in one build, no examples, warnings as errors."""
    cmake = tool("cmake")
    for device in ("tmcm3230", "io_module"):
        export(files(device), tmp_path / device)
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\n"
        "project(two LANGUAGES C)\n"
        "add_subdirectory(tmcm3230)\nadd_subdirectory(io_module)\n"
        "add_executable(two main.c)\n"
        "target_link_libraries(two PRIVATE odsmith::tmcm3230 odsmith::io_module)\n"
    )
    (tmp_path / "main.c").write_text(
        '#include "io_module.h"\n#include "tmcm3230.h"\n#include <stdio.h>\n'
        "static void put(void *context, const ods_frame_t *frame)\n"
        '{\n    printf("%s %03X\\n", (const char *)context, (unsigned)frame->id);\n}\n'
        "int main(void)\n{\n"
        "    static tmcm3230_t drive;\n    static io_module_t module;\n"
        '    static char names[2][6] = { "drive", "io" };\n'
        "    const ods_port_t ports[2] = {\n"
        "        { .context = names[0], .send = put }, { .context = names[1], .send = put }\n    };\n"
        "    const ods_config_t config = { .node_id = 5 };\n"
        "    tmcm3230_init(&drive, &ports[0], &config);\n    io_module_init(&module, &ports[1], &config);\n"
        "    ods_node_power_on(&drive.node, 0);\n    ods_node_power_on(&module.node, 0);\n    return 0;\n}\n"
    )
    flags = ["-DCMAKE_C_FLAGS=-Werror", f"-DCMAKE_C_COMPILER={tool(compiler)}"]
    shell([cmake, "-B", "build", *flags], tmp_path)
    shell([cmake, "--build", "build"], tmp_path)
    assert shell(["build/two"], tmp_path).splitlines()[0] == "drive 705"
    assert [path.name for path in (tmp_path / "build").rglob("*_host")] == []


@slow
@pytest.mark.parametrize("device", ["tmcm3230", "io_module"])
def test_every_device_answers(files: Files, tool: Callable[[str], str], tmp_path: Path, device: str) -> None:
    export(files(device), tmp_path)
    sources = [str(path) for folder in ("src", "device", "port/host") for path in (tmp_path / folder).glob("*.c")]
    shell([tool("cc"), *WARNINGS, "-Iinclude", "-Idevice", *sources, "-o", "node"], tmp_path)
    answers(tmp_path / "node", DEVICE_TYPES[device])


@slow
def test_for_a_cortex_m4(files: Files, tool: Callable[[str], str], tmp_path: Path) -> None:
    """The library by way of CMake as a cross build does it; the skeleton compiles against it."""
    cmake, compiler = tool("cmake"), tool("arm-none-eabi-gcc")
    export(files("tmcm6212"), tmp_path)
    (tmp_path / "toolchain.cmake").write_text(
        "set(CMAKE_SYSTEM_NAME Generic)\nset(CMAKE_SYSTEM_PROCESSOR arm)\n"
        f"set(CMAKE_C_COMPILER {compiler})\nset(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\n"
        'set(CMAKE_C_FLAGS_INIT "-mcpu=cortex-m4 -mthumb -Werror")\n'
    )
    shell([cmake, "-B", "build", "-DCMAKE_TOOLCHAIN_FILE=toolchain.cmake", "-DCMAKE_BUILD_TYPE=MinSizeRel"], tmp_path)
    shell([cmake, "--build", "build"], tmp_path)
    assert (tmp_path / "build" / "libodsmith_tmcm6212.a").exists()
    assert not list((tmp_path / "build").glob("*_host*"))
    for source in (tmp_path / "port" / "cortex_m").glob("*.c"):
        flags = ["-mcpu=cortex-m4", "-mthumb", "-Os", *WARNINGS, "-Iinclude", "-Idevice"]
        shell([compiler, *flags, "-c", str(source), "-o", f"{source.stem}.o"], tmp_path)


@slow
def test_the_checkout_builds_with_cmake(root: Path, tool: Callable[[str], str], tmp_path: Path) -> None:
    cmake = tool("cmake")
    shell([cmake, "-S", str(root), "-B", str(tmp_path), "-DCMAKE_C_FLAGS=-Werror"], tmp_path)
    shell([cmake, "--build", str(tmp_path)], tmp_path)
    answers(tmp_path / "tmcm6212_host", DEVICE_TYPES["tmcm6212"])


def test_what_a_build_leaves_in_the_checkout_hides_no_licence(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`python -m odsmith.cli` in the checkout finds odsmith.egg-info before the installed distribution."""
    left = tmp_path / "odsmith.egg-info"
    left.mkdir()
    (left / "PKG-INFO").write_text("Metadata-Version: 2.4\nName: odsmith\nVersion: 0\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert metadata.version("odsmith") == "0"
    exported = {output.path: output.content for output in project(compile_spec(root / "tests" / "golden" / "toy.yaml"))}
    assert exported["LICENSE"] == (root / "LICENSE").read_bytes()
