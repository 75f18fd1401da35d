"""The programs of runtime_c/port: the one for no hardware, the one for Linux up to its socket, and the skeleton."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent

WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wundef", "-Werror")

COMPILERS = [
    pytest.param("gcc", ("-m64",), id="gcc-m64"),
    pytest.param("gcc", ("-m32",), id="gcc-m32"),
    pytest.param("clang", ("-m64",), id="clang-m64"),
    pytest.param("clang", ("-m32",), id="clang-m32"),
]

SANITIZED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")

pytestmark = pytest.mark.slow

Program = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def build(ctree: Any, run: Any, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """`build(command, sources)` links a program of the port's sources with the TMCM-6212 and the runtime."""

    def link(command: Iterable[str], sources: Iterable[Path], *includes: Path) -> Path:
        program = tmp_path_factory.mktemp("port") / "program"
        everything = [*sources, *ctree.sources("tmcm6212"), *sorted((ctree.runtime / "src").glob("*.c"))]
        folders = [*ctree.includes("tmcm6212"), *(f"-I{folder}" for folder in includes)]
        run([*command, *WARNINGS, "-O1", *folders, *map(str, everything), "-o", str(program)])
        return program

    return link


def sources(root: Path, port: str) -> list[Path]:
    found = sorted((root / "runtime_c" / "port" / port).glob("*.c"))
    assert found
    return found


