"""What a drive and its axes have in common: the link to the node, the facts about it, and its values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .access import Access
from .async_values import AsyncValue
from .exchange import Exchange

if TYPE_CHECKING:
    from ..entries import Entry
    from .facts import Facts
    from .link import Link


class Core:
    """Values go by PDO where one carries them and PDOs are in use, else by SDO."""

    def __init__(self, link: Link, facts: Facts, timeout: float) -> None:
        self.link = link
        self.facts = facts
        self.access = Access(link, facts, timeout)
        self.exchange = Exchange(link)
        self.access.when_written = self.exchange.preset  # or an RPDO would take it back

    def value(self, entry: Entry[Any]) -> AsyncValue[Any]:
        """What stands behind the name of an entry."""
        return AsyncValue(self.access, entry)

    async def get(self, entry: Entry[Any]) -> Any:
        """The value of an entry: what a TPDO brought last, or read now."""
        value = await self.exchange.get(entry, self.access.sdo.timeout)
        return await self.access.read(entry) if value is None else value

    async def last_put(self, entry: Entry[Any]) -> Any:
        """The value that was written last, by whatever way."""
        return self.exchange.last_put(entry) if self.exchange.carries(entry) else await self.access.read(entry)

    async def put(self, values: dict[Entry[Any], Any]) -> None:
        """Write entries, in order: all by RPDO if each is carried by one, else all by SDO."""
        if all(self.exchange.carries(entry) for entry in values):
            self.exchange.put(values)
            return
        for entry, value in values.items():
            await self.access.write(entry, value)

    def join(self, node_id: int) -> None:
        """Go on with another node-ID. Its PDOs have to be configured anew."""
        self.exchange.configure(())
        self.link.join(node_id)
        self.access.sdo.join()
