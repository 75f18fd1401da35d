"""The image of either device is the other's: equal after each save and at each loss of power, and either boots it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.cross.events import SAVE, Lines, download, events_of
from tests.cross.expected import places
from tests.cross.library import CBench, StartC, start_c_fixture  # noqa: F401  (a fixture)
from tests.cross.testee import Bench

from odsmith.model import Device

pytestmark = pytest.mark.slow

NODE_ID = 5

EVERYTHING = "DUMP 0000-FFFF"

Testee = CBench | Bench


@pytest.fixture
def pair(start_c: StartC, start_python: Callable[..., Bench]) -> Callable[[Device], tuple[CBench, Bench]]:
    """A new testee of each language, still without power."""
    return lambda device: (start_c(device, node_id=NODE_ID), start_python(device, node_id=NODE_ID))


def same(testees: tuple[CBench, Bench], line: str) -> list[str]:
    """The answer of both."""
    c, python = (testee.answer(line) for testee in testees)
    assert c == python, f"{line}: {sorted(set(c) ^ set(python))}"
    return c


def setting(image: list[str]) -> Lines:
    """Lines that make an image that `NVM` has told."""
    return [line.replace("NVM", "NVM set", 1) for line in image if line.startswith("NVM ")]


def save(sub: int) -> Lines:
    return download(NODE_ID, 0x1010, sub, SAVE.to_bytes(4, "little"))


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
@settings(max_examples=25, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_each_boots_what_the_other_has_saved(
    name: str,
    data: st.DataObject,
    pair: Callable[[Device], tuple[CBench, Bench]],
    request: pytest.FixtureRequest,
) -> None:
    device: Device = request.getfixturevalue(name)
    events = events_of(device, NODE_ID)
    groups = [sub for index, sub in places(device, "store") if index == 0x1010]
    testees = pair(device)
    same(testees, "POWER on")
    images: list[list[str]] = []
    for _ in range(data.draw(st.integers(1, 3), "saves")):
        changes = data.draw(st.lists(st.one_of(events.write, events.pdo), max_size=15), "changes")
        for line in [line for lines in changes for line in lines] + save(data.draw(st.sampled_from(groups), "group")):
            same(testees, line)
        images = [testee.answer("NVM") for testee in testees]
        assert images[0] == images[1]
    fresh = pair(device)
    for line in setting(images[1]):
        fresh[0].answer(line)
    for line in setting(images[0]):
        fresh[1].answer(line)
    for line in ("NVM", "POWER on", EVERYTHING, "NVM"):
        same(fresh, line)


def saved(testee: Testee, image: list[str], cut: int = 0) -> list[str]:
    """Boot an image, give other values, and save them, during which power may go. The image that is left."""
    for line in [
        *setting(image),
        "POWER on",
        *download(NODE_ID, 0x1017, 0, b"\x64\x00"),
        *download(NODE_ID, 0x1029, 1, b"\x01"),
        *([f"POWER cut {cut}"] if cut else []),
        *save(1),
        "POWER cut",
    ]:
        testee.answer(line)
    return testee.answer("NVM")


def booted(testee: Testee) -> list[str]:
    """The entries after power-on, which leaves the image as it is."""
    image = testee.answer("NVM")
    start = testee.answer("POWER on")
    dump = testee.answer(EVERYTHING)
    assert testee.answer("NVM")[:-1] == image[:-1]
    return [*start, *dump]


HEADER = 12
"""Octets that are written last."""


@pytest.mark.parametrize("name", ["tmcm3230", "tmcm6212"])
def test_power_lost_at_each_octet(
    name: str,
    pair: Callable[[Device], tuple[CBench, Bench]],
    start_c: StartC,
    start_python: Callable[..., Bench],
    request: pytest.FixtureRequest,
) -> None:
    """The second save of a device, cut at each octet it writes: what is booted is all old, from some octet on all new.

    In Python, which is slow, each octet of the header, and one in 40 of the payload before.
    """
    device: Device = request.getfixturevalue(name)
    first = pair(device)
    for line in ("POWER on", *save(1), "POWER cut"):
        same(first, line)
    old = same(first, "NVM")
    old_boot = booted(first[0])

    in_c, in_python = pair(device)
    written = recorded(in_python)
    new = saved(in_python, old)
    assert saved(in_c, old) == new
    new_boot = booted(in_c)
    assert booted(in_python) == new_boot != old_boot

    boots = []
    for cut in range(1, len(written) + 2):
        in_c = start_c(device, node_id=NODE_ID)
        image = saved(in_c, old, cut)
        assert octets(image) == patched(octets(old), written[: cut - 1]), f"cut at {cut}"
        boots.append(booted(in_c))
        if cut == 1 or cut % 40 == 0 or cut > len(written) - HEADER:
            in_python = start_python(device, node_id=NODE_ID)
            assert saved(in_python, old, cut) == image, f"cut at {cut}"
            assert booted(in_python) == boots[-1], f"cut at {cut}"
    changes = boots.index(new_boot)
    assert len(written) - HEADER < changes <= len(written)
    assert boots == [old_boot] * changes + [new_boot] * (len(boots) - changes)


def recorded(python: Bench) -> list[tuple[int, int]]:
    """A list that grows by address and octet of whatever is written."""
    written: list[tuple[int, int]] = []
    write = python.nvm_write

    def note(address: int, octet: int) -> None:
        written.append((address, octet))
        write(address, octet)

    python.nvm_write = note  # type: ignore[method-assign]
    return written


def octets(image: list[str]) -> bytes:
    return b"".join(bytes.fromhex("".join(line.split(" ")[2:])) for line in image[:-1])


def patched(image: bytes, writes: list[tuple[int, int]]) -> bytes:
    result = bytearray(image)
    for address, octet in writes:
        result[address] = octet
    return bytes(result)
