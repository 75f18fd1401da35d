"""One fault at a time, seeded into a good data sheet: the linter finds each, by the rule that is about it.

The good sheet is that of a small drive which we generate. Beside our verdict stands that of lely's dcfchk, the
strictest of the other open checkers: a fault that it lets pass is marked, and measured.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from odsmith.backends.eds import EdsBackend
from odsmith.eds_file import parse
from odsmith.errors import Diagnostic, Fix
from odsmith.lint import lint
from odsmith.model import Device
from odsmith.rules import RULES

Change = Callable[[str], str]


@dataclass(frozen=True)
class Seed:
    """A fault. `rules` are all that it breaks, the one that is about it first; `dcf` seeds it into a DCF."""

    name: str
    rules: str
    change: Change
    dcfchk_passes: bool = False
    dcf: bool = False


# ---- ways to spoil a file ----------------------------------------------------------------------------------------


def swap(old: str, new: str) -> Change:
    """Replaces the first occurrence of a text."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


def within(section: str, old: str, new: str) -> Change:
    """Replaces a text in a section; a new line in it is written as `|`."""

    def change(text: str) -> str:
        start = text.index(f"[{section}]\r\n")
        end = text.find("\r\n\r\n", start)
        body = text[start:end]
        assert old in body
        return text[:start] + body.replace(old, new.replace("|", "\r\n"), 1) + text[end:]

    return change


def without(section: str) -> Change:
    """Takes a section away."""

    def change(text: str) -> str:
        start = text.index(f"[{section}]\r\n")
        end = text.find("\r\n\r\n", start)
        return text[:start] + (text[end + 4 :] if end >= 0 else "")

    return change


def listed(name: str, edit: Callable[[list[str]], list[str]]) -> Change:
    """Edits the indices of a list of objects, and counts and numbers them again."""

    def change(text: str) -> str:
        start = text.index(f"[{name}]\r\n")
        end = text.find("\r\n\r\n", start)
        items = edit(re.findall(r"^\d+=(\S+)", text[start:end], re.MULTILINE))
        lines = [f"[{name}]", f"SupportedObjects={len(items)}", *(f"{n}={item}" for n, item in enumerate(items, 1))]
        return text[:start] + "\r\n".join(lines) + text[end:]

    return change


def drop(name: str, index: str) -> Change:
    return listed(name, lambda items: [item for item in items if item != index])


def add(name: str, index: str) -> Change:
    return listed(name, lambda items: [*items, index])


def both(*changes: Change) -> Change:
    def change(text: str) -> str:
        for each in changes:
            text = each(text)
        return text

    return change


def default(section: str, old: str, new: str) -> Change:
    return within(section, f"DefaultValue={old}", f"DefaultValue={new}")


OBJECTS = (
    *(0x1000, 0x1001, 0x1005, 0x1008, 0x1010, 0x1014, 0x1017, 0x1018, 0x1029, 0x1400, 0x1600, 0x1800, 0x1A00),
    *(0x2000, 0x2705, 0x6040, 0x6041, 0x605A, 0x6060, 0x6061, 0x6064, 0x6065, 0x6067, 0x606C, 0x607A, 0x607D),
    *(0x60C2, 0x60FF, 0x67FF),
)
NO_MAPPING = both(without("1600"), *(without(f"1600sub{sub}") for sub in range(4)))
ERROR_REGISTER = (
    "[1001]\r\nParameterName=Error Register\r\nObjectType=0x7\r\nDataType=0x0005\r\nAccessType=ro\r\n"
    "DefaultValue=0x00\r\nPDOMapping=0\r\n"
)
COMPACT = both(
    within("1010", "SubNumber=6", "CompactSubObj=6|DataType=0x0007|AccessType=rw"),
    *(without(f"1010sub{sub}") for sub in (0, 1, 2, 4, 5, 6)),
)

