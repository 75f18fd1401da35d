"""`odsmith inject`, where nobody or somebody else answers."""

from __future__ import annotations

import socket
import threading

import pytest
from tests.unit.generator.commands.conftest import Run


def test_nobody_answers(run: Run) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # and nobody listens
        failed = run("inject", "--connect", f"127.0.0.1:{taken.getsockname()[1]}", "axis0", "left", "on")
    assert failed.status == 2
    assert "no virtual device answers" in failed.err
    assert "hint: start one: odsmith simulate tmcm6212" in failed.err


@pytest.mark.parametrize("answer", [b"", b"HTTP/1.1 400 Bad Request\r\n\r\n", b"x" * 10_000])
def test_somebody_else_answers(run: Run, answer: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            peer, _ = server.accept()
            with peer:
                peer.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        failed = run("inject", "--connect", f"127.0.0.1:{server.getsockname()[1]}", "lose", "1")
        thread.join()
    assert failed.status == 2
    assert "no virtual device answers" in failed.err


@pytest.mark.parametrize("words", [["axis0 > < send"], ["a;b"], ["überall"]])
def test_what_would_be_no_command(run: Run, words: list[str]) -> None:
    failed = run("inject", *words)
    assert failed.status == 2
    assert "is no command" in failed.err


def test_the_help_lists_what_can_be_done(run: Run) -> None:
    assert "the shaft is held" in run("inject", "--help").out
