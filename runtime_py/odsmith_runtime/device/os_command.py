"""The OS command 1023h (CiA 301, 7.5.2.26); the twin of `ods_os_command.c`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .port import OS_COMMAND_SIZE, OsStatus

if TYPE_CHECKING:
    from .node import Node


class OsCommand:
    def __init__(self, node: Node) -> None:
        self._node = node

    def run(self) -> None:
        """A command was written: carry it out."""
        values = self._node.values
        status, reply = self._node.port.os_command(values.os_command)
        if status in (OsStatus.DONE, OsStatus.FAILED):
            reply = b""  # there is none
        values.os_reply = reply[:OS_COMMAND_SIZE].ljust(OS_COMMAND_SIZE, b"\0")
        values.os_status = status
