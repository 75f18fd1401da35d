"""mypy --strict and pyright say nothing about right programs on the client, and name each mistake of a wrong one.

pyright is a package of npm, see `install`.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent

SAMPLE = HERE / "typed_client.py"

WRONG = """
from tmcm6212 import TMCM6212, AsyncTMCM6212, Nothing  # wrong: no such name

from odsmith_runtime.client import Rpdo


def program(drive: TMCM6212) -> None:
    x = drive.axes[0]
    x.controlwrod.raw = 6  # wrong: misspelt
    x.homing_speeds.faster  # wrong: no such sub-index
    x.profile_velocity = 5  # wrong: the object, not its value
    x.profile_velocity.raw = "fast"  # wrong: no number
    name: str = x.homing_speeds.fast.raw  # wrong: a number
    x.move_to(1, unit="miles")  # wrong: no such unit
    x.move_to()  # wrong: where to?
    x.home(wait="no")  # wrong: yes or no
    x.enable().bit_length()  # wrong: None
    Rpdo(x)  # wrong: no object
    drive.stream([0, 1], period=0.01)  # wrong: no rows


async def program_for_asyncio(drive: AsyncTMCM6212) -> None:
    drive.axes[0].position() + 1  # wrong: nobody waits
    await drive.axes[0].controlword.write("on")  # wrong: no number
"""

MATPLOTLIB = "matplotlib"
"""What an example may do without, and a machine too."""


@pytest.fixture(scope="module")
def folder(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs alone: a checker takes its folder for the project."""
    folder = tmp_path_factory.mktemp("programs")
    for path in (*(root / "examples").glob("*.py"), SAMPLE):
        shutil.copy(path, folder)
    (folder / "wrong.py").write_text(WRONG, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def packages(root: Path) -> list[str]:
    return [str(root / "runtime_py"), *(str(root / "generated" / name / "python") for name in ("cia", "tmcm6212"))]


@pytest.fixture(scope="module")
def pyright(folder: Path, packages: list[str], tool: Callable[[str], str]) -> list[tuple[str, int, str]]:
    """File, line and message of everything that pyright finds: strict, but for the example that draws."""
    node, program = tool("node"), HERE / "npm" / "node_modules" / "pyright" / "index.js"
    if not program.exists():
        tool("what tests/peers/install makes (npm/node_modules/pyright)")  # skips, or fails in CI
    strict = [path.name for path in folder.glob("*.py") if MATPLOTLIB not in path.read_text(encoding="utf-8")]
    settings = {"extraPaths": packages, "strict": strict, "typeCheckingMode": "standard", "pythonVersion": "3.11"}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    command = [node, str(program), "--outputjson", "--pythonpath", sys.executable, "--project", str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    told = json.loads(run.stdout)
    assert told["summary"]["filesAnalyzed"] == len(list(folder.glob("*.py")))
    return [
        (Path(each["file"]).name, each["range"]["start"]["line"] + 1, each["message"])
        for each in told["generalDiagnostics"]
    ]


@pytest.fixture(scope="module")
def mypy(folder: Path, packages: list[str]) -> list[tuple[str, int, str]]:
    """The same of mypy."""
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--strict",
        "--config-file",
        "",
        "--no-error-summary",
        "--hide-error-context",
    ]
    run = subprocess.run(
        [*command, "--cache-dir", "cache", SAMPLE.name, "wrong.py"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={"MYPYPATH": ":".join(packages), "PATH": ""},
    )
    found = re.findall(r"^(\S+?):(\d+): error: (.*)$", run.stdout, re.MULTILINE)
    return [(Path(file).name, int(line), message) for file, line, message in found]


@pytest.fixture(params=["mypy", "pyright"])
def findings(request: pytest.FixtureRequest) -> list[tuple[str, int, str]]:
    found: list[tuple[str, int, str]] = request.getfixturevalue(request.param)
    return found


def test_right_programs_are_clean(findings: list[tuple[str, int, str]]) -> None:
    """The sample, and for pyright the examples; `make lint` gives those to mypy."""
    right = [found for found in findings if found[0] != "wrong.py"]
    assert [found for found in right if MATPLOTLIB not in found[2]] == []


def test_each_mistake_is_found(findings: list[tuple[str, int, str]]) -> None:
    wrong = {number for number, line in enumerate(WRONG.splitlines(), 1) if "# wrong" in line}
    assert {line for file, line, _ in findings if file == "wrong.py"} == wrong
