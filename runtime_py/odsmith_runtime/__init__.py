"""The Python runtime of devices that odsmith describes.

What a generated package builds on: the object dictionary with its entries, units, emergencies, abort codes, the state
machine, modes and recipes. It needs the standard library only, and at import almost none of that: each module here is
loaded when one of its names is first used, so that a program which wants a single object does not wait for the rest.

The way from `import` to a dictionary is short on purpose: two modules here and two of the generated package, none of
them of the standard library. That is why these four quote annotations instead of importing `__future__`.
"""

import sys

TYPE_CHECKING = False  # as in typing, whose import would cost more than all of this package
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from functools import cached_property

    from .abort_codes import AbortCodeInfo as AbortCodeInfo
    from .choices import Bits as Bits
    from .choices import Choice as Choice
    from .choices import Word as Word
    from .dictionary import ObjectDictionary as ObjectDictionary
    from .emergencies import ConditionInfo as ConditionInfo
    from .emergencies import Emergency as Emergency
    from .emergencies import EmergencyTable as EmergencyTable
    from .entries import Entry as Entry
    from .entries import Object as Object
    from .errors import NoSuchObjectError as NoSuchObjectError
    from .errors import OutOfRangeError as OutOfRangeError
    from .errors import ReadOnlyError as ReadOnlyError
    from .errors import RefusedError as RefusedError
    from .errors import WrongLengthError as WrongLengthError
    from .errors import WrongSignatureError as WrongSignatureError
    from .errors import WrongTypeError as WrongTypeError
    from .identity import Identity as Identity
    from .leds import Led as Led
    from .leds import LedPattern as LedPattern
    from .modes import HomingMethodInfo as HomingMethodInfo
    from .modes import ModeInfo as ModeInfo
    from .modes import RampParameter as RampParameter
    from .nmt import NmtCommandInfo as NmtCommandInfo
    from .nmt import NmtStateInfo as NmtStateInfo
    from .pdos import Pdo as Pdo
    from .recipes import Command as Command
    from .recipes import Expect as Expect
    from .recipes import Input as Input
    from .recipes import Recipe as Recipe
    from .recipes import Wait as Wait
    from .recipes import Write as Write
    from .rows import Named as Named
    from .rows import Role as Role
    from .state_machine import PdsCommandInfo as PdsCommandInfo
    from .state_machine import PdsStateInfo as PdsStateInfo
    from .state_machine import StateMachine as StateMachine
    from .state_machine import Transition as Transition
    from .units import Unit as Unit

    lazy_property = cached_property
else:

    class lazy_property:  # noqa: N801  # used like property
        """A property that is computed once and then stands in the instance: `functools.cached_property`."""

        def __init__(self, compute):
            self.compute = compute

        def __set_name__(self, owner, name):
            self.name = name

        def __get__(self, instance, owner=None):
            if instance is None:
                return self
            value = instance.__dict__[self.name] = self.compute(instance)
            return value


def load_on_use(
    package: str, homes: "Mapping[str, tuple[str, ...]]"
) -> "tuple[Callable[[str], object], Callable[[], list[str]], list[str]]":
    """`__getattr__`, `__dir__` and `__all__` of a package that loads its modules on first use (PEP 562).

    `homes` lists the public names of each module. Asking the package for one of them, or for a module itself, imports
    that module; from then on the name is an ordinary attribute. Unknown names raise AttributeError.
    """
    module = sys.modules[package]
    public = [name for names in homes.values() for name in names]

    def get(name: str) -> object:
        for home, names in homes.items():
            if name == home or name in names:
                __import__(f"{package}.{home}")
                loaded = sys.modules[f"{package}.{home}"]
                value: object = loaded if name == home else getattr(loaded, name)
                setattr(module, name, value)
                return value
        raise AttributeError(f"module {package!r} has no attribute {name!r}", name=name, obj=module)

    def names() -> list[str]:
        return sorted({*vars(module), *homes, *public})

    return get, names, public


if not TYPE_CHECKING:  # hidden from type checkers, who would take any name for granted
    __getattr__, __dir__, __all__ = load_on_use(
        __name__,
        {
            "abort_codes": ("AbortCodeInfo",),
            "choices": ("Bits", "Choice", "Word"),
            "dictionary": ("ObjectDictionary",),
            "emergencies": ("ConditionInfo", "Emergency", "EmergencyTable"),
            "entries": ("Entry", "Object"),
            "errors": (
                "NoSuchObjectError",
                "OutOfRangeError",
                "ReadOnlyError",
                "RefusedError",
                "WrongLengthError",
                "WrongSignatureError",
                "WrongTypeError",
            ),
            "identity": ("Identity",),
            "leds": ("Led", "LedPattern"),
            "modes": ("HomingMethodInfo", "ModeInfo", "RampParameter"),
            "nmt": ("NmtCommandInfo", "NmtStateInfo"),
            "pdos": ("Pdo",),
            "recipes": ("Command", "Expect", "Input", "Recipe", "Wait", "Write"),
            "rows": ("Named", "Role"),
            "state_machine": ("PdsCommandInfo", "PdsStateInfo", "StateMachine", "Transition"),
            "units": ("Unit",),
        },
    )
