"""An axis of a drive, for asyncio; its blocking twin in `axis` has the same methods."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from odsmith_cia.codes import ModeCode
from odsmith_cia.words import PdsState

from . import diagnosis
from .async_states import SETTLE, STATE_TIMEOUT, AsyncStates, moves
from .errors import MotionError, MotionTimeoutError

if TYPE_CHECKING:
    from .diagnosis import Seen
    from .scale import Length, Number, Speed

STUCK = 0.5
"""Seconds at rest after which a movement is suspected to have no chance."""

CYCLIC = (ModeCode.CYCLIC_SYNCHRONOUS_POSITION, ModeCode.CYCLIC_SYNCHRONOUS_VELOCITY)

MOTION_TIMEOUT = 60.0


class AsyncAxis(AsyncStates):
    """One axis. Its objects are attributes: `await axis.profile_velocity.write(51_200)`.

    Positions are in microsteps and velocities in pps unless a unit is named; every wait has a time-out, in seconds.

    Methods raise StateError where the state forbids them, StateTimeoutError where another is not reached in time,
    MotionError (or EmergencyError, with cause and remedy) where a movement ends otherwise than it should,
    MotionTimeoutError where it takes too long; and whatever access raises: SdoAborted, NoAnswerError, RefusedError.
    """

    # ---- moving ------------------------------------------------------------------------------------------------------

    async def home(self, method: int | None = None, *, wait: bool = True, timeout: float = MOTION_TIMEOUT) -> None:
        """Find the home position, by a method (else by the one that is set)."""
        await self.set_mode(ModeCode.HOMING)
        if method is not None:
            await self._write("homing_method", int(method))
        info = self._facts.homing_methods.get(int(await self._read("homing_method")))
        if info is None or info.needs_power:
            await self.require_enabled()
        start = self._bit("HOMING_OPERATION_START")
        word = await self._word() & ~self._bit("HALT")
        await self._send_word(word & ~start)
        await self._send_word(word | start)
        await self._core.link.pause(SETTLE)
        if wait:
            await self.wait(timeout)

    async def move_to(
        self,
        position: Number,
        *,
        unit: Length = "microsteps",
        wait: bool = True,
        timeout: float = MOTION_TIMEOUT,
    ) -> None:
        """Move to a position on the ramp of the drive, replacing a move that is still running."""
        await self._set_point(position, unit, 0, wait, timeout)

    async def move_by(
        self,
        distance: Number,
        *,
        unit: Length = "microsteps",
        wait: bool = True,
        timeout: float = MOTION_TIMEOUT,
    ) -> None:
        """Move by a distance from where 60F2h says: as delivered, from the target before."""
        await self._set_point(distance, unit, 1, wait, timeout)

    async def run(
        self, velocity: Number, *, unit: Speed = "pps", wait: bool = True, timeout: float = MOTION_TIMEOUT
    ) -> None:
        """Turn at a velocity until told otherwise; `wait` waits until it is reached."""
        await self.require_enabled()
        entry = self._facts.entry("target_velocity", self._axis)
        chosen = await self._core.access.unit(entry)
        pps = Fraction(velocity) if unit == "pps" else (await self.scale()).pps(velocity, unit)
        count = chosen.from_base(pps) if chosen else round(pps)
        entry.check(count)
        if await self.mode() != ModeCode.PROFILE_VELOCITY:
            await self._put({"target_velocity": 0})  # an old one would act as soon as the mode is chosen
            await self.set_mode(ModeCode.PROFILE_VELOCITY)
        await self._put({"target_velocity": count})
        await self.resume()
        await self._core.link.pause(SETTLE)
        if wait:
            await self.wait(timeout)

    async def wait(self, timeout: float = MOTION_TIMEOUT) -> None:
        """Wait until the movement that was started has ended well; in profile velocity, until the speed is reached."""
        link = self._core.link
        until, moved = link.now() + timeout, link.now()
        mode = await self.mode()
        while True:
            seen = await self.status()
            if self._is_done(seen):
                break
            if seen.state in diagnosis.FAULTY:
                raise await self._fault(seen)
            if seen.state != PdsState.OPERATION_ENABLED and self._needs_power(mode):
                raise await self._state_error(seen, PdsState.OPERATION_ENABLED)
            moved = link.now() if moves(seen) else moved
            if link.now() - moved > STUCK and (why := await self._why_stuck(seen)):
                raise MotionError(self.number, f"axis {self.number} does not move: {why}", await self._portrait(seen))
            if link.now() >= until:
                what = f"axis {self.number} did not end its movement within {timeout:g} s"
                raise MotionTimeoutError(self.number, what, await self._portrait(seen))
            await self._next_look()
        await self._judge(seen)

    async def halt(self, timeout: float = STATE_TIMEOUT) -> None:
        """Slow down to rest by the halt bit; the movement goes on with `resume`, the next one takes the bit back too.

        Homing knows no halt: there it is ended as by `stop`, and `home` begins it anew.
        """
        if await self.mode() == ModeCode.HOMING:
            await self.stop(timeout)
            return
        await self._send_word(await self._word() | self._bit("HALT"))
        await self._core.link.pause(SETTLE)
        await self._reach(lambda seen: not moves(seen), diagnosis.STANDSTILL, timeout)

    async def resume(self) -> None:
        """Take the halt back; nothing happens where there is none."""
        word = await self._word()
        if word & self._bit("HALT"):
            await self._send_word(word & ~self._bit("HALT"))

    async def stop(self, timeout: float = STATE_TIMEOUT) -> None:
        """Slow down to rest and forget the movement; the axis stays powered, in its mode."""
        mode = await self.mode()
        if mode == ModeCode.PROFILE_VELOCITY:
            await self._put({"target_velocity": 0})
        elif mode == ModeCode.HOMING:
            await self._send_word(await self._word() & ~self._bit("HOMING_OPERATION_START"))
        else:
            await self.halt(timeout)
            await self.set_mode(ModeCode.NO_MODE, timeout)  # which forgets the set-point
            await self.set_mode(mode, timeout)
            await self.resume()
        await self._core.link.pause(SETTLE)
        await self._reach(lambda seen: not moves(seen), diagnosis.STANDSTILL, timeout)

    # ---- steps of a movement -----------------------------------------------------------------------------------------

    async def _set_point(self, way: Number, unit: Length, relative: int, wait: bool, timeout: float) -> None:
        """A set-point of profile position: written, acknowledged, taken back (CiA 402, handshake of bits 4 and 12)."""
        await self.require_enabled()
        microsteps = round(Fraction(way)) if unit == "microsteps" else (await self.scale()).microsteps(way, unit)
        self._facts.entry("target_position", self._axis).check(microsteps)
        await self.set_mode(ModeCode.PROFILE_POSITION)
        new = self._bit("NEW_SET_POINT")
        before = await self._word() & ~new & ~self._bit("RELATIVE")
        before |= self._bit("RELATIVE") if relative else 0
        word = before & ~self._bit("HALT")
        # A halt stays until the edge of the new set-point, or the move that was halted would go on up to there.
        await self._put({"target_position": microsteps, "controlword": before})
        await self._acknowledged(False)
        await self._send_word(word | new)
        await self._acknowledged(True)
        await self._send_word(word)
        if wait:
            await self.wait(timeout)

    async def _acknowledged(self, wanted: bool) -> None:
        seen = await self._reach(
            lambda seen: ("set_point_acknowledge" in seen.flags) is wanted or seen.state != PdsState.OPERATION_ENABLED,
            diagnosis.ACKNOWLEDGE,
            STATE_TIMEOUT,
        )
        if seen.state in diagnosis.FAULTY:
            raise await self._fault(seen)

    def _is_done(self, seen: Seen) -> bool:
        if self._mode in CYCLIC:
            return not moves(seen)
        return "target_reached" in seen.flags and (
            seen.state == PdsState.OPERATION_ENABLED or not self._needs_power(self._mode)
        )

    def _needs_power(self, mode: int) -> bool:
        return mode != ModeCode.HOMING

    async def _judge(self, seen: Seen) -> None:
        """The movement is over: was it what it should be?"""
        if self._mode == ModeCode.HOMING:
            await self._send_word(await self._word() & ~self._bit("HOMING_OPERATION_START"))
            if "home_attained" not in seen.flags:
                what = f"axis {self.number} found no home position: a limit switch or a stop ended the homing"
                raise MotionError(self.number, what, await self._portrait(seen))
        elif self._mode == ModeCode.PROFILE_POSITION and "internal_limit_active" in seen.flags:
            what = f"axis {self.number} went as far as a limit lets it, not to its target"
            raise MotionError(self.number, what, await self._portrait(seen))

    async def _fault(self, seen: Seen) -> MotionError:
        """What made the axis faulty; its emergency may still be on the way."""
        link = self._core.link
        await link.pause(SETTLE)
        portrait = await self._portrait(seen)
        return diagnosis.last_fault(self._facts, self.number, link.recent_emergencies, portrait) or MotionError(
            self.number, f"axis {self.number} is in {seen.state}, by {diagnosis.NO_EMERGENCY}", portrait
        )

    async def _why_stuck(self, seen: Seen) -> str:
        """What keeps an axis at rest that should move; empty if nothing is found."""
        if "internal_limit_active" in seen.flags:
            return "bit 11 of the statusword (internal limit active): a limit switch or a software limit holds it back"
        if await self._word() & self._bit("HALT") and self._mode != ModeCode.HOMING:
            return "the halt bit is set; resume() takes it back"
        for role in _MOVED_BY.get(self._mode, ()):
            entry = self._facts.find(role, self._axis)
            if entry is not None and not await self._core.access.read(entry):
                return f"{entry.label} is 0"
        return ""

    async def _portrait(self, seen: Seen) -> str:
        """All that was last seen, for an error."""
        info = self._facts.modes.get(self._mode)
        parts = [str(seen), f"mode {info.name if info else self._mode}"]
        for role in ("target_position", "position_actual_value", "velocity_actual_value"):
            entry = self._facts.find(role, self._axis)
            if entry is not None:
                parts.append(f"{entry.name} {await self._core.access.read(entry)}")
        frames = self._core.link.emergencies
        parts.append(
            f"last emergency: {diagnosis.emergency(self._facts, frames[-1]).title}" if frames else "no emergency"
        )
        return "; ".join(parts)


_MOVED_BY: dict[int, tuple[str, ...]] = {
    ModeCode.PROFILE_POSITION: ("profile_velocity", "profile_acceleration"),
    ModeCode.PROFILE_VELOCITY: ("profile_acceleration",),
    ModeCode.HOMING: ("homing_speeds_fast", "homing_speeds_slow", "homing_acceleration"),
}
"""Without which an axis does not start, by mode; all of them may be 0 after a reset."""
