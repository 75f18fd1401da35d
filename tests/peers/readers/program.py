"""What every reader's program does around its `read`: the arguments, the silence that is asked for, the JSON.

    python -m readers.X NODE_ID,... FILE...

prints `{"version": ..., "readings": [{"file", "node_id", "messages", "tables"}, ...]}`, one reading per file and
node-ID. `messages` is whatever the reader said, in whatever way: printed, logged, warned, raised. `tables` is what it
read, in the form that `tests/peers/conftest.py` describes.
"""

from __future__ import annotations

import io
import json
import logging
import sys
import warnings
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from importlib import metadata

Rows = dict[str, dict[str, object]]
"""One row of facts per thing described, named by field."""

Tables = dict[str, Rows]

Read = Callable[[str, int], tuple[Tables, list[str]]]
"""`read(path, node_id)` gives what it read and what the reader returned as complaints."""


class _Kept(logging.Handler):
    def __init__(self, messages: list[str]) -> None:
        super().__init__(logging.WARNING)
        self.messages = messages

    def emit(self, record: logging.LogRecord) -> None:
        self.messages.append(f"{record.levelname}: {record.getMessage()}")


def main(distribution: str, read: Read) -> None:
    node_ids, *paths = sys.argv[1:]
    readings = [_reading(read, path, int(node_id)) for path in paths for node_id in node_ids.split(",")]
    json.dump({"version": metadata.version(distribution), "readings": readings}, sys.stdout)


def _reading(read: Read, path: str, node_id: int) -> dict[str, object]:
    messages: list[str] = []
    tables: Tables = {}
    printed = io.StringIO()
    logging.getLogger().handlers = [_Kept(messages)]
    with warnings.catch_warnings(record=True) as caught, redirect_stdout(printed), redirect_stderr(printed):
        warnings.simplefilter("always")
        try:
            tables, complaints = read(path, node_id)
            messages += complaints
        except Exception as error:  # whatever a foreign program raises is a finding; other files are still to be read
            messages.append(f"{type(error).__name__}: {error}")
    messages += [f"{warning.category.__name__}: {warning.message}" for warning in caught]
    messages += printed.getvalue().splitlines()
    return {"file": path, "node_id": node_id, "messages": messages, "tables": tables}
