"""Judges the shape of documents by the JSON Schema of the format, and says in plain sentences what does not fit.

The schema is the only place that knows which keys there are and what they may hold. A validator's own messages
("is not valid under any of the given schemas") help nobody, so every error is told anew from the schema: what was
expected, what was found, what was probably meant.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from odsmith.canopen_types import Place
from odsmith.errors import Diagnostic, SpecError, did_you_mean, listed, quoted
from odsmith.load import Loaded, Map, Seq
from odsmith.rules import diagnose

if TYPE_CHECKING:
    from jsonschema_rs import ValidationError, Validator

MAX_ERRORS = 100
"""Errors reported per document."""

Steps = Sequence[str | int]
"""Where a value stands in a document: keys and list positions from the top."""


def schema_text() -> str:
    """The format's schema: packaged as `odsmith.spec`, or in the checkout beside the generator.

    Raises FileNotFoundError if it is in neither place.
    """
    try:
        return resources.files("odsmith.spec").joinpath("schema.json").read_text("utf-8")
    except (ModuleNotFoundError, FileNotFoundError):
        return (Path(__file__).parents[2] / "spec" / "schema.json").read_text("utf-8")


class Schema:
    """A compiled schema of the format."""

    def __init__(self, raw: dict[str, Any]) -> None:
        # Imported here because only a build needs it, and commands that only look things up should not wait for it.
        from jsonschema_rs import validator_for

        self._raw = raw
        self._document = validator_for(raw)
        self._whole_raw: dict[str, Any] = raw["$defs"]["whole"]
        self._whole = validator_for(self._whole_raw)

    def errors(self, document: Map) -> list[Diagnostic]:
        """What is wrong with the shape of a document."""
        return self._errors(document, self._document, self._raw)

    def merged_errors(self, merged: Map) -> list[Diagnostic]:
        """The same for a merged document, which must be whole as well."""
        return [*self.errors(merged), *self._errors(merged, self._whole, self._whole_raw)]

    @staticmethod
    def _errors(document: Map, validator: Validator, raw: dict[str, Any]) -> list[Diagnostic]:
        explain = _Explainer(document, raw)
        found = (item for error in validator.iter_errors(document) for item in explain(error))
        return [*islice(found, MAX_ERRORS), *explain.missing()]


@cache
def packaged_schema() -> Schema:
    """The format's schema, compiled once."""
    return Schema(json.loads(schema_text()))


def validate(loaded: Loaded, schema: Schema | None = None) -> None:
    """Raises SpecError with what is wrong with the shape of any document, by the packaged schema if none is given."""
    schema = schema or packaged_schema()
    _stop_if_any((item for document in loaded.documents for item in schema.errors(document)), loaded.texts)


def validate_merged(merged: Map, texts: Mapping[str, str], schema: Schema | None = None) -> None:
    """Raises SpecError with what is wrong once everything is merged: what changes made, and what no file says."""
    _stop_if_any((schema or packaged_schema()).merged_errors(merged), texts)


def _stop_if_any(diagnostics: Iterable[Diagnostic], texts: Mapping[str, str]) -> None:
    found = list(diagnostics)
    if found:
        raise SpecError(found, texts)


_KINDS = {
    "integer": "an integer",
    "number": "a number",
    "string": "text",
    "object": "a mapping",
    "array": "a list",
    "boolean": "true or false",
    "null": "null",
}


