"""What type checkers want from typing, without importing that when a program runs.

Importing it takes several times as long as importing a whole generated dictionary. Type checkers see the real
things; at run time nothing here is parametrised, so stand-ins that ignore their parameters are enough.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Generic as Generic
    from typing import TypeVar as TypeVar
    from typing import dataclass_transform as dataclass_transform
else:

    class Generic:
        """Base of a class with a type parameter; `Entry[int]` is `Entry`."""

        def __class_getitem__(cls, parameter):
            return cls

    def TypeVar(name, **_):  # noqa: N802  # named as what it stands for
        return name

    def dataclass_transform(**_):
        return lambda decorated: decorated
