"""All parameters of a device in a file, and back: what `store` would keep, by name.

The file is YAML: the device, then for the whole device and each axis the values by name. PDO parameters have the number
of their PDO in the name: `rpdo_communication.1.cob_id`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from .errors import ClientError, MissingPackageError
from .pdo_setup import write_record

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ..entries import Entry
    from .access import Access

BUS = "bus"
"""The storage group of node-ID and bit rate: never written from a file, which would lose the node."""


class Difference(NamedTuple):
    """An entry that is not what the file says; `written` once it was made so."""

    entry: Entry[Any]
    in_device: Any
    in_file: Any
    written: bool

    def __str__(self) -> str:
        note = "" if self.written else " (left as it is)"
        return f"{self.entry.label}: {self.in_device} in the device, {self.in_file} in the file{note}"


class Report(NamedTuple):
    """What loading a file found: differences, names of the file that the device has not, and the other way round."""

    differences: tuple[Difference, ...]
    unknown: tuple[str, ...]
    missing: tuple[str, ...]

    def __str__(self) -> str:
        lines = [str(difference) for difference in self.differences] or ["no differences"]
        lines += (f"{name}: the device has no such entry" for name in self.unknown)
        lines += (f"{name}: not in the file" for name in self.missing)
        return "\n".join(lines)


async def save(access: Access, path: str | Path) -> None:
    """Write all parameters of the device to a file."""
    content: dict[str, Any] = {"device": access.facts.identity.name}
    for (section, name), entry in _entries(access).items():
        content.setdefault(section, {})[name] = _plain(await access.read(entry))
    text = _yaml().safe_dump(content, sort_keys=False)
    Path(path).write_text(text, encoding="utf-8")


async def load(access: Access, path: str | Path, write: bool) -> Report:
    """Compare a file with the device, and write what differs. Raises ClientError for a file of something else."""
    content = _yaml().safe_load(Path(path).read_text(encoding="utf-8"))
    name = access.facts.identity.name
    if not isinstance(content, dict) or content.get("device") != name:
        raise ClientError(f"{path} holds no parameters of a {name}")
    entries = _entries(access)
    wanted = {
        (part, key): value for part in content if part != "device" for key, value in (content[part] or {}).items()
    }
    differences = []
    for key, entry in entries.items():
        if key not in wanted:
            continue
        value = _plain(await access.read(entry))
        if value != wanted[key]:
            may = write and entry.stored != BUS
            differences.append(Difference(entry, value, wanted[key], may))
            if may:
                entry.check(_typed(entry, wanted[key]))
    await _write(access, [difference for difference in differences if difference.written])
    unknown = tuple(f"{part}: {key}" for part, key in wanted if (part, key) not in entries)
    missing = tuple(f"{part}: {key}" for part, key in entries if (part, key) not in wanted)
    return Report(tuple(differences), unknown, missing)


async def _write(access: Access, differences: list[Difference]) -> None:
    """Plain entries one by one, a PDO as a whole, as its entries depend on each other."""
    of_pdos: dict[Entry[Any], Any] = {}
    for difference in differences:
        value = _typed(difference.entry, difference.in_file)
        if difference.entry.parent.pdo:
            of_pdos[difference.entry] = value
        else:
            await access.write(difference.entry, value)
    for record in access.facts.dictionary.pdos:
        if any(entry.parent in (record.communication, record.mapping) for entry in of_pdos):
            communication = {
                entry.sub: of_pdos.get(entry, await access.read(entry))
                for entry in record.communication
                if entry.writable
            }
            mapping = [of_pdos.get(entry, await access.read(entry)) for entry in record.mapping]
            await write_record(access, record, communication, mapping[1 : 1 + int(mapping[0])])


def _entries(access: Access) -> Mapping[tuple[str, str], Entry[Any]]:
    """What a file holds, by section and name."""
    return {_key(entry): entry for entry in _stored(access)}


def _stored(access: Access) -> Iterator[Entry[Any]]:
    return (entry for entry in access.facts.entries() if entry.stored != "never" and entry.access == "rw")


def _key(entry: Entry[Any]) -> tuple[str, str]:
    section = "whole_device" if entry.axis is None else f"axis_{entry.axis}"
    name = entry.full_name
    if entry.parent.pdo:
        name = f"{entry.parent.name}.{entry.parent.number}.{entry.name}"
    return section, name


def _plain(value: Any) -> int | float | str:
    """A value as YAML has it; octets as hexadecimal digits."""
    if isinstance(value, bytes):
        return value.hex(" ")
    return value if isinstance(value, (str, float)) else int(value)


def _typed(entry: Entry[Any], value: Any) -> Any:
    return bytes.fromhex(value) if entry.type in ("OCTET_STRING", "DOMAIN") else value


def _yaml() -> Any:
    try:
        import yaml
    except ImportError as error:
        raise MissingPackageError("parameter files need PyYAML: pip install 'odsmith[client]'") from error
    return yaml
