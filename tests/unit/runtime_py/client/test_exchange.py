"""What PDOs carry, without a device."""

from __future__ import annotations

from types import ModuleType

import canopen
import pytest

from odsmith_runtime import OutOfRangeError
from odsmith_runtime.client import Rpdo, Tpdo
from odsmith_runtime.client.exchange import Exchange, Image
from odsmith_runtime.client.link import Link
from odsmith_runtime.client.pdo_plan import place
from odsmith_runtime.client.waiting import BlockingWaiter, run


class Wire(canopen.Network):
    """Keeps what is sent."""

    def __init__(self) -> None:
        super().__init__()
        self.sent: list[str] = []

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        self.sent.append(f"{can_id:03X} {bytes(data).hex()}")


def test_an_image_packs_what_it_unpacks(package: ModuleType) -> None:
    axis = package.DICTIONARY.axes[1]
    (found,) = place([Tpdo(axis.statusword, axis.position_actual_value)], package.DICTIONARY, 1)
    image = Image(found)
    image.unpack(bytes.fromhex("3702feffffff"))
    assert image.values == {axis.statusword: 0x237, axis.position_actual_value: -2}
    assert image.pack().hex() == "3702feffffff"
    image.unpack(b"\0")
    assert image.received == 1


def test_values_of_several_rpdos_leave_together(package: ModuleType) -> None:
    axes = package.DICTIONARY.axes
    wire = Wire()
    exchange = Exchange(Link(wire, 1, BlockingWaiter()))
    plan = [Rpdo(axis.controlword, axis.target_position, on_sync=1) for axis in axes[:2]]
    exchange.configure(place(plan, package.DICTIONARY, 1))
    exchange.preset(axes[0].controlword, 15)
    exchange.put({axes[0].target_position: 1, axes[1].target_position: -1, axes[1].controlword: 7})
    assert wire.sent == ["201 0f0001000000", "680 0700ffffffff", "080 "]
    with pytest.raises(OutOfRangeError):
        exchange.put({axes[0].target_position: 1 << 31})
    assert len(wire.sent) == 3
    exchange.sync_is_produced = True
    exchange.put({axes[0].target_position: 2})
    assert wire.sent[3:] == ["201 0f0002000000"]


def test_nothing_was_received_yet(package: ModuleType) -> None:
    axis = package.DICTIONARY.axes[0]
    wire = Wire()
    exchange = Exchange(Link(wire, 1, BlockingWaiter()))
    assert run(exchange.get(axis.statusword, 0.0)) is None
    exchange.configure(place([Tpdo(axis.statusword)], package.DICTIONARY, 1))
    assert run(exchange.get(axis.statusword, 0.0)) is None
    wire.notify(0x181, bytearray(b"\x37\x02"), 0.0)
    assert run(exchange.get(axis.statusword, 0.0)) == 0x237
    exchange.configure(())
    assert run(exchange.get(axis.statusword, 0.0)) is None
