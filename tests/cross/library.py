"""The C testee inside this process: a thousand lines in the time in which a program answers one hundred.

    testee = CBench(build_library(device, ...), node_id=5)
    testee.answer("POWER on")

It gives the text that the program gives. What the sanitizers would see it does not, so both have their tests.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cffi import FFI  # type: ignore[import-untyped]
from tests.cross.build import Build, build_library, shared_folder

from odsmith.model import Device
from odsmith.vocabulary import Vocabulary

_FFI = FFI()
_FFI.cdef("""
    typedef struct testee testee_t;
    testee_t *testee_new(unsigned node_id, uint32_t serial, uint32_t time);
    const char *testee_answer(testee_t *testee, const char *line);
    void testee_free(testee_t *testee);
    void testee_controlwords(testee_t *testee, uint8_t axis, uint32_t *results);
""")


class CBench:
    """A testee of the library at `path`, still without power."""

    def __init__(self, path: Path, *, node_id: int = 0, serial: int = 0, time: int = 0) -> None:
        library = _FFI.dlopen(str(path))
        self._ask = library.testee_answer
        self._try_controlwords = library.testee_controlwords
        testee = library.testee_new(node_id, serial, time)
        assert testee != _FFI.NULL, "no memory, or the image is too small"
        self._testee = _FFI.gc(testee, library.testee_free)

    def answer(self, line: str) -> list[str]:
        """Obey a line; gives its answer. AssertionError: the runtime asked its port for what there is not."""
        text = self._ask(self._testee, b"" if "\0" in line else line.encode())
        assert text != _FFI.NULL, "the C runtime is broken: see the standard error output"
        return _FFI.string(text).decode("ascii").splitlines()  # type: ignore[no-any-return]

    def controlwords(self, axis: int) -> list[int]:
        """What each of them would make of an axis: its statusword, and in bit 16 whether its motor has current then."""
        results = _FFI.new("uint32_t[]", 0x10000)
        self._try_controlwords(self._testee, axis, results)
        return list(results)


StartC = Callable[..., CBench]


@pytest.fixture(name="start_c", scope="session")
def start_c_fixture(c_build: Build, vocabulary: Vocabulary, tmp_path_factory: pytest.TempPathFactory) -> StartC:
    """`start_c(device, node_id=5)`: a C testee in this process, still without power."""
    folder = shared_folder(tmp_path_factory.getbasetemp())
    made: dict[str, Path] = {}

    def begin(device: Device, *, node_id: int = 0, serial: int = 0, time: int = 0) -> CBench:
        if device.digest not in made:
            made[device.digest] = build_library(device, vocabulary, c_build, folder)
        return CBench(made[device.digest], node_id=node_id, serial=serial, time=time)

    return begin
