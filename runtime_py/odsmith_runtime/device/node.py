"""A CANopen node: one device on the bus; the twin of `ods_node.c`.

    node = Node(tmcm6212, port)
    node.power_on(now)
    node.receive(now, Frame(0x601, b"..."))
    node.advance(now)

Every method that takes the time is one turn: the node first works off what became due in the meantime, at the instants
at which it became due, then the event, then everything that follows from it. Time stands still in a turn. At one
instant things happen in this order:

    SDO time-out; consumer heartbeat and life guarding; the tick; the producers' timers
    frames: SDO, guarding or boot-up answer; EMCY; heartbeat; TPDOs ascending
    outputs

Time is in microseconds, 32 bits that wrap, and may not run back; `advance` has to be called at least every 2^30 us.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from odsmith_cia.codes import AbortCode
from odsmith_cia.words import Condition

from . import access, can_id, sync
from .axis import Axis
from .can import CanController
from .emcy import Emcy
from .heartbeat import Heartbeat
from .io import Io
from .led import Leds
from .nmt import Nmt
from .od import Cell, Instance, Od
from .os_command import OsCommand
from .pdo import Pdos
from .port import Can, Frame, Input, MotorAnswer, Port
from .sdo import Sdo
from .store import Store
from .timing import HORIZON_US, MASK, TICK_US, US_PER_MS, Timers, before
from .work import Work

if TYPE_CHECKING:
    from .tables import Tables


class Config(NamedTuple):
    """What a single device is told at the factory."""

    serial_number: int = 0  # 1018h:04
    node_id: int = 0  # default of the stored node-ID; 0: as the specification says


class Node:
    def __init__(self, tables: Tables, port: Port, config: Config | None = None) -> None:
        self.port = port
        self.config = config or Config()
        self.identity = tables.identity
        self.pds_states = tables.pds_states
        self.od = Od(tables.dictionary)
        self.values = self.od.device
        self.timers = Timers()
        self.work = Work(0)
        self.changed: set[Instance] = set()  # those with a changed value that a TPDO may carry
        self.services: tuple[str, ...] = ()
        self.id = 0  # the node-ID in force; 0 before power-on

        self.sdo = Sdo(self)
        self.os_command = OsCommand(self)
        self.heartbeat = Heartbeat(self)
        self.emcy = Emcy(self, tables.emergencies)
        self.can = CanController(self)
        self.leds = Leds(self, tables.leds)
        self.io = Io(self, tables.identity)
        self.nmt = Nmt(self, tables.nmt_states, tables.nmt_commands, tables.error_behaviour)
        self.store = Store(self, tables.layout, tables.storage_groups)
        self.pdo = Pdos(self, tables.dictionary.max_pdo_entries)
        self.axes = tuple(Axis(self, number, tables) for number in range(len(self.od.axes)))

    # ---- events ------------------------------------------------------------------------------------------------------

    def power_on(self, now: int) -> None:
        """Power comes up. Before it only `input`, `fault` and `motor` may be called."""
        self.timers.deadlines.clear()
        self.timers.now = now & MASK
        self.timers.tick_at = now + TICK_US & MASK
        self.changed.clear()
        self.nmt.power_on()
        self.can.state = Can.OK
        self.leds.power_on()
        for axis in self.axes:
            axis.motor.power_up()
        self.nmt.reset_node()
        self.work &= ~Work.OUTPUT
        self._finish()
        self.leds.put(all=True)
        self.io.put(all=True)
        for axis in self.axes:
            axis.motor.put()

    def receive(self, now: int, frame: Frame) -> None:
        """A frame was received."""
        self._catch_up(now)
        if not self.can.is_off:
            self._dispatch(frame)
        self._end_turn()

    def advance(self, now: int) -> None:
        """Time has passed."""
        self._catch_up(now)

    def input(self, now: int, input: Input, channel: int, value: int) -> None:
        """An input has a new value. `channel` counts from 0; it is 0 where there is only one."""
        if not self.id:
            self.io.set(input, channel, value)
            return
        self._catch_up(now)
        self.io.set(input, channel, value)
        if input is not Input.ADDRESS:
            self.timers.arm_tick()

    def fault(self, now: int, axis: int, condition: str, holds: bool) -> None:
        """The hardware of an axis reports that a condition holds or has ended. Acts at the next tick."""
        if condition == Condition.FAULT_RESET:  # which the node itself raises
            return
        if self.id:
            self._catch_up(now)
            self.timers.arm_tick()
        faults = self.axes[axis].faults
        if holds:
            faults.add(condition)
        else:
            faults.discard(condition)

    def motor(self, now: int, axis: int, answer: MotorAnswer) -> None:
        """The hardware of an axis has something new to say, outside of the port's `motor`. Acts at the next tick.

        What `fault` reported holds beside it.
        """
        if self.id:
            self._catch_up(now)
            self.timers.arm_tick()
        self.axes[axis].answer = answer
        self._end_turn()

    def report_can(self, now: int, event: Can) -> None:
        """The CAN controller changed its state, or something happened to it."""
        self._catch_up(now)
        self.can.report(event)
        self._end_turn()

    def next(self) -> int | None:
        """The next instant at which the node has something to do."""
        horizon = self.timers.now + HORIZON_US & MASK
        at = self._earliest(horizon)
        return None if at == horizon else at

    def read(self, index: int, sub: int) -> bytes | AbortCode:
        """Read an entry as an SDO upload would, without a bus."""
        cell = self.od.find(index, sub)
        if not isinstance(cell, Cell):
            return cell
        abort = access.readable(self, cell)
        return AbortCode(abort) if abort else cell.octets

    # ---- what the parts of a node ask of it --------------------------------------------------------------------------

    def send(self, frame: Frame) -> None:
        """Send a frame. In bus-off it is lost."""
        if not self.can.is_off:
            self.port.send(frame)

    def value_changed(self, instance: Instance) -> None:
        """A value that a TPDO may carry has changed."""
        self.changed.add(instance)
        self.work |= Work.TPDO

    def update_axes(self) -> None:
        for axis in self.axes:
            axis.update()

    # ---- the order of things -----------------------------------------------------------------------------------------

    def _dispatch(self, frame: Frame) -> None:
        if frame.id == can_id.SDO_REQUEST + self.id:
            if "sdo" in self.services and not frame.remote:
                self.sdo.receive(frame)
        elif frame.id == can_id.NMT:
            self.nmt.receive(frame)
        elif frame.id >= can_id.ERROR_CONTROL:
            self.heartbeat.receive(frame)
        elif not frame.remote:  # no PDO answers a remote frame
            if sync.is_sync(self, frame.id):
                self.pdo.sync()
            if "pdo" in self.services:
                self.pdo.receive(frame)

    def _catch_up(self, now: int) -> None:
        """Work off all instants up to `now`."""
        now &= MASK
        while True:
            # The grid of ticks must not fall behind, however little happens: _work_off() moves it on.
            at = self._earliest(self.timers.tick_at + HORIZON_US & MASK)
            if before(now, at):
                break
            self.timers.now = at
            self._work_off()
            self._finish()
        self.timers.now = now

    def _earliest(self, horizon: int) -> int:
        """The next instant at which something is due, or the horizon."""
        return self.pdo.earliest(self.timers.earliest(horizon))

    def _work_off(self) -> None:
        """Everything that is due at this instant."""
        timers = self.timers
        self.sdo.time_out()
        self.heartbeat.expire()
        if timers.is_due("tick"):
            self._tick()
        timers.next_tick()
        if timers.is_due("heartbeat"):
            timers.repeat("heartbeat", self.values.producer_heartbeat_time * US_PER_MS)
            self.work |= Work.HEARTBEAT
        if timers.is_due("emcy"):
            timers.stop("emcy")
            self.work |= Work.EMCY
        if self.leds.is_due():
            self.work |= Work.OUTPUT
        self.pdo.expire()

    def _tick(self) -> None:
        self.timers.stop("tick")
        self.io.tick()
        for axis in self.axes:
            axis.tick()
        for axis in self.axes:
            axis.drive()
        if any(axis.is_armed for axis in self.axes):
            self.timers.arm_tick()

    def _end_turn(self) -> None:
        if self.work:
            self._finish()

    def _finish(self) -> None:
        """The end of a turn: what has piled up leaves, each kind at its place."""
        if Work.EMCY in self.work:
            self.emcy.transmit()
        if Work.ERROR_BEHAVIOUR in self.work:
            self.nmt.follow_error()
        if Work.HEARTBEAT in self.work:
            self.heartbeat.transmit()
        if Work.TPDO in self.work:
            self.pdo.transmit()
        if Work.OUTPUT in self.work:
            self.leds.put(all=False)
            self.io.put(all=False)
            for axis in self.axes:
                axis.motor.put()
        self.work = Work(0)
