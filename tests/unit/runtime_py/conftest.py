"""A device of two axes as a generated package would describe it, small enough to read."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest

from odsmith_runtime import ObjectDictionary
from odsmith_runtime.choices import Bits, Choice
from odsmith_runtime.names import Family, Group, Names, Sub, Variable
from odsmith_runtime.units import Unit


class ChopperMode(Choice):
    SPREAD_CYCLE = 0, "spreadCycle."
    CONSTANT_OFF_TIME = 1, "Constant off time."
    OTHER = 5


class Controlword(Bits):
    SWITCH_ON = 1 << 0, "Part of the command."
    MODE_SPECIFIC = 0x70, "Depends on the mode."
    HALT = 1 << 8, "Stops.", False


class HomingSpeeds(Names):
    fast: Sub[int] = Sub(1)
    slow: Sub[int] = Sub(2)


class RpdoCommunication(Names):
    cob_id: Sub[int] = Sub(1)


class DeviceObjects(Names):
    device_name: Variable[str] = Variable(0x1008)


class AxisObjects(Names):
    rpdo_communication: Family[RpdoCommunication] = Family(0x1400, 2, RpdoCommunication)
    chopper_mode: Variable[ChopperMode | int] = Variable(0x2093)
    controlword: Variable[Controlword] = Variable(0x6040)
    homing_speeds: Group[HomingSpeeds] = Group(0x6099, HomingSpeeds)


UNITS = {
    "velocity": Unit(name="velocity", symbol="pps", quantity="velocity", base="step/s", numerator=1, denominator=3),
}

TEXTS = {
    ("controlword", None): ("Commands the axis.", "manual, section 1"),
    ("homing_speeds", None): ("Speeds.", "manual, section 2"),
    ("homing_speeds", 1): ("Fast one.", "manual, section 3"),
}

HIGHEST = (("name", "highest_sub_index"), ("title", "Highest"), ("parameter_name", "Highest"))


def _dictionary() -> ObjectDictionary:
    return ObjectDictionary(
        "toy",
        axis_count=2,
        areas=((0x2000, 0x21FF, 0x200), (0x6000, 0x67FF, 0x800), (0x1400, 0x143F, 0x40), (0x1600, 0x163F, 0x40)),
        objects={
            0x1008: ("device_name", "Device name", "Device Name", "VAR", 0, 1, ""),
            0x1014: ("cob_id_emcy", "COB-ID EMCY", "COB-ID EMCY", "VAR", 0, 1, ""),
            0x1400: (
                "rpdo_communication",
                "RPDO {number}",
                "RPDO {number} Comm",
                "RECORD",
                0x40,
                2,
                "rpdo_communication",
            ),
            0x1600: ("rpdo_mapping", "RPDO {number} map", "RPDO {number} Map", "RECORD", 0x40, 2, "rpdo_mapping"),
            0x2093: ("chopper_mode", "Chopper mode", "Chopper Mode", "VAR", 0x200, 1, ""),
            0x2700: ("os_command", "OS command", "OS Command", "VAR", 0, 1, ""),
            0x2701: ("command", "Command", "Command", "VAR", 0, 1, ""),
            0x2702: ("fraction", "Fraction", "Fraction", "VAR", 0, 1, ""),
            0x6040: ("controlword", "Controlword", "Controlword", "VAR", 0x800, 1, ""),
            0x6041: ("statusword", "Statusword", "Statusword", "VAR", 0x800, 1, ""),
            0x6099: ("homing_speeds", "Homing speeds", "Homing Speeds", "ARRAY", 0x800, 1, ""),
            0x6502: ("modes", "Modes", "Modes", "VAR", 0x800, 1, ""),
        },
        entries={
            0x1008_00: ("VISIBLE_STRING", "rw", "no", "toy", ("length", 5)),
            0x1014_00: ("UNSIGNED32", "rw", "no", ("$NODEID", 0x80)),
            0x1400_00: ("UNSIGNED8", "ro", "no", 2, *HIGHEST),
            0x1400_01: ("UNSIGNED32", "rw", "no", None, ("name", "cob_id"), ("role", "pdo_cob_id")),
            0x1400_02: ("UNSIGNED8", "rw", "no", None, ("name", "type"), ("role", "pdo_transmission_type")),
            0x1600_00: ("UNSIGNED8", "rw", "no", None, ("name", "mapped"), ("role", "pdo_mapped_count")),
            0x1600_01: ("UNSIGNED32", "rw", "no", None, ("name", "first"), ("role", "pdo_mapping")),
            0x1600_02: ("UNSIGNED32", "rw", "no", None, ("name", "second"), ("role", "pdo_mapping"), ("repeat", 1)),
            0x2093_00: ("UNSIGNED8", "rw", "no", 0, ("allowed", ((0, 1), (5, 5))), ("values_class", "ChopperMode")),
            0x2700_00: ("OCTET_STRING", "rw", "no", None, ("length", 3)),
            0x2701_00: ("UNSIGNED32", "wo", "no", 1, ("signatures", (("save", 0x65766173),))),
            0x2702_00: ("REAL32", "rw", "no", None),
            0x6040_00: ("UNSIGNED16", "rw", "rx", None, ("bits_class", "Controlword"), ("role", "controlword")),
            0x6041_00: ("UNSIGNED16", "ro", "tx", None, ("role", "statusword")),
            0x6099_00: ("UNSIGNED8", "ro", "no", 2, *HIGHEST),
            0x6099_01: (
                "INTEGER32",
                "rw",
                "both",
                7,
                ("name", "fast"),
                ("allowed", ((-5, 9),)),
                ("unit_name", "velocity"),
            ),
            0x6099_02: ("INTEGER32", "rw", "no", 0, ("name", "slow"), ("allowed", ((0, 0), (2, 15)))),
            0x6502_00: ("UNSIGNED32", "ro", "no", 5),
        },
        pdos={
            ("rpdo", 1): (("$NODEID", 0x200), 0xC0000000, 255, 0, 0, (0x6040_0010,)),
            ("rpdo", 2): (("$NODEID", 0x300), 0xC0000000, 1, 0, 0, (0x6040_0010, 0x6099_0120)),
        },
        max_pdo_entries=3,
    )


@pytest.fixture
def dictionary() -> Iterator[ObjectDictionary]:
    """The dictionary of the package `toy`, whose modules are there as long as the test runs."""
    modules: dict[str, dict[str, Any]] = {
        "enums": {"ChopperMode": ChopperMode},
        "flags": {"Controlword": Controlword},
        "objects": {"AxisObjects": AxisObjects, "DeviceObjects": DeviceObjects},
        "units": {"UNITS": UNITS},
        "texts": {"TEXTS": TEXTS},
    }
    for name, content in modules.items():
        module = ModuleType(f"toy.{name}")
        vars(module).update(content)
        sys.modules[module.__name__] = module
    yield _dictionary()
    for name in modules:
        del sys.modules[f"toy.{name}"]
