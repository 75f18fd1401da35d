"""The manual of the YAML format, read out of its JSON Schema.

The schema says the shape of an element in one definition and what a complete element must say in others that only
constrain it (a change need not be complete). Here both come together: a table of keys, each with its kind, whether it
must be there, and what it means.
"""

from __future__ import annotations

import json
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from odsmith.backends.docs.text import Piece, Reader, Rich, code, joined, plain
from odsmith.errors import SpecError
from odsmith.load import parse
from odsmith.render import data_folder

Node = Mapping[str, Any]

_REFERENCE = "#/$defs/"


class Key(NamedTuple):
    """A key of a mapping. `must` is empty where the key may be left out."""

    name: str
    kind: Rich
    must: str
    text: Rich


class Definition(NamedTuple):
    """A section of a file, or an element that sections are made of. `examples` are values as YAML on one line."""

    id: str
    title: str
    text: Rich
    kind: Rich
    must: str
    keys: tuple[Key, ...]
    examples: tuple[str, ...]


class Manual(NamedTuple):
    title: str
    text: Rich
    sections: tuple[Definition, ...]
    elements: tuple[Definition, ...]


def read_schema() -> Node:
    """The schema of the spec format, as it is packaged."""
    schema: Node = json.loads(data_folder("spec").joinpath("schema.json").read_text(encoding="utf-8"))
    return schema


def manual(schema: Node) -> Manual:
    """The manual of the format that the schema describes."""
    return _Writer(schema).manual()


class _Writer:
    def __init__(self, schema: Node) -> None:
        self.schema = schema
        self.definitions: Mapping[str, Node] = schema.get("$defs", {})
        self.read = Reader({})
        self.demands = _Demands(schema)

    def manual(self) -> Manual:
        sections = tuple(self._section(name, node) for name, node in self.schema["properties"].items())
        elements = tuple(
            self._element(name, node) for name, node in self.definitions.items() if not _only_constrains(node)
        )
        return Manual(self.schema["title"], self.read(self.schema["description"]), sections, elements)

    def _section(self, name: str, node: Node) -> Definition:
        return Definition(
            id=f"section-{name}",
            title=name,
            text=self.read(node.get("description", "")),
            kind=self._kind(node),
            must=self.demands.of("", name),
            keys=tuple(self._keys(node, f"{name}.", "")),
            examples=tuple(f"{name}: {flow(example)}" for example in node.get("examples", ())),
        )

    def _element(self, name: str, node: Node) -> Definition:
        return Definition(
            id=f"type-{name}",
            title=node.get("title", name),
            text=self.read(node.get("description", "")),
            kind=() if "properties" in node else self._kind(node),
            must="",
            keys=tuple(self._keys(node, "", name)),
            examples=tuple(flow(example) for example in node.get("examples", ())),
        )

    def _keys(self, node: Node, prefix: str, element: str) -> Iterator[Key]:
        """The keys of a mapping; of a mapping without a name within it too, as `outer.inner`."""
        for name, item in node.get("properties", {}).items():
            if "properties" in item:
                yield from self._keys(item, f"{prefix}{name}.", element)
                continue
            text = list(self.read(item.get("description", "")))
            for position, example in enumerate(item.get("examples", ())):
                text += [Piece(" or " if position else " Example: "), *code(flow(example))]
            yield Key(prefix + name, self._kind(item), self.demands.of(element, prefix + name), tuple(text))

    def _kind(self, node: Node) -> Rich:
        """What a value is, in words."""
        references = [name for name in _references(node) if not _only_constrains(self.definitions[name])]
        if references:
            return joined((self._reference(name) for name in references), " or ")
        if "const" in node:
            return code(flow(node["const"]))
        if "enum" in node:
            return joined((code(flow(value)) for value in node["enum"]), ", ")
        if "anyOf" in node:
            return joined((self._kind(item) for item in node["anyOf"]), " or ")
        kinds = node.get("type", "any")
        return joined((self._simple(kind, node) for kind in ([kinds] if isinstance(kinds, str) else kinds)), " or ")

    def _reference(self, name: str) -> Rich:
        return (Piece(self.definitions[name].get("title", name), f"#type-{name}"),)

    def _simple(self, kind: str, node: Node) -> Rich:
        if kind == "array":
            return (Piece("list of "), *self._kind(node.get("items", {})))
        if kind == "object":
            if not isinstance(node.get("additionalProperties"), Mapping):
                return plain("mapping")
            keys = self._kind(node["propertyNames"]) if "propertyNames" in node else plain("text")
            return (Piece("mapping of "), *keys, Piece(" to "), *self._kind(node["additionalProperties"]))
        if kind == "integer" and "minimum" in node and "maximum" in node:
            return plain(f"integer, {node['minimum']} to {node['maximum']}")
        return plain({"string": "text", "boolean": "true or false"}.get(kind, kind))