def feed(program: Path, lines: str, *arguments: str | Path, status: int = 0) -> subprocess.CompletedProcess[str]:
    done = subprocess.run([program, *arguments], input=lines, capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done


@pytest.mark.parametrize(("compiler", "flags"), COMPILERS)
@pytest.mark.parametrize("port", ["host", "linux", "cortex_m", "simulation"])
def test_no_warning(
    ctree: Any, run: Any, compiles: Any, root: Path, tmp_path: Path, port: str, compiler: str, flags: tuple[str, ...]
) -> None:
    command = [*compiles(compiler, *flags), *WARNINGS, "-O2", *ctree.includes("tmcm6212")]
    for source in sources(root, port):
        run([*command, f"-I{root / 'runtime_c/port/host'}", "-c", str(source), "-o", str(tmp_path / "x.o")])


def test_as_clang_format_has_it(root: Path, run: Any, tool: Callable[[str], str]) -> None:
    files = [*(root / "runtime_c" / "port").rglob("*.[ch]"), *HERE.glob("port_*.c")]
    style = f"--style=file:{root / '.clang-format'}"
    run([tool("clang-format"), style, "--dry-run", "-Werror", *map(str, files)])


# ---- host -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def host(build: Callable[..., Path], compiles: Any, root: Path) -> Path:
    return build([*compiles("gcc"), *SANITIZED], sources(root, "host"))


def sent(done: subprocess.CompletedProcess[str]) -> list[str]:
    return [line.replace(" can0 ", " ") for line in done.stdout.splitlines()]


def test_host_boots_and_answers(host: Path) -> None:
    """With and without stamp and bus, in the spelling of candump and of a person."""
    done = feed(host, "(1700000000.000001) vcan0 601#4000100000000000\n  601#4018100100000000 T\n\n")
    assert sent(done) == [
        "(1700000000.000001) 701#00",
        "(1700000000.000001) 581#430010009201FCFF",
        "(1700000000.000001) 581#4318100186020000",
    ]
    assert done.stderr == "node 1 at 1000 kbit/s\n"


def test_host_time_is_that_of_the_lines(host: Path) -> None:
    """Heartbeats leave on a grid, each at its instant, whatever lines come in between; time does not run back."""
    lines = ["(5.000000)", "601#2B17100064000000", "(5.150000)", "(5.149000) 000#0101", "(5.3)x", "(5.310000) 000#0201"]
    done = feed(host, "\n".join(lines), status=1)
    assert [line for line in sent(done) if " 701#" in line] == [
        "(0000000005.000000) 701#00",
        "(0000000005.100000) 701#7F",
        "(0000000005.200000) 701#05",
        "(0000000005.300000) 701#05",
    ]
    assert sent(done)[1] == "(0000000005.000000) 581#6017100000000000"
    assert done.stderr.splitlines()[1:] == ["line 5: this is not a frame"]


def test_host_lets_longer_pass_than_the_clock_can_count(host: Path) -> None:
    """Two hours are more than 2^32 us."""
    done = feed(host, "(0.000000) 601#2B171000FFFF0000\n(7200.000000)\n")
    beats = [line for line in sent(done) if line.endswith(" 701#7F")]
    assert len(beats) == 7_200_000_000 // 65_535_000
    assert beats[-1] == f"({len(beats) * 65_535_000 // 10**6:010}.{len(beats) * 65_535_000 % 10**6:06}) 701#7F"


@pytest.mark.parametrize(
    "line",
    [
        "60#40", "601", "601#4", "601#4G", "601#400010000000000000", "801#00", "601#R9", "601#00x", "(1.5) 601#00",
        "(x) 601#00", "(1.000000 601#00", "can0", "can0 can0 601#00", "x" * 300,
    ],
)  # fmt: skip
def test_host_says_what_it_cannot_read(host: Path, line: str) -> None:
    done = feed(host, f"\n{line}\n", status=1)
    assert "line 2: this is not a frame" in done.stderr
    assert sent(done) == ["(0000000000.000000) 701#00"]


@pytest.mark.parametrize("line", ["", "(2.000000)", "00000601#40", "601##1400010", "20000080#0000000000000000"])
def test_host_leaves_out_what_is_none_of_its_business(host: Path, line: str) -> None:
    done = feed(host, f"\n{line}\n")
    assert sent(done) == ["(0000000000.000000) 701#00"]


def test_host_answers_remote_frames(host: Path) -> None:
    assert sent(feed(host, "701#R\n701#R1\n"))[1:] == ["(0000000000.000000) 701#7F", "(0000000000.000000) 701#FF"]


def test_host_keeps_values_in_a_file(host: Path, tmp_path: Path) -> None:
    nvm = tmp_path / "values.nvm"
    write, save, read = "601#2B17100088130000", "601#2310100173617665", "601#4017100000000000"
    kept = feed(host, f"{write}\n{save}\n", nvm)
    assert sent(kept)[1:] == ["(0000000000.000000) 581#6017100000000000", "(0000000000.000000) 581#6010100100000000"]
    assert sent(feed(host, f"{read}\n", nvm))[1] == "(0000000000.000000) 581#4B17100088130000"
    assert sent(feed(host, f"{read}\n", tmp_path / "other"))[1] == "(0000000000.000000) 581#4B17100000000000"
    without = feed(host, f"{save}\n")
    assert sent(without)[1] == "(0000000000.000000) 581#8010100100000606"


def test_host_cannot_open_its_file(host: Path, tmp_path: Path) -> None:
    assert str(tmp_path / "no" / "such") in feed(host, "", tmp_path / "no" / "such", status=2).stderr
    assert "usage: " in feed(host, "", "a", "b", status=2).stderr


# ---- linux ----------------------------------------------------------------------------------------------------------


def test_linux_without_a_bus(build: Callable[..., Path], compiles: Any, root: Path, tmp_path: Path) -> None:
    """The program as far as it goes on a machine that has no such interface: to the socket."""
    port = root / "runtime_c" / "port"
    program = build(compiles("gcc"), [*sources(root, "linux"), port / "host" / "nvm_file.c"], port / "host")
    assert "nocan: " in feed(program, "", "nocan", tmp_path / "nvm", status=2).stderr
    assert "usage: " in feed(program, "", status=2).stderr


@pytest.fixture(scope="module")
def translate(ctree: Any, run: Any, compiles: Any, root: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """`translate("123 01 02")` gives what a frame of Linux becomes."""
    program = tmp_path_factory.mktemp("socketcan") / "program"
    folder = root / "runtime_c" / "port" / "linux"
    files = [str(HERE / "port_socketcan.c"), str(folder / "socketcan.c")]
    run([*compiles("gcc"), *SANITIZED, *WARNINGS, f"-I{folder}", *ctree.includes(), *files, "-o", str(program)])
    return lambda frame: run([str(program), *frame.split()]).splitlines()


OK, WARNING, PASSIVE, BUS_OFF, ERROR, OVERRUN, TX_FULL, RX_FULL = range(8)


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        ("601 40 00 10 00", ["frame 601 4 0 40 00 10 00"]),
        ("000 81 00", ["frame 000 2 0 81 00"]),
        ("080", ["frame 080 0 0"]),
        ("40000701", ["frame 701 0 1"]),  # CAN_RTR_FLAG
        ("80000601 40", []),  # CAN_EFF_FLAG
        ("20000040 0 0 0 0 0 0 0 0", [BUS_OFF]),
        ("20000100 0 0 0 0 0 0 0 0", [OK]),  # restarted
        ("20000004 0 04 0 0 0 0 0 0", [WARNING]),  # of the receiver
        ("20000004 0 08 0 0 0 0 0 0", [WARNING]),  # of the transmitter
        ("20000004 0 10 0 0 0 0 0 0", [PASSIVE]),
        ("20000004 0 20 0 0 0 0 0 0", [PASSIVE]),
        ("20000004 0 24 0 0 0 0 0 0", [WARNING, PASSIVE]),  # the worse one holds
        ("20000004 0 40 0 0 0 0 0 0", [OK]),  # error active again
        ("20000004 0 01 0 0 0 0 0 0", [OVERRUN]),
        ("20000004 0 02 0 0 0 0 0 0", [TX_FULL]),
        ("2000008C 0 08 0 0 0 0 0 0", [WARNING, ERROR]),  # with a violation of the protocol
        ("20000002 0 04 0 0 0 0 0 0", []),  # lost arbitration, which is no error
    ],
)
def test_linux_frames(translate: Any, frame: str, expected: list[str | int]) -> None:
    assert translate(frame) == [f"event {item}" if isinstance(item, int) else item for item in expected]


