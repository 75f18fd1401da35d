"""What can go wrong between a program and a device, said so that the reader knows what to do next."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from ..abort_codes import AbortCodeInfo
    from ..emergencies import Emergency
    from ..entries import Entry


class ClientError(Exception):
    """Base of everything that the client raises on its own account."""


class MissingPackageError(ClientError, ImportError):
    """A package that the client stands on is not installed."""


class PlanError(ClientError, ValueError):
    """PDOs that the device cannot have; nothing was sent."""


class NoAnswerError(ClientError, TimeoutError):
    """The node did not answer, or did not come back, in time."""


class SdoAborted(ClientError):  # noqa: N818  # an event of the protocol, by its name there
    """The device refused an access.

    `entry` is what was accessed, `axis` its axis (None for the whole device), `value` what was to be written (None for
    a read), `code` the abort code, `info` its row in the table of the device (None for a code it does not know),
    `limit` the values that the entry takes.
    """

    def __init__(self, entry: Entry[Any], value: object, code: int, info: AbortCodeInfo | None) -> None:
        self.entry = entry
        self.axis = entry.axis
        self.value = value
        self.code = code
        self.info = info
        self.limit = entry.limits_text if value is not None and entry.allowed else ""
        access = "reading" if value is None else f"writing {value!r} to"
        why = f"{info.title[:1].lower()}{info.title[1:]}" if info else "an unknown reason"
        parts = [f"{access} {entry.label}: the device aborted with {code:08X}h, {why}"]
        if self.limit:
            parts.append(f"it takes {self.limit}")
        if entry.writable_in and value is not None:
            parts.append(f"it is writable in {' or '.join(entry.writable_in)} only")
        super().__init__("; ".join(parts))


class StateError(ClientError):
    """An axis is not in the state that something needs, and does not get there.

    `state` is where it is, `wanted` where it should be, `blocked_by` the bit or object in the way, `next_step` what
    leads on.
    """

    def __init__(self, axis: int, state: str, wanted: str, blocked_by: str, next_step: str) -> None:
        super().__init__(f"axis {axis} is in {state}, {self._lack(wanted)}: {blocked_by}. Next step: {next_step}")
        self.axis = axis
        self.state = state
        self.wanted = wanted
        self.blocked_by = blocked_by
        self.next_step = next_step

    def _lack(self, wanted: str) -> str:
        return f"not in {wanted}"


class StateTimeoutError(StateError, TimeoutError):
    """What an axis should do by itself takes longer than the time it was given; it may still come.

    `wanted` is a state, or what else was waited for: standstill, the mode of operation, the set-point acknowledge.
    `timeout` are the seconds that it was given, `seen` is what was last seen of the axis.
    """

    def __init__(
        self,
        axis: int,
        state: str,
        wanted: str,
        blocked_by: str,
        next_step: str,
        *,
        is_state: bool,
        timeout: float,
        seen: str,
    ) -> None:
        self._preposition = "not in" if is_state else "without"
        self.timeout = timeout
        self.seen = seen
        super().__init__(axis, state, wanted, blocked_by, f"{next_step} ({seen})")
        self.next_step = next_step

    def _lack(self, wanted: str) -> str:
        return f"{self._preposition} {wanted} after {self.timeout:g} s"


class MotionError(ClientError):
    """A movement does not end as it should. `axis` is the axis, `seen` what was last seen of it."""

    def __init__(self, axis: int | None, what: str, seen: str) -> None:
        super().__init__(f"{what} ({seen})" if seen else what)
        self.axis = axis
        self.seen = seen


class MotionTimeoutError(MotionError, TimeoutError):
    """A movement takes longer than the time it was given; it may still go on."""


class EmergencyError(MotionError):
    """An emergency of the device ended a movement.

    `emergency` is its row in the table of the device, with `title`, `cause` and `remedy`; None for a code that the
    device does not document. `code` and `register` are those of the frame.
    """

    def __init__(self, axis: int | None, emergency: Emergency | None, code: int, register: int, seen: str = "") -> None:
        self.emergency = emergency
        self.code = code
        self.register = register
        self.title = emergency.title if emergency else "unknown emergency"
        self.cause = emergency.cause if emergency else ""
        self.remedy = emergency.remedy if emergency else ""
        where = "the device" if axis is None else f"axis {axis}"
        what = f"{where} reports {self.title} (emergency {code:04X}h)"
        super().__init__(axis, f"{what}: {self.cause} {self.remedy}" if emergency else what, seen)
