"""The backends by name: the four built-in ones, and those of other distributions.

A third party adds a backend as a subclass of `odsmith.render.Backend`, registered under the entry point group
`odsmith.backends`; `odsmith build --backend NAME` runs it.
"""

from __future__ import annotations

from importlib import import_module

from odsmith.render import Backend

BUILT_IN = {
    "eds": "odsmith.backends.eds:EdsBackend",
    "c": "odsmith.backends.c:CBackend",
    "python": "odsmith.backends.python:PythonBackend",
    "docs": "odsmith.backends.docs:DocsBackend",
}


class UnknownBackendError(LookupError):
    """No distribution offers a backend of this name."""


def backend(name: str) -> Backend:
    """The backend called `name`. Raises UnknownBackendError."""
    if name in BUILT_IN:
        module, _, attribute = BUILT_IN[name].partition(":")
        return getattr(import_module(module), attribute)()  # type: ignore[no-any-return]  # the table above says so
    from importlib.metadata import entry_points  # 20 ms: only for names that are not built in

    for entry_point in entry_points(group="odsmith.backends", name=name):
        return entry_point.load()()  # type: ignore[no-any-return]  # a plug-in promises to be a Backend
    raise UnknownBackendError(name)