class _Demands:
    """Which keys each element must have, found by following what constrains the places where it is used."""

    def __init__(self, schema: Node) -> None:
        self.definitions: Mapping[str, Node] = schema.get("$defs", {})
        self.found: dict[str, dict[str, str]] = defaultdict(dict)
        used: set[str] = set()
        for name, node in (("", schema), *self.definitions.items()):
            self._constrain(node, name)
            self._walk(node)
            used.update(_all_references(node))
        for name, node in self.definitions.items():  # constrains the whole, from outside the schema of one file
            if name not in used and _only_constrains(node):
                for key, item in node.get("properties", {}).items():
                    self._constrain(item, self._element_of(schema["properties"][key]))

    def of(self, element: str, key: str) -> str:
        return self.found[element].get(key, "")

    def _walk(self, node: Any) -> None:
        """Visit every place that uses an element and says more about it."""
        if isinstance(node, list):
            for item in node:
                self._walk(item)
        if not isinstance(node, Mapping):
            return
        element = self._element_of(node)
        if element:
            self._constrain({key: value for key, value in node.items() if key != "$ref"}, element)
            for name in _references(node):
                if _only_constrains(self.definitions[name]):
                    self._constrain(self.definitions[name], element)
        for item in node.values():
            self._walk(item)

    def _element_of(self, node: Node) -> str:
        return next((name for name in _references(node) if not _only_constrains(self.definitions[name])), "")

    def _constrain(self, node: Node, element: str) -> None:
        """Note what a schema demands of an element, and of the elements within it."""
        for key in node.get("required", ()):
            self.found[element][key] = "yes"
        for choice in node.get("oneOf", ()):
            self._weaker(choice, element, "one of these")
        for part in ("then", "else"):
            self._weaker(node.get(part, {}), element, "where it applies")
        shape = self.definitions.get(element, {})
        for key, item in node.get("properties", {}).items():
            inner = self._element_of(shape.get("properties", {}).get(key, {}))
            if inner and inner != element and "properties" not in shape.get("properties", {}).get(key, {}):
                self._constrain_use(item, shape["properties"][key], inner)
            elif isinstance(item.get("additionalProperties"), Mapping):
                self._constrain_use(item, shape.get("properties", {}).get(key, {}), "")

    def _constrain_use(self, item: Node, shape: Node, element: str) -> None:
        if element:
            self._constrain(item, element)
            shape = self.definitions[element]
        values, shape_values = item.get("additionalProperties"), _values_of(shape)
        if isinstance(values, Mapping) and isinstance(shape_values, Mapping):
            inner = self._element_of(shape_values)
            if inner:
                for name in _references(values):
                    self._constrain(self.definitions[name], inner)
                self._constrain(values, inner)
        for name in _references(item):
            if _only_constrains(self.definitions[name]):
                self._constrain_use(self.definitions[name], shape, element)

    def _weaker(self, node: Node, element: str, word: str) -> None:
        for key in node.get("required", ()):
            self.found[element].setdefault(key, word)
        for part in ("then", "else"):
            if part in node:
                self._weaker(node[part], element, word)


def _values_of(shape: Node) -> Any:
    """What the keys of a mapping lead to, also where the mapping is one of several possibilities."""
    options = (shape, *shape.get("anyOf", ()))
    return next((option["additionalProperties"] for option in options if option.get("additionalProperties")), None)


def _references(node: Node) -> list[str]:
    """The definitions that a place uses, directly or with `allOf`."""
    found = [node["$ref"].removeprefix(_REFERENCE)] if "$ref" in node else []
    for item in node.get("allOf", ()):
        found += _references(item)
    return found


def _all_references(node: Any) -> Iterator[str]:
    if isinstance(node, list):
        for item in node:
            yield from _all_references(item)
    elif isinstance(node, Mapping):
        yield from _references(node)
        for item in node.values():
            yield from _all_references(item)


def _only_constrains(node: Node) -> bool:
    """True for a definition that says what must be there, not what an element is."""
    return not any(key in node for key in ("type", "enum", "const", "anyOf"))


def flow(value: Any) -> str:
    """A value as YAML on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_scalar(str(key))}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    if value is None or isinstance(value, bool):
        return json.dumps(value)
    return _scalar(value) if isinstance(value, str) else str(value)


_NUMBER_OR_DATE = re.compile(r"[-+]?[0-9]*\.?[0-9]+|[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}")
"""Text that other YAML readers, those of editors among them, do not take for text."""


def _scalar(text: str) -> str:
    """Text as YAML: plain where every reader reads it back as it is, else quoted."""
    plain_text = not set(text) & set(",[]{}") and not _NUMBER_OR_DATE.fullmatch(text) and _reads_back(text)
    return text if plain_text else json.dumps(text, ensure_ascii=False)


def _reads_back(text: str) -> bool:
    """True where the text stays itself in a list and as the value of a key."""
    try:
        return parse(f"key: [{text}, {{inner: {text}}}]\n".encode(), "").get("key") == [text, {"inner": text}]
    except SpecError:
        return False
