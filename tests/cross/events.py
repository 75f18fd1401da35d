"""Lines for testees, drawn by hypothesis: likely ones, and ones that nobody would send."""

from __future__ import annotations

from hypothesis import strategies as st

from odsmith.canopen_types import PdoDirection
from odsmith.model import Device

Lines = st.SearchStrategy[str]

SIGNATURES = (0x65766173, 0x64616F6C, 0x656B616D, 0x6C6C696B)
"""save, load, make, kill"""


def _rx(can_id: int, data: bytes) -> str:
    return " ".join([f"RX {can_id:03X}", *(f"{octet:02X}" for octet in data)])


def _addresses(device: Device) -> st.SearchStrategy[tuple[int, int]]:
    """Mostly entries that are there; the communication profile more often than its share."""
    entries = [(item.index, item.entry.sub) for obj in device.expanded for item in obj.entries]
    communication = [address for address in entries if 0x1000 <= address[0] < 0x2000]
    anywhere = st.tuples(st.integers(0, 0xFFFF), st.integers(0, 255))
    return st.one_of(st.sampled_from(communication), st.sampled_from(entries), anywhere)


def _mappings(device: Device) -> st.SearchStrategy[int]:
    """PDO mapping entries that may be in order."""
    mappable = [
        item.index << 16 | item.entry.sub << 8 | item.entry.bit_length
        for obj in device.expanded
        for item in obj.entries
        if item.entry.mapping is not PdoDirection.NO
    ]
    return st.sampled_from(mappable or [0])


def _values(device: Device) -> st.SearchStrategy[int]:
    can_ids = st.sampled_from([0x80, 0x181, 0x185, 0x201, 0x205, 0x301, 0x401, 0x581])
    cob_ids = st.builds(lambda can_id, bits: can_id | bits << 30, can_ids, st.integers(0, 3))
    watched = st.builds(lambda node_id, time: node_id << 16 | time, st.integers(0, 130), st.integers(0, 20))
    small = st.integers(0, 12)
    return st.one_of(
        small, small, cob_ids, watched, _mappings(device), st.sampled_from(SIGNATURES), st.integers(0, 0xFFFFFFFF)
    )


def _sdo(device: Device, node_id: int) -> Lines:
    def initiate(command: int, address: tuple[int, int], value: int) -> str:
        index, sub = address
        data = bytes([command]) + index.to_bytes(2, "little") + bytes([sub]) + value.to_bytes(4, "little")
        return _rx(0x600 + node_id, data)

    usual = st.sampled_from([0x40, 0x40, 0x23, 0x2B, 0x2F, 0x22, 0x21, 0x20])
    initiates = st.builds(initiate, st.one_of(usual, st.integers(0, 255)), _addresses(device), _values(device))
    segment_commands = st.sampled_from([0x60, 0x70, 0x00, 0x10, 0x01, 0x11, 0x80, 0x0F, 0x1F])
    segments = st.builds(
        lambda command, octets: _rx(0x600 + node_id, bytes([command]) + octets),
        segment_commands,
        st.binary(min_size=7, max_size=7),
    )
    return st.one_of(initiates, initiates, segments)


def _frames(node_id: int) -> Lines:
    nmt = st.builds(
        lambda command, to: _rx(0, bytes([command, to])),
        st.sampled_from([1, 2, 128, 129, 130, 3]),
        st.sampled_from([0, node_id, node_id + 1]),
    )
    rpdo_ids = st.sampled_from([0x200 + node_id, 0x300 + node_id, 0x400 + node_id, 0x500 + node_id, 0x201, 0x205])
    rpdos = st.builds(_rx, rpdo_ids, st.binary(max_size=8))
    syncs = st.builds(_rx, st.just(0x80), st.sampled_from([b"", b"\x01"]))
    heartbeats = st.builds(
        lambda other, state: _rx(0x700 + other, bytes([state])), st.integers(1, 127), st.sampled_from([0, 4, 5, 127])
    )
    guarding = st.just(f"RX {0x700 + node_id:03X} R")
    anything = st.builds(_rx, st.integers(0, 0x7FF), st.binary(max_size=8))
    return st.one_of(nmt, rpdos, rpdos, syncs, heartbeats, guarding, anything)


def _bench(device: Device) -> Lines:
    """What happens to a device beside frames."""
    inputs = st.builds(
        "IN {} {}".format,
        st.sampled_from(["digital", "analog0", "analog3", "address", "enable"]),
        st.sampled_from([0, 0, 1, 5, 255]),
    )
    can = st.sampled_from(["ok", "ok", "warning", "passive", "busoff", "error", "overrun", "rxfull", "txfull"])
    memory = st.sampled_from(["NVM ok", "NVM ok", "NVM fail", "OS none", "OS 1 01 02", "OS 2"])
    cuts = st.builds("POWER cut {}".format, st.integers(1, 3000))
    powers = st.sampled_from(["POWER on", "POWER cut"])
    choices = [inputs, st.builds("CAN {}".format, can), memory, cuts, powers]
    if device.axes:
        conditions = [condition.name for condition in device.conditions.values() if condition.scope == "axis"]
        choices.append(
            st.builds(
                "FAULT axis{} {} {}".format,
                st.integers(0, device.axes - 1),
                st.sampled_from(conditions),
                st.sampled_from(["on", "off"]),
            )
        )
    return st.one_of(choices)


def _time() -> Lines:
    steps = st.one_of(
        st.sampled_from([1, 100, 500, 999, 1000, 1001, 5000, 100_000, 1_000_000]),
        st.integers(0, 20_000),
        st.integers(0, 1 << 23),
    )
    return st.builds("T {}".format, steps)


def dialogues(device: Device, node_id: int) -> st.SearchStrategy[list[str]]:
    """Lines from power-on to a dump of everything."""
    line = st.one_of(_sdo(device, node_id), _sdo(device, node_id), _frames(node_id), _time(), _bench(device))
    return st.lists(line, min_size=5, max_size=40).map(lambda lines: ["POWER on", *lines, "DUMP 0000-FFFF", "NVM"])
