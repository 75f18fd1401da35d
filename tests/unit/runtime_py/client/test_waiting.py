"""How the two faces wait for frames of a real bus. Nothing here sleeps: what is waited for comes, or is over."""

from __future__ import annotations

import asyncio
import threading

import pytest
from tests.unit.runtime_py.client.faces import Bench

from odsmith_runtime.client.waiting import AsyncioWaiter, BlockingWaiter, run


class Mailbox:
    def __init__(self, waiter: BlockingWaiter | AsyncioWaiter) -> None:
        self.waiter = waiter
        self.is_full = False

    def deliver(self) -> None:
        self.is_full = True
        self.waiter.notify()


def test_blocking_for_what_another_thread_brings() -> None:
    mailbox = Mailbox(BlockingWaiter())
    thread = threading.Thread(target=mailbox.deliver)
    waiting = mailbox.waiter.wait(lambda: mailbox.is_full, mailbox.waiter.now() + 60)
    thread.start()
    run(waiting)
    assert mailbox.is_full
    thread.join()


def test_asyncio_waits_for_what_another_thread_brings() -> None:
    async def story() -> None:
        mailbox = Mailbox(AsyncioWaiter())
        thread = threading.Thread(target=mailbox.deliver)
        waiting = asyncio.ensure_future(mailbox.waiter.wait(lambda: mailbox.is_full, mailbox.waiter.now() + 60))
        await asyncio.sleep(0)
        assert not waiting.done()
        thread.start()
        await waiting
        assert mailbox.is_full
        thread.join()

    asyncio.run(story())


def test_what_is_there_already_is_not_waited_for() -> None:
    for waiter in (BlockingWaiter(), AsyncioWaiter()):
        mailbox = Mailbox(waiter)
        mailbox.deliver()
        asyncio.run(waiter.wait(lambda mailbox=mailbox: mailbox.is_full, waiter.now() + 60))  # type: ignore[misc]


def test_a_moment_that_is_over_ends_the_wait() -> None:
    for waiter in (BlockingWaiter(), AsyncioWaiter()):
        asyncio.run(waiter.wait(lambda: False, waiter.now() - 1))


def test_locks_let_one_in() -> None:
    async def story(waiter: BlockingWaiter | AsyncioWaiter) -> None:
        lock = waiter.lock()
        async with lock:
            pass
        async with lock:
            pass

    for waiter in (BlockingWaiter(), AsyncioWaiter()):
        asyncio.run(story(waiter))


def test_a_blocking_drive_takes_no_coroutine_of_asyncio() -> None:
    with pytest.raises(RuntimeError, match="use the asyncio face"):
        run(asyncio.sleep(0))


def test_virtual_time_gets_past_what_is_no_whole_microsecond(blocking: Bench) -> None:
    waiter = blocking.network.waiter()
    for fraction in (0.1, 0.4, 0.5, 0.9):
        until = waiter.now() + fraction / 1e6
        run(waiter.wait(lambda: False, until))
        assert waiter.now() >= until