SEEDS = [
    # the text
    Seed("byte order mark", "L101", lambda text: "\ufeff" + text),
    Seed("comment before FileInfo", "L102", lambda text: "; made by a tool\r\n" + text, dcfchk_passes=True),
    Seed("character outside ASCII", "L103 L602", swap("Controlword 1", "Stra\u00dfe 1"), dcfchk_passes=True),
    Seed("LF line ends", "L104", lambda text: text.replace("\r\n", "\n"), dcfchk_passes=True),
    Seed("last line not ended", "L105", lambda text: text.rstrip(), dcfchk_passes=True),
    Seed("name of 300 characters", "L106 L602", swap("Controlword 1", "C" * 298 + " 1"), dcfchk_passes=True),
    Seed("comment between sections", "L107", swap("[6040]", "; an axis\r\n[6040]"), dcfchk_passes=True),
    Seed("line without meaning", "L108", swap("[6040]", "here follows an axis\r\n[6040]")),
    Seed("blanks around the equals sign", "L109", swap("Granularity=8", "Granularity = 8"), dcfchk_passes=True),
    Seed("text behind a section", "L110", swap("[6040]", "[6040] controlword"), dcfchk_passes=True),
    Seed("comment sign in a name", "L111 L602", swap("Controlword 1", "Controlword # 1"), dcfchk_passes=True),
    Seed("second equals sign", "L112", swap("=odsmith", "=a=b"), dcfchk_passes=True),
    Seed("key given twice", "L113", within("6041", "AccessType=ro", "AccessType=ro|AccessType=rw")),
    Seed("section given twice", "L114 L204", lambda text: text + "\r\n[1001]\r\nParameterName=Error Register\r\n"),
    Seed("number without digits", "L115", swap("VendorNumber=0x00000286", "VendorNumber="), dcfchk_passes=True),
    Seed("empty limit", "L115 L601", within("605A", "LowLimit=1", "LowLimit="), dcfchk_passes=True),
    Seed("leading zeros", "L116", within("605A", "LowLimit=1", "LowLimit=001")),
    Seed("not a number", "L117 L601", within("605A", "LowLimit=1", "LowLimit=one")),
    Seed("flag that is neither 0 nor 1", "L118", swap("LSS_Supported=0", "LSS_Supported=2"), dcfchk_passes=True),
    # sections and keys
    Seed("blank in a section name", "L201", swap("[1018sub1]", "[1018 sub1]")),
    Seed("sub-index with a leading zero", "L201", swap("[1018sub1]", "[1018sub01]")),
    Seed("unknown section", "L202", lambda text: text + "\r\n[Vendor]\r\nHotline=none\r\n"),
    Seed("no FileInfo", "L203", without("FileInfo"), dcfchk_passes=True),
    Seed("no DummyUsage", "L203", without("DummyUsage"), dcfchk_passes=True),
    Seed(
        "objects out of order",
        "L204",
        both(without("1001"), lambda text: text + "\r\n" + ERROR_REGISTER),
        dcfchk_passes=True,
    ),
    Seed("key of another tool", "L205", within("6041", "PDOMapping=1", "PDOMapping=1|Unit=none")),
    Seed("misspelt key", "L205", within("6041", "PDOMapping=1", "PDOMapping=1|ObjFlag=0")),
    Seed("case of a key", "L206", swap("NrOfRXPDO", "NrOfRxPDO"), dcfchk_passes=True),
    Seed("dummy missing", "L207", swap("Dummy0003=0\r\n", ""), dcfchk_passes=True),
    Seed("comments miscounted", "L208", swap("Lines=", "Lines=1"), dcfchk_passes=True),
    # lists
    Seed("list too short", "L211", swap("SupportedObjects=3", "SupportedObjects=2")),
    Seed("list too long", "L211", swap("SupportedObjects=3", "SupportedObjects=4")),
    Seed("count in hexadecimal", "L212", swap("SupportedObjects=3", "SupportedObjects=0x3")),
    Seed("hole in a list", "L213", swap("\r\n3=0x1018", "\r\n4=0x1018")),
    Seed("index without 0x", "L214", swap("3=0x1018", "3=4120"), dcfchk_passes=True),
    Seed("object listed twice", "L215", add("OptionalObjects", "0x1005"), dcfchk_passes=True),
    Seed(
        "object in the wrong list",
        "L216",
        both(drop("ManufacturerObjects", "0x2000"), add("OptionalObjects", "0x2000")),
    ),
    Seed("object without a section", "L217", add("OptionalObjects", "0x1006")),
    Seed("object not listed", "L218", drop("OptionalObjects", "0x1005"), dcfchk_passes=True),
    Seed("no 1001h", "L219", both(drop("MandatoryObjects", "0x1001"), without("1001")), dcfchk_passes=True),
    # the file and the device
    Seed("key missing", "L301", swap("Granularity=8\r\n", ""), dcfchk_passes=True),
    Seed("empty name of the vendor", "L301", swap("VendorName=Trinamic Motion Control GmbH", "VendorName="), True),
    Seed("other file name", "L302", swap("FileName=TMCM-3230.eds", "FileName=other.eds"), dcfchk_passes=True),
    Seed("version of 9 bits", "L303", swap("FileVersion=1", "FileVersion=256"), dcfchk_passes=True),
    Seed("old EDS version", "L304", swap("EDSVersion=4.0", "EDSVersion=3.0"), dcfchk_passes=True),
    Seed("time of 24 hours", "L305", swap("CreationTime=09:00AM", "CreationTime=21:00"), dcfchk_passes=True),
    Seed("date of ISO 8601", "L306", swap("CreationDate=11-22-2026", "CreationDate=2026-11-22"), dcfchk_passes=True),
    Seed("date that never was", "L306", swap("CreationDate=11-22-2026", "CreationDate=02-30-2026"), True),
    Seed("bit rate without a key", "L307", swap("BaudRate_125=1", "BaudRate_100=1\r\nBaudRate_125=1")),
    Seed("wrong NrOfRXPDO", "L309", swap("NrOfRXPDO=8", "NrOfRXPDO=4"), dcfchk_passes=True),
    Seed("wrong VendorNumber", "L310", swap("VendorNumber=0x00000286", "VendorNumber=0x00000287")),
    Seed(
        "identity without revision", "L311", within("1018sub3", "DefaultValue=0x00030016\r\n", ""), dcfchk_passes=True
    ),
    Seed("granularity 0", "L312", swap("Granularity=8", "Granularity=0"), dcfchk_passes=True),
    # a DCF
    Seed("no DeviceComissioning", "L203", without("DeviceComissioning"), dcfchk_passes=True, dcf=True),
    Seed("DeviceCommissioning", "L201", swap("DeviceComissioning", "DeviceCommissioning"), dcf=True),
    Seed("node-ID in hexadecimal", "L321", swap("NodeID=5", "NodeID=0x5"), dcfchk_passes=True, dcf=True),
    Seed("node-ID 0", "L321", swap("NodeID=5", "NodeID=0"), dcfchk_passes=True, dcf=True),
    Seed("parameter value in an EDS", "L322", within("605A", "PDOMapping=0", "PDOMapping=0|ParameterValue=6"), True),
    Seed(
        "parameter value with $NODEID",
        "L323",
        within("1014", "PDOMapping=0", "PDOMapping=0|ParameterValue=$NODEID+0x90"),
        dcfchk_passes=True,
        dcf=True,
    ),
    Seed(
        "parameter value as the default",
        "L324",
        within("605A", "PDOMapping=0", "PDOMapping=0|ParameterValue=2"),
        dcfchk_passes=True,
        dcf=True,
    ),
    # objects
    Seed("no access", "L401 L601", within("6041", "AccessType=ro\r\n", "")),
    Seed("no name", "L401", within("1018", "ParameterName=Identity Object\r\n", "")),
    Seed("unknown object type", "L402 L601", within("6041", "ObjectType=0x7", "ObjectType=0x1"), True),
    Seed("unknown data type", "L403 L601", within("6041", "DataType=0x0006", "DataType=0x00F6"), True),
    Seed("unknown access", "L404 L601", within("6041", "AccessType=ro", "AccessType=r")),
    Seed("default of a whole record", "L405", within("1018", "SubNumber=", "DefaultValue=1|SubNumber="), True),
    Seed("sub-indices of a variable", "L406 L401 L405", within("1018", "ObjectType=0x9", "ObjectType=0x7")),
    Seed("section of a sub-index missing", "L407", without("1010sub2")),
    Seed("wrong SubNumber", "L407", within("1018", "SubNumber=4", "SubNumber=5")),
    Seed("sub-index 0 of 16 bits", "L408", within("1010sub0", "DataType=0x0005", "DataType=0x0006")),
    Seed("sub-index 0 written", "L408", within("1010sub0", "AccessType=ro", "AccessType=rw"), dcfchk_passes=True),
    Seed("wrong highest sub-index", "L409", default("1010sub0", "0x06", "0x05"), dcfchk_passes=True),
    Seed("compact sub-indices", "L410", COMPACT, dcfchk_passes=True),
    Seed("sub-index without its object", "L411 L217", without("1018")),
    Seed("name given twice", "L412 L602", within("6041", "Statusword 1", "Controlword 1"), dcfchk_passes=True),
    Seed("long name of a PDO", "L413 L602", swap("RPDO 1 Comm", "Receive RPDO 1 Comm"), dcfchk_passes=True),
    Seed("command written on a scan", "L414", within("1010sub1", "ObjFlags=1", "ObjFlags=0"), dcfchk_passes=True),
    Seed("parameter never written", "L414", within("1017", "PDOMapping=0", "PDOMapping=0|ObjFlags=1"), True),
    Seed("drive that says it is none", "L415", default("1000", "0xFFFC0192", "0xFFFC0191"), dcfchk_passes=True),
    Seed("axis that is no drive", "L415 L601", default("6FFF", "0x00040192", "0x00040191"), dcfchk_passes=True),
    # values
    Seed("negative number as unsigned", "L421 L601", default("607Dsub1", "-2147483648", "0x80000001")),
    Seed("signed number in hexadecimal", "L422", default("605A", "2", "0x2"), dcfchk_passes=True),
    Seed("default outside its type", "L423 L409", default("1010sub0", "0x06", "0x106")),
    Seed("limits reversed", "L424 L425 L601", within("60C2sub2", "LowLimit=-3", "LowLimit=4")),
    Seed("default outside the limits", "L425 L601", default("60C2sub2", "-3", "-4")),
    Seed("limits missing", "L426", within("1029sub1", "LowLimit=0x00\r\nHighLimit=0x02\r\n", ""), True),
    Seed("node-ID in lower case", "L427", default("1014", "$NODEID+", "$nodeid+"), dcfchk_passes=True),
    Seed("node-ID behind", "L427", default("1014", "$NODEID+0x00000080", "0x00000080+$NODEID")),
    Seed("blanks around the plus", "L427", default("1014", "$NODEID+", "$NODEID + "), dcfchk_passes=True),
    Seed("CAN-ID without node-ID", "L428", default("1400sub1", "$NODEID+0x40000200", "0x40000201"), True),
    Seed(
        "default of a command",
        "L429",
        within("1010sub1", "PDOMapping=0", "DefaultValue=0x65766173|PDOMapping=0"),
        dcfchk_passes=True,
    ),
    Seed("default of the node-ID", "L430", within("2705", "PDOMapping=0", "DefaultValue=0x01|PDOMapping=0"), True),
    Seed("default of a text", "L431", within("1008", "PDOMapping=0", "DefaultValue=TMCM-3230|PDOMapping=0"), True),
    Seed("limit of a text", "L432", within("1008", "PDOMapping=0", "LowLimit=0|PDOMapping=0")),
    # PDOs
    Seed(
        "half a PDO",
        "L501 L604",
        both(drop("OptionalObjects", "0x1600"), NO_MAPPING),
    ),
    Seed(
        "mapping without default",
        "L502 L601",
        within("1601sub2", "DefaultValue=0x60600008\r\n", ""),
        dcfchk_passes=True,
    ),
    Seed("mapping of what does not exist", "L503 L601", default("1600sub1", "0x60400010", "0x60420010")),
    Seed("mapping of what is not mappable", "L504 L601", default("1600sub1", "0x60400010", "0x60650020"), True),
    Seed("mapping of a dummy", "L504 L601", default("1600sub1", "0x60400010", "0x00060010"), True),
    Seed("wrong length in a mapping", "L505 L601", default("1600sub1", "0x60400010", "0x60400008"), True),
    Seed(
        "PDO over 64 bits",
        "L506 L601",
        both(default("1602sub0", "0x02", "0x03"), default("1602sub3", "0x00000000", "0x60FF0020")),
        dcfchk_passes=True,
    ),
    Seed("RPDO of what is read-only", "L507 L601", default("1600sub1", "0x60400010", "0x60410010"), True),
    Seed("TPDO of what is written", "L507 L601", default("1A00sub1", "0x60410010", "0x60400010"), True),
    Seed("hole in a mapping", "L508 L601", default("1600sub0", "0x01", "0x02"), dcfchk_passes=True),
    Seed(
        "CAN-ID shared by PDOs",
        "L509",
        default("1401sub1", "$NODEID+0x40000300", "$NODEID+0x40000200"),
        dcfchk_passes=True,
    ),
    Seed("PDO access without mapping", "L510 L504 L601", within("6040", "PDOMapping=1", "PDOMapping=0"), True),
    Seed("reserved transmission type", "L511 L601", default("1400sub2", "0xFF", "0xFA"), dcfchk_passes=True),
    # axes
    Seed("access differs between axes", "L601", within("6860", "AccessType=rww", "AccessType=rw"), dcfchk_passes=True),
    Seed("limit differs between axes", "L601", within("68C2sub2", "HighLimit=3", "HighLimit=2"), dcfchk_passes=True),
    Seed("axis missing in a name", "L602", swap("Controlword 2", "Controlword"), dcfchk_passes=True),
    Seed("name differs between axes", "L602", swap("Controlword 2", "Control word 2"), dcfchk_passes=True),
    Seed("sub-index called otherwise", "L603", within("687Dsub1", "=Min", "=Minimal"), dcfchk_passes=True),
    Seed("object missing on an axis", "L604", both(drop("OptionalObjects", "0x6867"), without("6867")), True),
]

