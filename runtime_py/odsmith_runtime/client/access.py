"""Reading and writing entries of a device by SDO: checked before, explained after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

from odsmith_cia.codes import AbortCode

from .errors import NoAnswerError, SdoAborted
from .sdo import SdoClient, TransferAborted

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..entries import Entry
    from ..units import Unit
    from .facts import Facts
    from .link import Link


class Access:
    """The entries of one node. `when_written` is told of every write that the device took."""

    def __init__(self, link: Link, facts: Facts, timeout: float) -> None:
        self.link = link
        self.facts = facts
        self.sdo = SdoClient(link, timeout)
        self.when_written: Callable[[Entry[Any], Any], None] = lambda entry, value: None

    async def read(self, entry: Entry[Any]) -> Any:
        """The value of an entry, typed. Raises SdoAborted, NoAnswerError, WrongLengthError."""
        try:
            return entry.decode(await self.sdo.upload(entry.index, entry.sub))
        except TransferAborted as end:
            self._explain(end, entry, None)

    async def write(self, entry: Entry[Any], value: Any) -> None:
        """Write an entry. Raises RefusedError before anything is sent, then SdoAborted, NoAnswerError."""
        entry.check(value)
        try:
            await self.sdo.download(entry.index, entry.sub, entry.encode(value))
        except TransferAborted as end:
            self._explain(end, entry, value)
        self.when_written(entry, value)

    async def unit(self, entry: Entry[Any]) -> Unit | None:
        """The unit of an entry; where another object chooses it, that object is read."""
        unit = entry.unit
        if unit is None or not unit.selected_by:
            return unit
        chosen = await self.read(self.facts.dictionary.entry(unit.selected_by, entry.axis))
        return self.facts.dictionary.units[dict(unit.options)[int(chosen)]]

    def _explain(self, end: TransferAborted, entry: Entry[Any], value: object) -> NoReturn:
        if end.here and end.code == AbortCode.TIMEOUT:
            access = "reading" if value is None else f"writing {value!r} to"
            raise NoAnswerError(
                f"{access} {entry.label}: node {self.link.id} did not answer within {self.sdo.timeout:g} s; "
                f"{self.link.last_seen}. Is it powered, on this bus and bit rate, and not STOPPED?"
            ) from None
        raise SdoAborted(entry, value, end.code, self.facts.find_abort_code(end.code)) from None