# ---- cortex_m -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def board(build: Callable[..., Path], compiles: Any, root: Path) -> Path:
    """The skeleton on a board that is a program."""
    port = root / "runtime_c" / "port"
    files = [*sources(root, "cortex_m"), HERE / "port_board.c", port / "host" / "candump.c"]
    return build([*compiles("gcc"), *SANITIZED], files, port / "cortex_m", port / "host")


def test_cortex_m_compiles(ctree: Any, run: Any, tool: Callable[[str], str], root: Path, tmp_path: Path) -> None:
    command = [tool("arm-none-eabi-gcc"), "-mcpu=cortex-m4", "-mthumb", "-Os", "-ffreestanding", *WARNINGS]
    for source in sources(root, "cortex_m"):
        run([*command, *ctree.includes("tmcm6212"), "-c", str(source), "-o", str(tmp_path / f"{source.stem}.o")])


def test_cortex_m_asks_the_linker_for_what_is_missing(build: Callable[..., Path], compiles: Any, root: Path) -> None:
    """The functions that board.h declares, all of them and nothing else."""
    with pytest.raises(AssertionError) as failed:
        build(compiles("gcc"), sources(root, "cortex_m"))
    header = (root / "runtime_c" / "port" / "cortex_m" / "board.h").read_text()
    declared = set(re.findall(r"\b(board_\w+)\(", header))
    assert set(re.findall(r"undefined reference to `(\w+)'", str(failed.value))) == declared


def test_cortex_m_runs(board: Path) -> None:
    """Boot-up under the node-ID of the switches, answers, and input lines as 3002h shows them."""
    lines = feed(
        board, "609#4000100000000000\n609#4018100400000000\n!inputs 5\n\n609#4002300000000000\n\n"
    ).stdout.splitlines()
    assert lines[0] == "start"
    assert lines[1].startswith("bus ")
    frames = [line.split(" can0 ")[1] for line in lines if " can0 " in line]
    assert frames == ["709#00", "589#430010009201FCFF", "589#4318100404030201", "589#4302300000000500"]


def test_cortex_m_reports_the_controller(board: Path) -> None:
    """Passive, an overrun, and a queue that a flood fills: emergencies 8120h, 8110h byte 1 and byte 3."""
    events = f"!can {PASSIVE}\n\n!can {OK}\n\n!can {OVERRUN}\n\n!flood 65\n\n"
    lines = feed(board, "000#0109\n" + events).stdout.splitlines()
    emergencies = [line.split("#")[1] for line in lines if " 089#" in line]
    assert [text[:4] for text in emergencies] == ["2081", "0000", "1081", "1081"]
    assert len(set(emergencies)) == 4
