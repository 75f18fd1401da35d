"""The electronic data sheet: the one file that configuration tools and PLCs read of a device (CiA 306-1).

The template lays the file out; this module finds the values of its keys. Where readers disagree on a rule of
CiA 306, the spelling that all of them understand is chosen here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from odsmith import escape
from odsmith.canopen_types import DataType, ObjectType, PdoDirection
from odsmith.model import Device, ExpandedEntry, ExpandedObject
from odsmith.render import MARK, Backend
from odsmith.vocabulary import Vocabulary

_BIT_RATES = (10, 20, 50, 125, 250, 500, 800, 1000)
"""Bit rates in kbit/s that [DeviceInfo] has a key for (CiA 306-1)."""

_MANDATORY = (0x1000, 0x1001, 0x1018)
"""The only objects that [MandatoryObjects] may list (CiA 301: every device has them)."""

_LINE_LENGTH = 255
"""Longest line of an EDS, line end left out (CiA 306-1)."""

_COMMENT_WIDTH = 100


@dataclass(frozen=True, slots=True)
class EntrySection:
    """A section that describes a value: a sub-index, or an object that is one variable. Empty text: no such key."""

    section: str
    parameter_name: str
    data_type: str
    access_type: str
    low_limit: str
    high_limit: str
    default: str
    pdo_mapping: int
    refuse_write_on_scan: bool


@dataclass(frozen=True, slots=True)
class ObjectSection:
    """An object. Where `head` is true it has a section of its own above those of its sub-indices."""

    head: bool
    section: str
    parameter_name: str
    object_type: str
    entries: tuple[EntrySection, ...]


@dataclass(frozen=True, slots=True)
class ObjectList:
    """One of the three lists of supported objects, as `0x1000`."""

    section: str
    indices: tuple[str, ...]


def eds_text(text: str) -> str:
    """Text as the value of a key. The equals sign goes too: readers need not agree on which of two splits a line."""
    return escape.eds_value(text).replace("=", ":")


class EdsBackend(Backend):
    """Writes `<device>/eds/<file>`, the file's name being the one that the spec gives."""

    name = "eds"
    filters: Mapping[str, Callable[..., Any]] = {"text": eds_text}

    def device_context(self, device: Device) -> Mapping[str, object]:
        identity = device.identity
        return {
            "identity": identity,
            "vendor_number": _number(identity.vendor_id, DataType.UNSIGNED32),
            "product_number": _number(identity.product_code, DataType.UNSIGNED32),
            "revision_number": _number(identity.revision_number, DataType.UNSIGNED32),
            "bit_rates": [(rate, int(rate in identity.bit_rates)) for rate in _BIT_RATES],
            "granularity": _granularity(device),
            "rpdos": sum(0x1400 <= item.index <= 0x15FF for item in device.expanded),
            "tpdos": sum(0x1800 <= item.index <= 0x19FF for item in device.expanded),
            "comments": list(_comments(device)),
            "lists": _lists(item.index for item in device.expanded),
            "objects": [_object(item) for item in device.expanded],
        }

    def output_path(self, relative: str, model: Device | Vocabulary) -> str:
        return model.identity.eds.file if isinstance(model, Device) else super().output_path(relative, model)

    def encode(self, path: str, text: str) -> bytes:
        """ASCII with CRLF; a line that is longer than a reader's buffer ends where the buffer does."""
        return "\r\n".join(line[:_LINE_LENGTH] for line in text.split("\n")).encode("ascii")


def _object(item: ExpandedObject) -> ObjectSection:
    obj = item.object
    section = f"{item.index:04X}"
    if obj.object_type is ObjectType.VAR:
        entries = [_entry(entry, section, item.parameter_name) for entry in item.entries]
    else:
        entries = [_entry(e, f"{section}sub{e.entry.sub:X}", e.entry.parameter_name) for e in item.entries]
    return ObjectSection(
        head=obj.object_type is not ObjectType.VAR,
        section=section,
        parameter_name=item.parameter_name,
        object_type=f"0x{obj.object_type.code:X}",
        entries=tuple(entries),
    )


def _entry(item: ExpandedEntry, section: str, parameter_name: str) -> EntrySection:
    entry = item.entry
    low, high = _limits(item)
    return EntrySection(
        section=section,
        parameter_name=parameter_name,
        data_type=f"0x{entry.type.code:04X}",
        access_type=entry.eds_access,
        low_limit=low,
        high_limit=high,
        default=_default(item),
        pdo_mapping=int(entry.mapping is not PdoDirection.NO),
        refuse_write_on_scan=entry.refuse_write_on_scan,
    )


def _default(item: ExpandedEntry) -> str:
    """Strings and floating point numbers have none: readers do not agree on how to spell one."""
    default = item.eds_default
    if default is None or not item.entry.type.integer:
        return ""
    number = _number(default.number, item.entry.type)
    return f"$NODEID+{number}" if default.node_id else number


def _limits(item: ExpandedEntry) -> tuple[str, str]:
    """Smallest and largest value. A signature has none: nothing between two signatures is one."""
    entry = item.entry
    if entry.allowed is None or entry.signatures or not entry.type.integer:
        return "", ""
    return _number(entry.allowed.low, entry.type), _number(entry.allowed.high, entry.type)


def _number(value: int, data_type: DataType) -> str:
    """Signed types in decimal, for 0xFD is -3 to some readers, 253 to others and an error to a third; others in
    hexadecimal, with all digits of the type."""
    return str(value) if data_type.signed else f"0x{value:0{data_type.bits // 4}X}"


def _granularity(device: Device) -> int:
    """In bits; 0 says that the mapping of PDOs is fixed, and tools then do not offer to change it."""
    return 8 if any(e.access.writable for o in device.objects if o.pdo.endswith("mapping") for e in o.entries) else 0


def _lists(indices: Iterable[int]) -> list[ObjectList]:
    """The three lists in the order of CiA 306; manufacturer's objects are those of 2000h to 5FFFh (CiA 301)."""
    lists: dict[str, list[str]] = {"MandatoryObjects": [], "OptionalObjects": [], "ManufacturerObjects": []}
    for index in indices:
        if index in _MANDATORY:
            section = "MandatoryObjects"
        elif 0x2000 <= index <= 0x5FFF:
            section = "ManufacturerObjects"
        else:
            section = "OptionalObjects"
        lists[section].append(f"0x{index:04X}")
    return [ObjectList(section, tuple(listed)) for section, listed in lists.items()]


def _comments(device: Device) -> Iterator[str]:
    for paragraph in _paragraphs(device):
        yield from escape.wrap(eds_text(paragraph), _COMMENT_WIDTH)


def _paragraphs(device: Device) -> Iterator[str]:
    identity = device.identity
    yield f"{MARK} from version {identity.version} of the {identity.name} specification: do not edit."
    yield f"Digest of the model: {device.digest}"
    without_key = [rate for rate in identity.bit_rates if rate not in _BIT_RATES]
    if without_key:
        rates = ", ".join(map(str, without_key))
        yield f"The device also runs at {rates} kbit/s, for which CiA 306 has no BaudRate key."
    if device.axes > 1:
        yield (
            f"Axes count from 0 to {device.axes - 1}, in emergency messages too, except at the end of the names of "
            "objects: a name that ends in 1 belongs to axis 0."
        )
    yield from identity.eds.comments
