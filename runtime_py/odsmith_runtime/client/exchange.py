"""Process data: what RPDOs and TPDOs carried last, by entry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .. import codec
from .link import SYNC

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..entries import Entry
    from .link import Link
    from .pdo_plan import Place


class Image:
    """The content of one PDO. `received` counts its frames."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self.received = 0
        self.values: dict[Entry[Any], Any] = dict.fromkeys(place.mapped.entries, 0)

    def pack(self) -> bytes:
        content = position = 0
        for entry, value in self.values.items():
            content |= (int(value) & (1 << entry.bit_length) - 1) << position
            position += entry.bit_length
        return content.to_bytes(self.place.octets, "little")

    def on_frame(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        self.unpack(bytes(data))

    def unpack(self, data: bytes) -> None:
        """Take the values from a frame; one that is too short says nothing."""
        if len(data) < self.place.octets:
            return
        content = int.from_bytes(data, "little")
        for entry in self.values:
            self.values[entry] = entry.decode(_octets(entry, content & (1 << entry.bit_length) - 1))
            content >>= entry.bit_length
        self.received += 1


class Exchange:
    """The PDOs that are configured, if any. `enabled` says whether they are used."""

    def __init__(self, link: Link) -> None:
        self.enabled = False
        self.sync_is_produced = False  # somebody sends SYNC in a cycle: nobody else has to
        self._link = link
        self._ends: list[Any] = []
        self._sent: dict[Entry[Any], Image] = {}
        self._received: dict[Entry[Any], Image] = {}

    def configure(self, places: tuple[Place, ...]) -> None:
        """Use these PDOs from now on."""
        for end in self._ends:
            end()
        self._ends = []
        self._sent.clear()
        self._received.clear()
        for place in places:
            image = Image(place)
            directions = self._sent if place.mapped.kind == "rpdo" else self._received
            directions.update(dict.fromkeys(place.mapped.entries, image))
            if place.mapped.kind == "tpdo":
                self._ends.append(self._link.subscribe(place.can_id, image.on_frame))
        self.enabled = bool(places)

    def carries(self, entry: Entry[Any]) -> bool:
        """Whether an RPDO carries the entry to the device."""
        return self.enabled and entry in self._sent

    def preset(self, entry: Entry[Any], value: Any) -> None:
        """What an RPDO says of an entry until somebody says something else."""
        if entry in self._sent:
            self._sent[entry].values[entry] = value

    def last_put(self, entry: Entry[Any]) -> Any:
        """What an RPDO says of an entry now."""
        return self._sent[entry].values[entry]

    def sent(self) -> tuple[Entry[Any], ...]:
        """All entries that RPDOs carry."""
        return tuple(self._sent)

    def put(self, values: Mapping[Entry[Any], Any]) -> None:
        """Send values by RPDO, with SYNC if they wait for one. Raises RefusedError before anything is sent."""
        for entry, value in values.items():
            entry.check(value)
        images = dict.fromkeys(self._sent[entry] for entry in values)
        for entry, value in values.items():
            self._sent[entry].values[entry] = value
        for image in images:
            self._link.send(image.place.can_id, image.pack())
        if any(image.place.mapped.on_sync for image in images):
            self._sync()

    async def get(self, entry: Entry[Any], timeout: float) -> Any:
        """The value that a TPDO brought last, None if none brings it or none came."""
        image = self._received.get(entry) if self.enabled else None
        if image is None:
            return None
        if image.place.mapped.on_sync and not self.sync_is_produced:
            seen = image.received
            for _ in range(image.place.mapped.on_sync):
                self.sync()
            await self._link.wait_until(lambda: image.received != seen, self._link.now() + timeout)
        return image.values[entry] if image.received else None

    def sync(self) -> None:
        """Send SYNC."""
        self._link.send(SYNC)

    def _sync(self) -> None:
        if not self.sync_is_produced:
            self.sync()


def _octets(entry: Entry[Any], content: int) -> bytes:
    return content.to_bytes(codec.size(entry.type) or (entry.bit_length + 7) // 8, "little")
