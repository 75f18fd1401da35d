"""The states of an axis, for asyncio: how it is, and its way through the state machine of CiA 402.

States have the words of the vocabulary. Every wait has a time-out, in seconds.
"""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from odsmith_cia.codes import ModeCode
from odsmith_cia.words import PdsCommand, PdsState

from ..names import AsyncLive, Names
from . import diagnosis
from .errors import ClientError
from .scale import Scale

if TYPE_CHECKING:
    from collections.abc import Callable

    from .core import Core
    from .diagnosis import Seen
    from .errors import StateError
    from .scale import Length, Speed

POLL = 0.005
"""Seconds between two looks at a statusword, unless a PDO brings one earlier."""

SETTLE = 0.005
"""Seconds after which a statusword surely knows of what was written before."""

STATE_TIMEOUT = 5.0


class AsyncStates(Names[AsyncLive]):
    """What an axis can do without moving. Its objects are attributes: `await axis.profile_velocity.write(51_200)`.

    Time-outs are in seconds. Methods raise StateError where a state is not reached, and whatever access raises.
    """

    def __init__(self, core: Core, axis: int) -> None:
        super().__init__(core.facts.dictionary, axis, behind=core.value)
        self._core = core
        self._facts = core.facts
        self._mode: int = ModeCode.NO_MODE

    def __repr__(self) -> str:
        return f"<axis {self.number} of node {self._core.link.id}>"

    @property
    def number(self) -> int:
        """Which axis it is, from 0."""
        return self._axis or 0

    # ---- how it is ---------------------------------------------------------------------------------------------------

    async def status(self) -> Seen:
        """State, statusword and the names of its bits that are set in the present mode."""
        return diagnosis.see(self._facts, int(await self._get("statusword")), self._mode)

    async def state(self) -> str:
        """The state of CiA 402: `operation_enabled`, `fault` and so on."""
        return (await self.status()).state

    async def mode(self) -> int:
        """The code of the mode of operation in force."""
        self._mode = int(await self._read("modes_of_operation_display"))
        return self._mode

    async def position(self) -> int:
        """The actual position in microsteps."""
        return int(await self._get("position_actual_value"))

    async def position_in(self, unit: Length) -> Fraction:
        """The actual position in another unit, exactly."""
        return (await self.scale()).length(await self.position(), unit)

    async def velocity(self) -> int:
        """The actual velocity as 606Ch has it: in pps unless 208Ch says otherwise."""
        return int(await self._get("velocity_actual_value"))

    async def velocity_in(self, unit: Speed) -> Fraction:
        """The actual velocity in another unit, exactly."""
        entry = self._facts.entry("velocity_actual_value", self._axis)
        chosen = await self._core.access.unit(entry)
        count = await self.velocity()
        return (await self.scale()).speed(chosen.to_base(count) if chosen else Fraction(count), unit)

    async def scale(self) -> Scale:
        """How far a microstep is, by microstep and full step resolution."""
        power = int(await self._read("microstep_resolution"))
        return Scale(1 << power, int(await self._read("fullstep_resolution")))

    # ---- the state machine -------------------------------------------------------------------------------------------

    async def enable(self, timeout: float = STATE_TIMEOUT) -> None:
        """Power the motor: go to operation enabled. A fault has to be reset before."""
        await self._travel(PdsState.OPERATION_ENABLED, timeout)

    async def disable(self, timeout: float = STATE_TIMEOUT) -> None:
        """Slow down, apply the brake and take the power away: go to switch on disabled."""
        if await self.state() == PdsState.OPERATION_ENABLED:
            await self._travel(PdsState.SWITCHED_ON, timeout)
        await self._travel(PdsState.SWITCH_ON_DISABLED, timeout)

    async def quick_stop(self, timeout: float = STATE_TIMEOUT) -> None:
        """Stop as 605Ah says, and wait for standstill; with codes 1 and 2 the axis is then switched off."""
        await self.require_enabled()
        await self._command(PdsCommand.QUICK_STOP)
        await self._core.link.pause(SETTLE)
        await self._reach(lambda seen: not moves(seen), diagnosis.STANDSTILL, timeout)

    async def reset_fault(self, timeout: float = STATE_TIMEOUT) -> None:
        """Leave the state fault; nothing happens in other states."""
        await self._reach(
            lambda seen: seen.state != PdsState.FAULT_REACTION_ACTIVE, PdsState.SWITCH_ON_DISABLED, timeout
        )
        if await self.state() != PdsState.FAULT:
            return
        await self._send_word(0)  # the command acts on an edge only
        await self._command(PdsCommand.FAULT_RESET)
        await self._reach(lambda seen: seen.state != PdsState.FAULT, PdsState.SWITCH_ON_DISABLED, timeout)
        await self._send_word(0)

    async def set_mode(self, mode: int | str, timeout: float = STATE_TIMEOUT) -> None:
        """Choose a mode of operation by its code, name or short name (pp), and wait until it is in force."""
        code = self._mode_code(mode)
        if await self.mode() == code:
            return
        await self._write("modes_of_operation", code)
        until = self._core.link.now() + timeout
        while await self.mode() != code:
            if self._core.link.now() >= until:
                raise await self._state_error(await self.status(), diagnosis.MODE, timeout)
            await self._core.link.pause(POLL)

    # ---- states ------------------------------------------------------------------------------------------------------

    async def _travel(self, wanted: str, timeout: float) -> None:
        """Go to a state, by commands where there are and by waiting where it comes of itself."""
        link, machine = self._core.link, self._facts.state_machine
        began = link.now()
        while (seen := await self.status()).state != wanted:
            route = machine.route(seen.state, wanted) if machine else None
            if not route or seen.state == PdsState.FAULT:
                raise await self._state_error(seen, wanted)
            commands = [name for name in route[0].by if machine and name in machine.commands]
            if commands:
                await self._command(commands[0])
            before = seen.state
            await self._reach(lambda seen: seen.state != before, wanted, timeout, began)  # noqa: B023

    async def require_enabled(self) -> None:
        """Raise StateError unless the axis is in operation."""
        seen = await self.status()
        if seen.state != PdsState.OPERATION_ENABLED:
            raise await self._state_error(seen, PdsState.OPERATION_ENABLED)

    async def _reach(
        self, holds: Callable[[Seen], bool], wanted: str, timeout: float, began: float | None = None
    ) -> Seen:
        """Look at the statusword until something holds, at most so long since it began. Raises StateTimeoutError."""
        link = self._core.link
        until = (link.now() if began is None else began) + timeout
        while not holds(seen := await self.status()):
            if link.now() >= until:
                raise await self._state_error(seen, wanted, timeout)
            await self._next_look()
        return seen

    async def _state_error(self, seen: Seen, wanted: str, timeout: float | None = None) -> StateError:
        """Why the axis is not as it should be; what the axis was told is asked for, if it answers."""
        told: dict[str, int] = {}
        with suppress(ClientError):
            for role in diagnosis.TOLD:
                entry = self._facts.find(role, self._axis)
                if entry is not None:
                    told[role] = int(await self._core.last_put(entry))
        return diagnosis.state_error(
            self._facts, self.number, seen, wanted, self._core.link.recent_emergencies, told, timeout
        )

    async def _next_look(self) -> None:
        """Wait until it is worth looking at the statusword again."""
        link = self._core.link
        if self._core.exchange.enabled:
            await link.next_frame(link.now() + POLL)
        else:
            await link.pause(POLL)

    async def _command(self, name: str) -> None:
        """Give a command of the state machine; it takes all bits of the mode back."""
        machine = self._facts.state_machine
        assert machine is not None
        await self._send_word(machine.commands[name].apply(0))

    async def _word(self) -> int:
        """The controlword that was written last."""
        return int(await self._core.last_put(self._facts.entry("controlword", self._axis)))

    async def _send_word(self, word: int) -> None:
        await self._put({"controlword": word})

    def _bit(self, name: str) -> int:
        """A bit of the controlword in the present mode; 0 where the mode has none of that name."""
        info = self._facts.modes.get(self._mode)
        member = info.controlword.__members__.get(name) if info and info.controlword else None
        return member.value if member is not None else 0

    def _mode_code(self, mode: int | str) -> int:
        if not isinstance(mode, str):
            return int(mode)
        for code, info in self._facts.modes.items():
            if mode.lower() in (info.name, info.short):
                return code
        names = ", ".join(f"{info.name} ({info.short})" for info in self._facts.modes.values())
        raise ValueError(f"{mode!r} is no mode of operation: {names}")

    # ---- values by their roles, by PDO where one carries them --------------------------------------------------------

    async def _read(self, role: str) -> Any:
        return await self._core.access.read(self._facts.entry(role, self._axis))

    async def _write(self, role: str, value: Any) -> None:
        await self._put({role: value})

    async def _get(self, role: str) -> Any:
        return await self._core.get(self._facts.entry(role, self._axis))

    async def _put(self, values: dict[str, Any]) -> None:
        await self._core.put({self._facts.entry(role, self._axis): value for role, value in values.items()})


def moves(seen: Seen) -> bool:
    """Whether the motor turns."""
    return "motor_activity" in seen.flags