seeds = pytest.mark.parametrize("seed", SEEDS, ids=lambda seed: seed.name)


@pytest.fixture(scope="module")
def good(tmcm3230: Device) -> str:
    """A data sheet without a fault, of two axes and few objects, so that there is time for many faults."""
    objects = tuple(obj for obj in tmcm3230.objects if obj.index in OBJECTS)
    (output,) = EdsBackend().render(replace(tmcm3230, axes=2, objects=objects))
    return output.content.decode("ascii")


def as_dcf(eds: str) -> str:
    return eds.replace("TMCM-3230.eds", "TMCM-3230.dcf") + "\r\n[DeviceComissioning]\r\nNodeID=5\r\nNodeName=x axis\r\n"


def spoilt(good: str, seed: Seed) -> tuple[str, str]:
    """The file with the fault, and its name."""
    return (seed.change(as_dcf(good)), "TMCM-3230.dcf") if seed.dcf else (seed.change(good), "TMCM-3230.eds")


def findings(text: str, name: str) -> tuple[Diagnostic, ...]:
    return lint(parse(text.encode("utf-8"), name))


def test_the_good_sheets_are_good(good: str) -> None:
    assert findings(good, "TMCM-3230.eds") == ()
    assert findings(as_dcf(good), "TMCM-3230.dcf") == ()


