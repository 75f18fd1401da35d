"""A master that we did not write, python-canopen with our EDS, works with the device as a C and as a Python program."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import canopen
import pytest
from canopen.objectdictionary import ODVariable
from tests.cross.driver import Testee
from tests.cross.expected import entries, power_on_value, role
from tests.cross.master import MasterNetwork

from odsmith.backends.eds import EdsBackend
from odsmith.model import Device, ExpandedEntry

pytestmark = pytest.mark.slow

NODE_ID = 5

COMMANDS = {"store", "restore", "tmcl_mode", "manufacturer_mode", "os_command"}
"""Effects of entries that do not take what they give."""

ONLY_WHILE_OFF = {"pdo_mapped_count", "pdo_mapping"}


@functools.cache
def _eds(device: str, content: bytes, folder: Path) -> canopen.ObjectDictionary:
    path = folder / f"{device}.eds"
    path.write_bytes(content)
    return canopen.import_od(str(path), NODE_ID)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("master")


@pytest.fixture(params=["tmcm3230", "tmcm6212"])
def device(request: pytest.FixtureRequest) -> Device:
    device: Device = request.getfixturevalue(request.param)
    return device


@pytest.fixture(params=["c", "python"])
def testee_program(request: pytest.FixtureRequest) -> Callable[[Device], Path]:
    program: Callable[[Device], Path] = request.getfixturevalue(f"{request.param}_testee")
    return program


@pytest.fixture
def network(device: Device, start: Callable[..., Testee], folder: Path) -> MasterNetwork:
    """A network with the device, which has just said that it is there."""
    (eds,) = EdsBackend().render(device)
    network = MasterNetwork(start(device, node_id=NODE_ID))
    network.add_node(NODE_ID, _eds(device.identifier, eds.content, folder))
    network.power_on()
    return network


@pytest.fixture
def node(network: MasterNetwork) -> Any:
    """The master's view of it."""
    return network[NODE_ID]


def variable(node: Any, item: ExpandedEntry) -> Any:
    """The entry as the library offers it."""
    found = node.sdo[item.index]
    return found if isinstance(found.od, ODVariable) else found[item.entry.sub]


def test_boot_up(node: Any) -> None:
    assert node.nmt.state == "PRE-OPERATIONAL"


def test_scanner_finds_the_node(network: MasterNetwork) -> None:
    network.scanner.nodes.clear()
    network.scanner.search()
    assert network.scanner.nodes == [NODE_ID]


def test_every_entry_is_in_the_eds_and_reads_as_modelled(device: Device, node: Any) -> None:
    own = {"node_id", "statusword", "can_bit_rate_load", "node_id_load"}
    numbers = 0
    for item in entries(device):
        found = variable(node, item)
        assert found.readable
        assert found.data == power_on_value(item, NODE_ID), (hex(item.index), item.entry.sub)
        if item.entry.type.integer and item.eds_default and item.entry.role not in own:
            assert found.raw == found.od.default == item.eds_default.value(NODE_ID)
            numbers += 1
    assert numbers > 300
    assert sum(1 if isinstance(obj, ODVariable) else len(obj) for obj in node.object_dictionary.values()) == len(
        list(entries(device))
    )


def test_strings(device: Device, node: Any) -> None:
    assert node.sdo[0x1008].raw == device.identity.name
    assert node.sdo["Manufacturer Device Name"].raw == device.identity.name
    with node.sdo.open(0x1008, mode="r") as stream:
        assert stream.read() == device.identity.name


def test_what_is_read_can_be_written_back(device: Device, network: MasterNetwork, node: Any) -> None:
    before = network.testee.dump()
    for item in entries(device):
        found = variable(node, item)
        if not item.entry.access.writable:
            assert not found.writable
            with pytest.raises(canopen.SdoAbortedError) as refused:
                found.data = found.data
            assert refused.value.code == 0x06010002
        elif item.entry.effect not in COMMANDS | ONLY_WHILE_OFF:
            found.raw = found.raw
            node.sdo.download(item.index, item.entry.sub, found.data, force_segment=True)
    assert network.testee.dump() == before


def test_block_transfer_is_refused(node: Any) -> None:
    with pytest.raises(canopen.SdoAbortedError) as refused:
        node.sdo.open(0x1008, block_transfer=True)
    assert refused.value.code == 0x05040001
    with pytest.raises(canopen.SdoAbortedError) as refused:
        node.sdo.open(0x1017, mode="wb", block_transfer=True, size=2)
    assert refused.value.code == 0x05040001


# ---- network management ------------------------------------------------------------------------------------------


def test_nmt_commands_and_heartbeats(network: MasterNetwork, node: Any) -> None:
    node.sdo[0x1017].raw = 100
    for state in ("OPERATIONAL", "STOPPED", "PRE-OPERATIONAL", "OPERATIONAL"):
        node.nmt.state = state
        assert node.nmt.wait_for_heartbeat(timeout=0.1) == state
    boot_ups: list[int] = []
    node.nmt.add_heartbeat_callback(boot_ups.append)
    node.nmt.state = "RESET COMMUNICATION"
    assert boot_ups == [0]
    assert node.nmt.state == "PRE-OPERATIONAL"
    network.nmt.state = "OPERATIONAL"  # broadcast
    network.nmt.state = "RESET"
    assert boot_ups == [0, 0]
    assert node.sdo[0x1017].raw == 0
    with pytest.raises(canopen.nmt.NmtError):
        node.nmt.wait_for_heartbeat(timeout=60)


def test_stopped_node_gives_no_sdo_answer(node: Any) -> None:
    node.nmt.state = "STOPPED"
    with pytest.raises(canopen.SdoCommunicationError):
        node.sdo[0x1000].raw  # noqa: B018  (reading is the point)
    node.nmt.state = "PRE-OPERATIONAL"
    assert node.sdo[0x1000].raw == node.object_dictionary[0x1000].default


