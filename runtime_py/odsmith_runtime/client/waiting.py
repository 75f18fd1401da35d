"""How a client waits: the one place where the blocking face and the one for asyncio differ.

Everything else is written once, as coroutines that wait for nothing but a `Waiter`. The blocking one never suspends, so
that a coroutine above it runs to its end in a single step (`run`).
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from contextlib import AbstractAsyncContextManager
    from typing import Any, Protocol, TypeVar

    R = TypeVar("R")

    class Waiter(Protocol):
        """Time in seconds, and waiting for frames."""

        def now(self) -> float:
            """Seconds since some moment."""

        def notify(self) -> None:
            """A frame was received and dealt with. Called from any thread."""

        async def wait(self, arrived: Callable[[], bool], until: float) -> None:
            """Return once `arrived()` holds, which changes before a `notify` only, or at `until`."""

        def lock(self) -> AbstractAsyncContextManager[object]:
            """A lock for what must not happen twice at once."""


def run(coroutine: Coroutine[Any, Any, R]) -> R:
    """The result of a coroutine that only waits by a blocking waiter."""
    try:
        coroutine.send(None)
    except StopIteration as end:
        result: R = end.value
        return result
    coroutine.close()
    raise RuntimeError("this coroutine waits for an event loop: use the asyncio face")


class ThreadLock:
    """A lock of threads in the clothes of asyncio."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    async def __aenter__(self) -> None:
        self._lock.acquire()

    async def __aexit__(self, *_: object) -> None:
        self._lock.release()


class BlockingWaiter:
    """Blocks the thread; frames come from another one, that of python-can."""

    def __init__(self) -> None:
        self._bells: list[threading.Lock] = []  # held; released to wake who waits for it

    def now(self) -> float:
        return time.monotonic()

    def notify(self) -> None:
        for bell in tuple(self._bells):
            with contextlib.suppress(RuntimeError):  # it was rung already
                bell.release()

    async def wait(self, arrived: Callable[[], bool], until: float) -> None:
        while (left := until - self.now()) > 0:
            bell = threading.Lock()
            bell.acquire()
            self._bells.append(bell)
            try:
                if arrived():  # asked after the bell is known, so that no notification is lost
                    return
                bell.acquire(timeout=left)
            finally:
                self._bells.remove(bell)

    def lock(self) -> AbstractAsyncContextManager[object]:
        return ThreadLock()


class AsyncioWaiter:
    """Suspends the task; frames come from the thread of python-can."""

    def __init__(self) -> None:
        self._waiting: dict[asyncio.Future[None], asyncio.AbstractEventLoop] = {}

    def now(self) -> float:
        return time.monotonic()

    def notify(self) -> None:
        for future, loop in list(self._waiting.items()):
            loop.call_soon_threadsafe(_wake, future)

    async def wait(self, arrived: Callable[[], bool], until: float) -> None:
        loop = asyncio.get_running_loop()
        while (left := until - self.now()) > 0:
            future = loop.create_future()
            self._waiting[future] = loop
            try:
                if arrived():  # asked after the future is known, so that no notification is lost
                    return
                await asyncio.wait([future], timeout=left)
            finally:
                del self._waiting[future]

    def lock(self) -> AbstractAsyncContextManager[object]:
        return asyncio.Lock()


def _wake(future: asyncio.Future[None]) -> None:
    if not future.done():
        future.set_result(None)
