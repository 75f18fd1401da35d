"""Makes one document of many: what includes define, less what is removed, with what is changed, plus what is new.

Documents are worked off in the order of `Loaded.documents`, includes first. Each one first removes and changes
elements that stand already and then adds its own, so that a change always speaks of an included file. Everything
keeps the place where it was written. The documents themselves are not touched.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, SpecError, did_you_mean, quoted
from odsmith.load import Loaded, Map, Seq
from odsmith.rules import diagnose
from odsmith.validate import validate_merged

# The shape of the sections. A text names the key by which the elements of a list are told apart: while documents are
# merged, such a list is a mapping by that identity. A list whose elements have no identity is simply joined.
_ELEMENT = "one element"
_NAMED = "elements by name"
_JOINED = "list without identities"
_BY_KEY = {"name", "id", "number"}

_Shape = str | Mapping[str, "_Shape"]

_SECTIONS: Mapping[str, _Shape] = {
    "device": _ELEMENT,
    "vocabulary": _ELEMENT,
    "axes": {"count": _ELEMENT, "areas": _NAMED, "device_wide": _JOINED},
    "nmt": {"states": _NAMED, "commands": _NAMED},
    "pds": {"states": _NAMED, "commands": _NAMED, "events": _NAMED, "transitions": "number"},
    "pdos": {"max_entries": _ELEMENT, "other_axes_cob_id": _ELEMENT, "rpdo": _NAMED, "tpdo": _NAMED},
    "objects": "name",
    "emergencies": "name",
    "errata": "id",
}
"""Every section that is not just elements by name."""

_INSTRUCTIONS = ("format", "include", "change", "remove")


def merge(loaded: Loaded) -> Map:
    """The one document that all files together say, as a new tree with the shape of a file.

    Raises SpecError if an element is defined twice, if a change or removal names what is not there, or if a change
    made something that the schema does not allow.
    """
    merger = _Merger(loaded)
    for document in loaded.documents:
        merger.add(document)
    merged = merger.result()
    if merger.diagnostics:
        raise SpecError(merger.diagnostics, loaded.texts)
    validate_merged(merged, loaded.texts)
    return merged


def _shape(shape: _Shape, key: str) -> _Shape:
    return shape.get(key, _NAMED) if isinstance(shape, Mapping) else _ELEMENT


class _Merger:
    """The merged tree as it grows. Lists with identities stand in it as mappings until the end."""

    def __init__(self, loaded: Loaded) -> None:
        self.diagnostics: list[Diagnostic] = []
        self._tree = loaded.root.empty_copy()
        self._tree.take(loaded.root, "format")

    def add(self, document: Map) -> None:
        """Works off one document."""
        if isinstance(removals := document.get("remove"), Map):
            self._remove(self._tree, removals, _SECTIONS, [])
        if isinstance(changes := document.get("change"), Map):
            self._change_sections(self._tree, changes, _SECTIONS, document, [])
        for key in document:
            if key not in _INSTRUCTIONS:
                self._define(self._tree, document, key, _shape(_SECTIONS, key), [key])

    def result(self) -> Map:
        """The merged tree with its lists as lists."""
        self._check_indices()
        return _with_lists(self._tree, _SECTIONS)

    # ---- definitions --------------------------------------------------------------------------------------------

    def _define(self, tree: Map, source: Map, key: str, shape: _Shape, path: list[str]) -> None:
        """Adds what `source` says under `key` to `tree`."""
        value = source[key]
        if shape == _ELEMENT:
            self._define_element(tree, source, key, path)
        elif shape == _JOINED:
            self._join(tree, source, key)
        elif isinstance(shape, str) and shape in _BY_KEY:
            self._define_list(tree, source, key, shape, path)
        elif isinstance(value, Map):
            target = _opened(tree, source, key)
            for name in value:
                inner = _shape(shape, name)
                self._define(target, value, name, inner, [*path, name])

    def _define_element(self, tree: Map, source: Map, key: str, path: list[str]) -> None:
        if key in tree:
            self._twice(path, source.key_place(key), tree.key_place(key))
        else:
            tree.take(source, key)

    def _define_list(self, tree: Map, source: Map, key: str, identity: str, path: list[str]) -> None:
        elements = source[key]
        assert isinstance(elements, Seq)
        target = _opened(tree, source, key)
        for index, element in enumerate(elements):
            assert isinstance(element, Map)
            name = str(element[identity])
            if name in target:
                self._twice([*path, name], element.place(identity), target.key_place(name))
                continue
            target[name] = element
            place, start = element.place(identity), elements.place(index)
            target.marks[name] = (place.path, place.line, place.column, start.line, start.column)

    @staticmethod
    def _join(tree: Map, source: Map, key: str) -> None:
        items = source[key]
        assert isinstance(items, Seq)
        if key in tree and not isinstance(tree[key], Seq):
            return  # a change broke it, which the schema will tell
        joined = items.empty_copy()
        for part in (tree.get(key), items):
            if isinstance(part, Seq):
                for index in range(len(part)):
                    joined.take(part, index)
        tree.take(source, key)
        tree[key] = joined

    def _twice(self, path: list[str], place: Place, first: Place) -> None:
        message = f"{quoted('.'.join(path))} is defined twice"
        self.diagnostics.append(diagnose("E210", place, message, notes=((first, "first defined here"),)))

    def _check_indices(self) -> None:
        """An object written twice under two names would otherwise only be found when its index is resolved."""
        objects = self._tree.get("objects")
        first: dict[int | str, tuple[str, Map]] = {}
        for name, element in objects.items() if isinstance(objects, Map) else ():
            index = element.get("index") if isinstance(element, Map) else None
            if not isinstance(element, Map) or not isinstance(index, (int, str)):
                continue
            known, earlier = first.setdefault(index, (name, element))
            if known != name:
                shown = f"0x{index:04X}" if isinstance(index, int) else index
                message = f"index {quoted(shown)} is defined twice, as {quoted(known)} and {quoted(name)}"
                notes = ((earlier.place("index"), "first defined here"),)
                self.diagnostics.append(diagnose("E210", element.place("index"), message, notes=notes))

    # ---- changes ------------------------------------------------------------------------------------------------

    def _change_sections(self, tree: Map, changes: Map, shape: _Shape, document: Map, path: list[str]) -> None:
        """Changes elements of `tree`; above the elements every key must exist."""
        for key in changes:
            value, inner, address = changes[key], _shape(shape, key), [*path, key]
            if key not in tree:
                self._absent("E211", changes.key_place(key), tree, address, document)
            elif value is None:
                _delete(tree, changes, key)
            elif inner in (_ELEMENT, _JOINED):
                self._change(tree, changes, key, address)
            elif isinstance(value, Map):
                below = tree[key]
                assert isinstance(below, Map)
                identity = inner if isinstance(inner, str) and inner in _BY_KEY else ""
                self._refuse_new_identity(value, identity, address)
                self._change_sections(below, value, inner, document, address)
            else:
                message = f"{quoted('.'.join(address))} can only be changed by a mapping"
                self.diagnostics.append(diagnose("E203", changes.place(key), message))

    def _change(self, tree: Map, changes: Map, key: str, address: list[str]) -> None:
        """Puts the changed value in place of the old one."""
        old, new = tree[key], changes[key]
        if isinstance(old, Map) and isinstance(new, Map):
            tree[key] = self._changed(old, new, address)
        else:
            tree.take(changes, key)

    def _changed(self, old: Map, changes: Map, address: list[str]) -> Map:
        """A copy of an element with changes at any depth."""
        new = old.empty_copy()
        for key in old:
            new.take(old, key)
        for key in changes:
            if changes[key] is not None:
                if key in new:
                    self._change(new, changes, key, [*address, key])
                else:
                    new.take(changes, key)
            elif key in new:
                _delete(new, changes, key)
            else:
                self._absent("E211", changes.key_place(key), new, [*address, key])
        return new

    def _refuse_new_identity(self, changes: Map, identity: str, path: list[str]) -> None:
        for name, change in changes.items():
            if identity and isinstance(change, Map) and identity in change and str(change[identity]) != name:
                message = f"{quoted('.'.join([*path, name]))} cannot get another {quoted(identity)} by a change"
                self.diagnostics.append(diagnose("E213", change.key_place(identity), message))

    # ---- removals -----------------------------------------------------------------------------------------------

    def _remove(self, tree: Map, removals: Map, shape: _Shape, path: list[str]) -> None:
        for key in removals:
            wanted = removals[key]
            below = tree.get(key)
            known = below if isinstance(below, Map) else Map("", 0, 0)
            if isinstance(wanted, Map):
                self._remove(known, wanted, _shape(shape, key), [*path, key])
            elif isinstance(wanted, Seq):
                for index, name in enumerate(wanted):
                    if isinstance(name, str) and name in known:
                        del known[name], known.marks[name]
                    else:
                        self._absent("E212", wanted.place(index), known, [*path, key, str(name)])

    def _absent(self, rule: str, place: Place, known: Map, address: list[str], document: Map | None = None) -> None:
        """Reports that a change or removal names what no included file has."""
        if document is not None and _says(document, address):
            hint = "it is defined in this file: change it there"
        else:
            hint = did_you_mean(address[-1], known)
        verb = "change" if rule == "E211" else "remove"
        message = f"there is no {quoted('.'.join(address))} to {verb}"
        self.diagnostics.append(diagnose(rule, place, message, hint))


def _opened(tree: Map, source: Map, key: str) -> Map:
    """The mapping under a key of the merged tree, made at the place of the first file that has it."""
    if key not in tree:
        place = source.place(key)
        tree.take(source, key)
        tree[key] = Map(place.path, place.line, place.column)
    opened = tree[key]
    assert isinstance(opened, Map)
    return opened


def _delete(tree: Map, changes: Map, key: str) -> None:
    """Deletes a key but keeps the place of the deletion, for whoever misses the key."""
    del tree[key]
    tree.marks[key] = changes.marks[key]


def _says(document: Map, address: Iterable[str]) -> bool:
    """Whether a document itself defines the element at an address."""
    value: Any = document
    for key in address:
        if isinstance(value, Seq):
            value = next((item for item in value if isinstance(item, Map) and key in _identities(item)), None)
        else:
            value = value.get(key) if isinstance(value, Map) else None
    return value is not None


def _identities(element: Map) -> set[str]:
    return {str(element[key]) for key in _BY_KEY & element.keys()}


def _with_lists(tree: Map, shape: Mapping[str, _Shape]) -> Map:
    """A copy of the merged tree in which sections that are lists in a file are lists again."""
    new = tree.empty_copy()
    for key in tree:
        value, inner = tree[key], _shape(shape, key)
        new.take(tree, key)
        if isinstance(inner, Mapping) and isinstance(value, Map):
            new[key] = _with_lists(value, inner)
        elif inner in _BY_KEY and isinstance(value, Map):
            where = value.where
            elements = Seq(where.path, where.line, where.column)
            for name in value:
                place = value.place(name)
                elements.append(value[name])
                elements.marks.append((place.path, place.line, place.column))
            new[key] = elements
    return new
