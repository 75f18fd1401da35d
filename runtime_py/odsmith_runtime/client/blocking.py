"""Blocking methods made of asynchronous ones: one source, two faces."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, Concatenate, Generic, ParamSpec, TypeVar, overload

from .waiting import run

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from typing import Self

P = ParamSpec("P")
R = TypeVar("R")


class Blocking(Generic[P, R]):
    """A method that runs its twin of the asynchronous object in `_twin`: `enable = Blocking(AsyncAxis.enable)`.

    It takes the same arguments and gives the same result, only now.
    """

    def __init__(self, method: Callable[Concatenate[Any, P], Coroutine[Any, Any, R]]) -> None:
        self.method = method
        self.__doc__ = method.__doc__
        self.__module__ = method.__module__  # where the names of its annotations are known

    def __call__(self, holder: Any, *args: P.args, **kwargs: P.kwargs) -> R:
        return run(self.method(holder._twin, *args, **kwargs))

    @property
    def __signature__(self) -> inspect.Signature:
        return inspect.signature(self.method)

    @overload
    def __get__(self, holder: None, owner: type) -> Self: ...
    @overload
    def __get__(self, holder: object, owner: type) -> Callable[P, R]: ...
    def __get__(self, holder: object, owner: type) -> Self | Callable[P, R]:
        if holder is None:
            return self

        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            return self(holder, *args, **kwargs)

        call.__doc__ = self.__doc__
        call.__name__ = call.__qualname__ = self.method.__name__
        call.__wrapped__ = self.method  # type: ignore[attr-defined]  # for help() and inspect.signature
        return call
