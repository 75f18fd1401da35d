"""An axis of a drive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..names import Live, Names
from .async_axis import AsyncAxis
from .blocking import Blocking

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..entries import Entry
    from .values import Value


class Axis(Names[Live]):
    """One axis. Its objects are attributes, `axis.profile_velocity.raw = 51_200`; its methods are those of `AsyncAxis`,
    which block until they are done: in microsteps, pps and seconds, and with the same errors.
    """

    def __init__(self, twin: AsyncAxis, behind: Callable[[Entry[Any]], Value[Any]]) -> None:
        super().__init__(twin._dictionary, twin._axis, behind=behind)
        self._twin = twin

    def __repr__(self) -> str:
        return repr(self._twin)

    @property
    def number(self) -> int:
        """Which axis it is, from 0."""
        return self._twin.number

    status = Blocking(AsyncAxis.status)
    state = Blocking(AsyncAxis.state)
    mode = Blocking(AsyncAxis.mode)
    position = Blocking(AsyncAxis.position)
    position_in = Blocking(AsyncAxis.position_in)
    velocity = Blocking(AsyncAxis.velocity)
    velocity_in = Blocking(AsyncAxis.velocity_in)
    scale = Blocking(AsyncAxis.scale)

    enable = Blocking(AsyncAxis.enable)
    require_enabled = Blocking(AsyncAxis.require_enabled)
    disable = Blocking(AsyncAxis.disable)
    quick_stop = Blocking(AsyncAxis.quick_stop)
    reset_fault = Blocking(AsyncAxis.reset_fault)
    set_mode = Blocking(AsyncAxis.set_mode)

    home = Blocking(AsyncAxis.home)
    move_to = Blocking(AsyncAxis.move_to)
    move_by = Blocking(AsyncAxis.move_by)
    run = Blocking(AsyncAxis.run)
    wait = Blocking(AsyncAxis.wait)
    halt = Blocking(AsyncAxis.halt)
    resume = Blocking(AsyncAxis.resume)
    stop = Blocking(AsyncAxis.stop)