@seeds
def test_the_fault_is_found(seed: Seed, good: str) -> None:
    found = findings(*spoilt(good, seed))
    rules = seed.rules.split()
    assert sorted({finding.rule for finding in found}) == sorted(rules)
    about = [finding for finding in found if finding.rule == rules[0]]
    assert all(finding.message and finding.severity == RULES[finding.rule].severity for finding in about)


def test_every_rule_of_the_linter_has_a_seed() -> None:
    assert {rule for seed in SEEDS for rule in seed.rules.split()} == {
        rule for rule in RULES if rule.startswith("L") and rule != "L100"
    }


@seeds
def test_the_proposed_fix_mends_it(seed: Seed, good: str) -> None:
    text, name = spoilt(good, seed)
    before = findings(text, name)
    for finding in before:
        if finding.fix:
            after = findings(applied(text, finding.fix), name)
            assert similar(after, finding) < similar(before, finding), finding


def applied(text: str, fix: Fix) -> str:
    lines = parse(text.encode("utf-8"), "").lines
    return "\r\n".join([*lines[: fix.first - 1], *fix.lines, *lines[fix.last :]])


def similar(found: tuple[Diagnostic, ...], finding: Diagnostic) -> int:
    return sum(item.rule == finding.rule and item.message == finding.message for item in found)


