"""The files of the C backend: complete, formatted, deterministic, and nothing in them that the spec did not say."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from odsmith.backends.c import CBackend
from odsmith.errors import SpecError
from odsmith.model import Bit, Device
from odsmith.render import MARK, write
from odsmith.vocabulary import Vocabulary


def rendered(model: Device | Vocabulary) -> dict[str, str]:
    return {output.path: output.content.decode() for output in CBackend().render(model)}


@pytest.fixture(scope="session")
def files(tmcm3230: Device, io_module: Device, vocabulary: Vocabulary) -> dict[str, str]:
    return {**rendered(tmcm3230), **rendered(io_module), **rendered(vocabulary)}


def test_names(files: dict[str, str]) -> None:
    devices = [
        f"{name}/c/{name}{part}.{kind}"
        for name in ("io_module", "tmcm3230")
        for part in ("", "_device", "_od")
        for kind in "ch"
    ]
    assert sorted(files) == ["cia/c/ods/values.h", "cia/c/ods/vocabulary.h", *devices]


def test_the_tables_know_nothing_of_nodes(files: dict[str, str]) -> None:
    """Whoever wants a dictionary alone need not take the runtime."""
    users = [path for path, text in files.items() if "ods/node.h" in text or "ods_node" in text]
    assert users == [f"{name}/c/{name}.{kind}" for name in ("tmcm3230", "io_module") for kind in "ch"]


def test_the_memory_of_a_node_has_no_empty_arrays(files: dict[str, str], io_module: Device) -> None:
    assert "axes" not in files["io_module/c/io_module.h"]
    assert "        .axes = NULL,\n" in files["io_module/c/io_module.c"]
    without = rendered(replace(io_module, objects=tuple(obj for obj in io_module.objects if not obj.pdo), pdos=()))
    members = re.search(r"typedef struct \{\n(.*?)\} io_module_t;", without["io_module/c/io_module.h"], re.DOTALL)
    assert members
    names = [line.split()[1] for line in members[1].splitlines()]
    assert names == ["node;", "values;", "buffer[IO_MODULE_BUFFER_SIZE];"]
    assert without["io_module/c/io_module.c"].count("NULL") == 4


def test_each_file_says_what_it_is(files: dict[str, str]) -> None:
    """The first comment names the command; no licence is put on what belongs to the user."""
    for path, text in files.items():
        head = text.split("*/")[0]
        assert head.startswith("/*\n"), path
        assert MARK in head, path
        assert "licen" not in text.lower(), path


def test_the_version_stands_in_one_place(files: dict[str, str], tmcm3230: Device) -> None:
    assert [path for path, text in files.items() if tmcm3230.digest in text] == ["tmcm3230/c/tmcm3230_device.h"]


def test_lines(files: dict[str, str]) -> None:
    for path, text in files.items():
        assert text.endswith("\n")
        assert not text.endswith("\n\n"), path
        assert "\n\n\n" not in text, path
        assert not re.search(r"[ \t]\n", text), path
        too_long = [line for line in text.splitlines() if len(line) > 120]
        assert not too_long, path


def test_deterministic(files: dict[str, str], tmcm3230: Device) -> None:
    assert rendered(tmcm3230).items() <= files.items()


@pytest.mark.parametrize("model", ["tmcm3230", "tmcm6212", "io_module", "vocabulary"])
def test_formatted(
    model: str, tool: Callable[[str], str], root: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """What the templates emit is what clang-format would make of it."""
    write(CBackend().render(request.getfixturevalue(model)), tmp_path)
    _check_format(tool, root, sorted(tmp_path.rglob("*.[ch]")))


def test_hand_written_code_is_formatted(tool: Callable[[str], str], root: Path) -> None:
    sources = [path for folder in ("runtime_c", "tests/unit/runtime_c") for path in (root / folder).rglob("*.[ch]")]
    _check_format(tool, root, sorted(sources))
    for path in sources:
        assert all(len(line) <= 120 for line in path.read_text(encoding="utf-8").splitlines()), path


def _check_format(tool: Callable[[str], str], root: Path, sources: list[Path]) -> None:
    style = f"--style=file:{root / '.clang-format'}"
    done = subprocess.run(
        [tool("clang-format"), style, "--dry-run", "-Werror", *sources], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-4000:]


def test_constants(files: dict[str, str]) -> None:
    header = files["tmcm3230/c/tmcm3230_od.h"]
    for line in (
        "#define TMCM3230_OBJ_CONTROLWORD 0x6040u",
        "#define TMCM3230_SUB_HOMING_SPEEDS_SLOW 2u",
        "#define TMCM3230_BIT_SWITCH_PARAMETERS_HOME_INVERTED 0x00000020u",
        "#define TMCM3230_MAX_SWITCH_PARAMETERS 63u",
        "#define TMCM3230_MIN_CHOPPER_HYSTERESIS_END (-3)",
        "#define TMCM3230_DEFAULT_FULLSTEP_RESOLUTION 200u",
        "#define TMCM3230_DEFAULT_SOFTWARE_POSITION_LIMIT_MINIMUM (-2147483647 - 1)",
        "    TMCM3230_VALUE_HOMING_METHOD_CURRENT_POSITION = 35,",
        "#define TMCM3230_STRIDE_PROFILE 0x800u",
        "#define TMCM3230_GROUP_MOTOR 3u",
    ):
        assert re.search(rf"^{re.escape(line)}( /\*|$)", header, re.MULTILINE), line


def test_vocabulary(files: dict[str, str]) -> None:
    words, values = files["cia/c/ods/vocabulary.h"], files["cia/c/ods/values.h"]
    for line in (
        "#define ODS_ABORT_NO_OBJECT 0x06020000u",
        "#define ODS_ERROR_TEMPERATURE 0x08u",
        "#define ODS_SIGNATURE_SAVE 0x65766173u",
        "    ODS_NMT_STATE_OPERATIONAL = 5,",
        "    ODS_NMT_COMMAND_RESET_NODE = 129,",
        "    ODS_MODE_HOMING = 6,",
        "    ODS_PDS_STATE_SWITCH_ON_DISABLED,",
        "    ODS_PDS_COMMAND_SHUTDOWN,",
        "    ODS_PDS_EVENT_FAULT,",
        "    ODS_EFFECT_CONTROLWORD,",
        "    ODS_CONDITIONS,",
        "#define ODS_VELOCITY_PPS_CODE 181",
        "#define ODS_VELOCITY_PPS_NUMERATOR 1",
        "#define ODS_VELOCITY_INTERNAL_CODE 0",
        "#define ODS_VELOCITY_INTERNAL_NUMERATOR 15625",
        "#define ODS_VELOCITY_INTERNAL_DENOMINATOR 16384",
        "#define ODS_ACCELERATION_PPS_CODE 179",
        "#define ODS_ACCELERATION_INTERNAL_NUMERATOR 244140625",
        "#define ODS_ACCELERATION_INTERNAL_DENOMINATOR 2097152",
    ):
        assert re.search(rf"^{re.escape(line)}( /\*|$)", words, re.MULTILINE), line
    assert "\n    uint16_t controlword; /*" in values
    assert "\n    uint8_t os_command[7]; /*" in values
    assert "pdo_mapping[" not in values


def test_two_elements_with_one_name(tmcm3230: Device) -> None:
    """The bit `b_c` of `a` and the bit `c` of `a_b` are both BIT_A_B_C."""
    (first, second) = [obj for obj in tmcm3230.objects if len(obj.entries) == 1 and obj.entries[0].bits][:2]
    objects = [
        replace(
            obj,
            name=name,
            entries=(replace(obj.entries[0], name=name, bits=(Bit(0, 0, bit, ""),)),),
        )
        for obj, name, bit in ((first, "a", "b_c"), (second, "a_b", "c"))
    ]
    others = [obj for obj in tmcm3230.objects if obj not in (first, second)]
    with pytest.raises(SpecError, match="TMCM3230_BIT_A_B_C"):
        CBackend().render(replace(tmcm3230, objects=tuple(sorted([*objects, *others], key=lambda obj: obj.index))))
