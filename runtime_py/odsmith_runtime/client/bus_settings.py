"""Storing, restoring, and changing node-ID and bit rate by the procedures of the manuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import NmtCommand, Signature

from .errors import ClientError, NoAnswerError
from .link import NMT

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..entries import Entry
    from .core import Core

_BUS = ("bus",)
RETRY = 0.1
"""Seconds between two attempts to reach a node that has changed its bit rate."""


def signature_entry(core: Core, effect: str, group: str) -> Entry[Any]:
    """The entry that stores or restores a group, by its name. Raises ValueError with the names that there are."""
    entries = {entry.name: entry for entry in core.facts.entries() if entry.effect == effect and entry.signatures}
    if group not in entries:
        raise ValueError(f"no group is called {group!r}; groups: {', '.join(entries)}")
    return entries[group]


async def store(core: Core, group: str) -> None:
    await core.access.write(signature_entry(core, "store", group), Signature.SAVE)


async def restore(core: Core, group: str) -> None:
    await core.access.write(signature_entry(core, "restore", group), Signature.LOAD)


async def _store_bus(core: Core) -> None:
    """Store node-ID and bit rate, and nothing else."""
    for entry in core.facts.entries():
        if entry.effect == "store" and entry.groups == _BUS:
            await core.access.write(entry, Signature.SAVE)
            return
    raise ClientError(f"{core.facts.identity.name} cannot store its node-ID and bit rate")


async def change_node_id(core: Core, node_id: int, timeout: float) -> None:
    """Write, store, reset the node, and go on under the new node-ID."""
    before = core.link.id
    await core.access.write(core.facts.entry("node_id"), node_id)
    await _store_bus(core)
    core.join(node_id)
    core.link.send(NMT, bytes([NmtCommand.RESET_NODE, before]))
    await core.link.wait_for_boot_up(0, timeout)


async def change_bit_rate(core: Core, kbit_per_s: int, reconnect: Callable[[], object], timeout: float) -> None:
    """Write, store, reset the node, bring this side to the new bit rate and wait until the node is reached."""
    rates = core.facts.identity.bit_rates
    if kbit_per_s not in rates:
        raise ValueError(f"{kbit_per_s} kbit/s is none of the bit rates {', '.join(map(str, rates))}")
    await core.access.write(core.facts.entry("can_bit_rate"), kbit_per_s)
    await _store_bus(core)
    core.link.command(NmtCommand.RESET_NODE)
    reconnect()
    core.exchange.configure(())
    until = core.link.now() + timeout
    while True:
        try:
            await core.access.read(core.facts.dictionary[0x1000][0])  # device type, which every node has
        except NoAnswerError:
            if core.link.now() >= until:
                raise
            await core.link.pause(RETRY)
        else:
            return