def test_node_guarding(network: MasterNetwork, node: Any) -> None:
    for state in ("OPERATIONAL", "STOPPED", "PRE-OPERATIONAL"):
        node.nmt.state = state
        node.nmt._state = 0  # forget
        network.send_message(0x700 + NODE_ID, b"", remote=True)
        assert node.nmt.state == state


# ---- PDOs ------------------------------------------------------------------------------------------------------------


def test_pdos_are_as_modelled(device: Device, network: MasterNetwork, node: Any) -> None:
    node.pdo.read()
    for maps, modelled in ((node.rpdo, device.pdos_of("rpdo")), (node.tpdo, device.pdos_of("tpdo"))):
        assert len(maps) == len(modelled) * device.axes
        for number, pdo in maps.items():
            axis, ordinal = divmod(number - 1, 0x40)
            expected = modelled[ordinal]
            cob_id = (expected.other_axes_cob_id if axis else expected.cob_id).value(NODE_ID)
            assert isinstance(cob_id, int)
            assert (pdo.cob_id, pdo.enabled, pdo.rtr_allowed) == (
                cob_id & 0x1FFFFFFF,
                not cob_id >> 31,
                not cob_id >> 30 & 1,
            )
            assert pdo.trans_type == expected.transmission_type
            assert [(item.index, item.subindex, item.length) for item in pdo.map] == [
                (item.object.index + axis * item.object.stride, item.entry.sub, item.entry.bit_length)
                for item in expected.map
            ]
    before = network.testee.dump()
    node.pdo.save()
    assert network.testee.dump() == before


def test_load_configuration(network: MasterNetwork, node: Any) -> None:
    """The PDO settings that the EDS tells are accepted as they stand there."""
    before = network.testee.dump()
    node.load_configuration()
    assert network.testee.dump() == before


def test_new_mappings(device: Device, network: MasterNetwork, node: Any) -> None:
    """PDOs of the last axis: one sets its target and mode, the other shows its status beside the inputs."""
    stride = (device.axes - 1) * 0x800
    number = (device.axes - 1) * 0x40 + 1
    target, mode, status, (inputs, _) = (
        0x607A + stride,
        0x6060 + stride,
        0x6041 + stride,
        role(device, "general_inputs"),
    )
    node.pdo.read()
    receive, transmit = node.rpdo[number], node.tpdo[number]
    for pdo, mapped, cob_id in ((receive, (target, mode), 0x205), (transmit, (inputs, status), 0x185)):
        pdo.clear()
        for index in mapped:
            pdo.add_variable(index)
        pdo.cob_id, pdo.enabled, pdo.trans_type = cob_id, True, 255
    for pdo in (*node.rpdo.values(), *node.tpdo.values()):
        if pdo not in (receive, transmit):
            pdo.enabled = False
        pdo.save()
    node.nmt.state = "OPERATIONAL"
    assert (transmit[inputs].raw, transmit[status].raw) == (0, 0x0250)
    network.do("IN digital 5")
    assert transmit.wait_for_reception(timeout=0.01) == 0.001
    assert transmit[inputs].raw == 5 << 16
    receive[target].raw = -123456
    receive[mode].raw = 6
    receive.transmit()
    assert node.sdo[target].raw == -123456
    assert node.sdo[mode].raw == 6


def test_synchronous_pdos(network: MasterNetwork, node: Any) -> None:
    node.tpdo.read()
    pdo = node.tpdo[1]
    pdo.trans_type = 3
    pdo.save()
    received: list[float] = []
    pdo.add_callback(lambda one: received.append(one.timestamp or 0.0))
    node.nmt.state = "OPERATIONAL"
    counts = []
    for _ in range(7):
        network.sync.transmit()
        counts.append(len(received))
    assert counts == [0, 0, 1, 1, 1, 2, 2]


def test_event_timer(network: MasterNetwork, node: Any) -> None:
    node.tpdo.read()
    pdo = node.tpdo[1]
    pdo.event_timer = 250
    pdo.save()
    node.nmt.state = "OPERATIONAL"
    first = pdo.wait_for_reception(timeout=1)
    second = pdo.wait_for_reception(timeout=1)
    assert first
    assert second
    assert round((second - first) * 1000) == 250


# ---- emergencies, storing ----------------------------------------------------------------------------------------


def test_emergencies(network: MasterNetwork, node: Any) -> None:
    network.do("CAN error")
    network.do("CAN passive")
    assert [(error.code, error.register) for error in node.emcy.log] == [(0x8100, 0x11), (0x8120, 0x11)]
    assert [str(error) for error in node.emcy.active] == ["Code 0x8100, Monitoring", "Code 0x8120, Monitoring"]
    network.do("CAN ok")
    assert node.emcy.log[-1].code == 0
    assert node.emcy.active == []
    network.do("FAULT axis1 overtemperature on")
    error = node.emcy.wait(0x4310, timeout=0.1)
    assert error
    assert 1 in error.data


def test_store_and_restore(network: MasterNetwork, node: Any) -> None:
    kept, axis = node.sdo[0x1017], node.sdo[0x6083]
    kept.raw, axis.raw = 0, 1000
    node.store()
    axis.raw = 2000
    node.nmt.state = "RESET"
    assert axis.raw == 1000
    node.sdo[0x1017].raw = 500
    node.store(subindex=4)  # axis 0
    network.testee.cut()
    network.power_on()
    assert (kept.raw, axis.raw) == (0, 1000)
    node.restore()
    assert axis.raw == 1000
    node.nmt.state = "RESET"
    assert axis.raw == 0