@pytest.mark.slow
def test_most_fixes_are_mechanical(good: str) -> None:
    mended = [seed for seed in SEEDS if any(finding.fix for finding in findings(*spoilt(good, seed)))]
    assert len(mended) > len(SEEDS) / 3


# ---- beside another checker --------------------------------------------------------------------------------------


@pytest.mark.slow
@seeds
def test_the_verdict_of_dcfchk(seed: Seed, good: str, tmp_path: Path) -> None:
    text, name = spoilt(good, seed)
    path = tmp_path / name
    path.write_bytes(text.encode("utf-8"))
    assert dcfchk_passes(path) == seed.dcfchk_passes


@pytest.mark.slow
def test_dcfchk_passes_the_good_sheets(good: str, tmp_path: Path) -> None:
    path = tmp_path / "TMCM-3230.eds"
    path.write_bytes(good.encode("ascii"))
    assert dcfchk_passes(path)


def dcfchk_passes(path: Path) -> bool:
    """What the program does: a pass is exit status 0 without a word on stderr."""
    from dcf.device import Device as DcfDevice  # type: ignore[import-untyped]
    from dcf.lint import lint as dcf_lint  # type: ignore[import-untyped]
    from dcf.parse import parse_file  # type: ignore[import-untyped]

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            config = parse_file(str(path))
            fine = bool(dcf_lint(config))
            DcfDevice(config, {"NODEID": 1})
        except Exception:
            return False
    return fine and not said


def test_dcfchk_lets_many_pass() -> None:
    """It tells an object that is not listed from a good file as little as a PDO of 80 bits."""
    assert sum(seed.dcfchk_passes for seed in SEEDS) >= 14