class _Explainer:
    """Tells the errors of one document."""

    def __init__(self, document: Map, raw: dict[str, Any]) -> None:
        self._document = document
        self._raw = raw
        self._missing: dict[tuple[Place, str], list[str]] = {}
        """Keys that are missing, by the place to report and the element that lacks them: one sentence for each."""

    def missing(self) -> Iterator[Diagnostic]:
        """What to say about the keys that the errors told so far found missing."""
        for (place, label), keys in self._missing.items():
            verb = "is" if len(keys) == 1 else "are"
            yield diagnose("E202", place, f"{listed(dict.fromkeys(keys), 'and')} {verb} missing in {label}")

    def __call__(self, error: ValidationError) -> Iterator[Diagnostic]:
        path = self._path(error.instance_path)
        keyword = error.kind.name
        told = getattr(self, f"_on_{keyword.lower()}", None)
        if told is None:
            yield diagnose("E208", self._place(path), f"{self._called(path)} does not fit: {quoted(error.message)}")
        elif keyword != "propertyNames" and self._value(path) is None:
            yield self._empty(path)
        else:
            yield from told(error, path)

    # ---- where and what -----------------------------------------------------------------------------------------

    def _path(self, steps: Steps) -> Steps:
        """A path of the validator with keys as the document has them: it takes the key "1" for the number 1."""
        path: list[str | int] = []
        value: Any = self._document
        for step in steps:
            if isinstance(value, Map) and isinstance(step, int):
                step = next((key for key in value if key == str(step)), None) or next(
                    key for key in value if key.lstrip("+").isdecimal() and int(key) == step
                )
            path.append(step)
            value = value[step]
        return path

    def _value(self, path: Steps) -> Any:
        value: Any = self._document
        for step in path:
            value = value[step]
        return value

    def _place(self, path: Steps) -> Place:
        """The place of a value."""
        return self._value(path[:-1]).place(path[-1]) if path else self._document.where

    def _head(self, path: Steps) -> Place:
        """The place that names an element: its key, or its beginning in a list."""
        parent = self._value(path[:-1]) if path else None
        return parent.key_place(str(path[-1])) if isinstance(parent, Map) else self._place(path)

    def _label(self, path: Steps) -> str:
        """An element's address as errata write it, `objects.controlword`; list elements by name where they have one."""
        words: list[str] = []
        value: Any = self._document
        for step in path:
            value = value[step]
            identity = _identity(value) if isinstance(step, int) else None
            words.append(str(step) if identity is None else identity)
        return quoted(".".join(words)) if words else "the file"

    @staticmethod
    def _called(path: Steps) -> str:
        """What a sentence calls a value: its key."""
        key = next((step for step in reversed(path) if isinstance(step, str)), None)
        if key is None:
            return "the file"
        return quoted(key) if path[-1] == key else f"an item of {quoted(key)}"

    def _schema(self, error: ValidationError) -> dict[str, Any]:
        """The part of the schema that has the keyword which failed."""
        part: Any = self._raw
        for step in error.schema_path[:-1]:
            part = part[step]
        return part if isinstance(part, dict) else {}

    # ---- a sentence for each keyword ----------------------------------------------------------------------------

    def _empty(self, path: Steps) -> Diagnostic:
        hint = "write a value after the `:`, or delete the key; text that contains `, ` in braces needs quotes"
        return diagnose("E203", self._head(path), f"{self._called(path)} has no value", hint)

    def _on_additionalproperties(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        known = list(self._schema(error).get("properties", ()))
        owner: Map = self._value(path)
        for key in error.kind.as_dict()["unexpected"]:
            hint = did_you_mean(key, known)
            if not hint and owner[key] is None:
                hint = "text that contains `, ` in braces needs quotes"
            elif not hint and len(known) <= 12:
                hint = f"known here: {listed(known, 'and')}"
            yield diagnose("E201", owner.key_place(key), f"unknown key {quoted(key)} in {self._label(path)}", hint)

    def _on_required(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        key = error.kind.as_dict()["property"]
        if error.schema_path[-1] == "dependentRequired":
            owner: Map = self._value(path)
            needy = [word for word, needs in self._schema(error)["dependentRequired"].items() if key in needs]
            for word in (word for word in needy if word in owner):
                yield diagnose("E208", owner.key_place(word), f"{quoted(word)} says nothing without {quoted(key)}")
        else:
            # A key that a change deleted is missed where it was deleted.
            owner = self._value(path)
            place = owner.key_place(key) if key in owner.marks else self._head(path)
            self._missing.setdefault((place, self._label(path)), []).append(key)

    def _on_type(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._mismatch(path, error.kind.as_dict()["types"])

    def _mismatch(self, path: Steps, types: Iterable[str], words: Iterable[str] = ()) -> Diagnostic:
        """A value of the wrong kind; `words` are allowed as well."""
        value = self._value(path)
        # Text may look like a number to an editor; here there are no fractions.
        kinds = [kind for kind in dict.fromkeys(types) if kind not in ("number", "null")]
        expected = " or ".join([*(_KINDS[kind] for kind in kinds), *(quoted(word) for word in words)])
        message = f"{self._called(path)} must be {expected}, not {_found(value)}"
        return diagnose("E203", self._place(path), message, _conversion(value, kinds))

    def _on_enum(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._not_among(path, error.kind.as_dict()["options"])

    def _on_const(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._not_among(path, [error.kind.as_dict()["expected_value"]])

    def _not_among(self, path: Steps, options: list[Any]) -> Diagnostic:
        value = self._value(path)
        guess = did_you_mean(value, map(str, options)) if isinstance(value, str) else ""
        hint = guess or f"allowed: {listed(map(str, options), 'and')}"
        if isinstance(value, (Map, Seq)):
            return diagnose(
                "E203", self._place(path), f"{self._called(path)} must be a word, not {_found(value)}", hint
            )
        return diagnose("E204", self._place(path), f"{self._called(path)} cannot be {quoted(value)}", hint)

    def _on_pattern(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        message = f"{self._called(path)} is {quoted(self._value(path))}: {self._form(error)}"
        yield diagnose("E205", self._place(path), message, self._example(error))

    def _on_propertynames(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        wrong: ValidationError = error.kind.as_dict()["error"]
        key = str(wrong.instance)
        form = self._form(wrong) if wrong.kind.name == "pattern" else "the key is too long"
        place = self._value(path).key_place(key)
        message = f"bad key {quoted(key)} in {self._label(path)}: {form}"
        yield diagnose("E209", place, message, self._example(wrong))

    def _form(self, error: ValidationError) -> str:
        return str(self._schema(error).get("patternErrorMessage", "it does not have the form that is asked for"))

    def _example(self, error: ValidationError) -> str:
        examples = [item for item in self._schema(error).get("examples", ()) if isinstance(item, str)]
        return f"for example {listed(examples, 'or')}" if examples else ""

    def _on_minimum(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._bounds(error, path, "least")

    def _on_maximum(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._bounds(error, path, "most")

    def _bounds(self, error: ValidationError, path: Steps, side: str) -> Diagnostic:
        limit = error.kind.as_dict()["limit"]
        message = f"{self._called(path)} is {_number(self._value(path))}; it must be at {side} {_number(limit)}"
        return diagnose("E206", self._place(path), message)

    def _on_minlength(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield diagnose("E207", self._place(path), f"{self._called(path)} is empty")

    def _on_maxlength(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._amount(error, path, "characters")

    def _on_minitems(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._amount(error, path, "items")

    def _on_maxitems(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._amount(error, path, "items")

    def _on_minproperties(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        yield self._amount(error, path, "keys")

    def _amount(self, error: ValidationError, path: Steps, unit: str) -> Diagnostic:
        has, limit = len(self._value(path)), error.kind.as_dict()["limit"]
        wanted = f"at {'least' if has < limit else 'most'} {limit}"
        told = f"has {has} {unit}, not {wanted}" if has else "is empty"
        return diagnose("E207", self._place(path), f"{self._called(path)} {told}")

    def _on_uniqueitems(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        items: Seq = self._value(path)
        first: dict[str, int] = {}
        for index, item in enumerate(items):
            known = first.setdefault(json.dumps(item, sort_keys=True), index)
            if known != index:
                notes = ((items.place(known), "first listed here"),)
                message = f"{self._called(path)} lists {quoted(item)} twice"
                yield diagnose("E207", items.place(index), message, "delete one of the two", notes=notes)

    # ---- alternatives -------------------------------------------------------------------------------------------

    def _on_oneof(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        """The format uses oneOf only for keys of which exactly one must be there."""
        keys = [branch["required"][0] for branch in self._schema(error)["oneOf"]]
        owner = self._value(path)
        if not isinstance(owner, Map):
            return  # its type is wrong as well, and that says it all
        present = [key for key in owner if key in keys]
        if not present:
            yield diagnose("E202", self._head(path), f"one of {listed(keys)} is missing in {self._label(path)}")
        else:
            message = f"{listed(present, 'and')} exclude each other in {self._label(path)}"
            yield diagnose("E208", owner.key_place(present[1]), message)

    def _on_anyof(self, error: ValidationError, path: Steps) -> Iterator[Diagnostic]:
        """Explains the alternative that was probably meant: one whose kind of value fits, the nearer the better."""
        steps = error.instance_path
        branches: list[list[ValidationError]] = error.kind.as_dict()["context"]
        fitting = [branch for branch in branches if not any(_another_kind(item, steps) for item in branch)]
        if fitting:
            for item in min(fitting, key=len):
                yield from self(item)
        else:
            types, words = _alternatives(branches, steps)
            only_words = isinstance(self._value(path), str) and words
            yield self._not_among(path, words) if only_words else self._mismatch(path, types, words)


def _identity(element: Any) -> str | None:
    """What an element of a list is called."""
    for key in ("name", "id", "number", "index"):
        if isinstance(element, Map) and key in element:
            value = element[key]
            return f"0x{value:04X}" if key == "index" and isinstance(value, int) else str(value)
    return None


def _another_kind(error: ValidationError, path: Steps) -> bool:
    """Whether the error says that the value at `path` is of another kind altogether."""
    return error.instance_path == path and error.kind.name in ("type", "enum", "const", "anyOf", "not")


def _alternatives(branches: Iterable[Iterable[ValidationError]], path: Steps) -> tuple[list[str], list[str]]:
    """The kinds of value and the words that alternatives allow at `path`."""
    types: list[str] = []
    words: list[str] = []
    for error in (item for branch in branches for item in branch if item.instance_path == path):
        facts = error.kind.as_dict()
        types += facts.get("types", ())
        words += map(str, facts.get("options", ()))
        words += [str(facts["expected_value"])] if "expected_value" in facts else []
        nested = _alternatives(facts.get("context", ()), path)
        types, words = types + nested[0], words + nested[1]
    return types, words


def _found(value: Any) -> str:
    if isinstance(value, Map):
        return "a mapping"
    if isinstance(value, Seq):
        return "a list"
    return f"the text {quoted(value)}" if isinstance(value, str) else quoted(value)


def _conversion(value: Any, kinds: Sequence[str]) -> str:
    """A hint for a value that is nearly of the right kind."""
    if "string" in kinds and isinstance(value, (bool, int)):
        return "put it in quotes if it is text"
    if "integer" in kinds and isinstance(value, str):
        if value.lstrip("-").isdecimal():
            return f"without quotes: {value}" if len(value) < 20 else ""
        if value[-1:] in "hH" and value[:-1].isalnum():
            return f"hexadecimal numbers begin with 0x: 0x{value[:-1]}" if len(value) < 20 else ""
        return "there are no fractions in this format" if value.replace(".", "", 1).isdecimal() else ""
    if kinds == ["array"] and isinstance(value, (str, int)):
        return f"write it as a list: [{value}]" if len(str(value)) < 40 else "write it as a list, in brackets"
    return ""


def _number(value: int) -> str:
    """A number as messages show it: hexadecimal too where it may be an index or a mask."""
    return f"{value} (0x{value:X})" if value > 255 else str(value)
