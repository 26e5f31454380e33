"""Generation of generated/mapping.schema.json, the JSON Schema with which editors complete and check mapping.yaml."""

from __future__ import annotations

import json
from typing import Any

from roverlink.generator.emit.render import REGENERATE
from roverlink.generator.table.keys import Table
from roverlink.generator.table.parts import object_of
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    DataRate,
    Duration,
    Integer,
    Key,
    ListOf,
    MapOf,
    Named,
    Number,
    Object,
    Scalar,
    Text,
    Type,
)

FILE = "mapping.schema.json"

# YAML 1.1, and so PyYAML, needs a dot in a float: 1.0e-7 is a number, 1e-7 a string.
_POWER_OF_TEN = r"^[-+]?[0-9]+[eE][-+]?[0-9]+$"
"""Pattern of a number such as 1e-7, which YAML 1.1 reads as a text."""


def text() -> str:
    """Return the text of the file with the JSON Schema; it is the same for every table."""
    return json.dumps({"$comment": REGENERATE, **json_schema()}, indent=2) + "\n"


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of mapping.yaml."""
    definitions: dict[str, Any] = {}
    schema = _Schemas(definitions).of(object_of(Table))
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "roverlink mapping.yaml",
        **schema,
        "$defs": definitions,
    }


class _Schemas:
    """Converter from the types of values in mapping.yaml to JSON Schema.

    It collects the schemas of named types in ``definitions``, the ``$defs`` of the whole JSON Schema.
    """

    def __init__(self, definitions: dict[str, Any]) -> None:
        self._definitions = definitions

    def of(self, type: Type) -> dict[str, Any]:
        """Return the JSON Schema of a type; for a named type, a ``$ref`` to its definition."""
        if isinstance(type, Named):
            if type.name not in self._definitions:
                self._definitions[type.name] = {}  # ends the recursion: the type contains itself
                self._definitions[type.name] = self.of(type.definition())
            return {"$ref": f"#/$defs/{type.name}"}
        if isinstance(type, AnyOf):
            return {"anyOf": [self.of(form) for form in type.forms]}
        if isinstance(type, ListOf):
            return self._list(type)
        if isinstance(type, MapOf):
            return {"type": "object", "propertyNames": _names(type), "additionalProperties": self.of(type.value)}
        return self._object(type) if isinstance(type, Object) else _scalar(type)

    def _list(self, type: ListOf) -> dict[str, Any]:
        schema: dict[str, Any] = {"type": "array", "items": self.of(type.item)}
        if type.least:
            schema["minItems"] = type.least
        if isinstance(type.item, (Text, AnyOf)) and type.unique:
            schema["uniqueItems"] = True
        return schema

    def _object(self, type: Object) -> dict[str, Any]:
        schema: dict[str, Any] = {
            "type": "object",
            "additionalProperties": self.of(type.others.value) if type.others else False,
            "required": [name for name, key in type.keys.items() if key.required],
            "properties": {
                name: {"description": _description(key), **_default(key), **self.of(key.type)}
                for name, key in type.keys.items()
            },
        }
        if type.others:
            schema["propertyNames"] = _names(type.others)
        return schema


def _description(key: Key) -> str:
    return f"{key.meaning.text} Default: {key.meaning.default}." if key.meaning.default else key.meaning.text


def _default(key: Key) -> dict[str, Any]:
    """Return the ``default`` entry of a key's schema; empty if the default is not a text, a number or a boolean."""
    # A duration is a number here, but a text such as 500ms in the file.
    if key.meaning.default or not isinstance(key.default, (str, bool, int)) or isinstance(key.type, Duration):
        return {}
    return {"default": key.default}


def _names(type: MapOf) -> dict[str, Any]:
    return {"pattern": f"^({type.key.pattern})$"} if type.key.pattern else {}


def _scalar(type: Text | Integer | Boolean | Number | Duration | DataRate | Scalar) -> dict[str, Any]:
    if isinstance(type, Integer):
        return {"type": "integer", "minimum": type.minimum, "maximum": type.maximum}
    if isinstance(type, Boolean):
        return {"type": "boolean"}
    if isinstance(type, Scalar):
        return {"type": ["string", "number", "boolean"]}
    if isinstance(type, Number):
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": _POWER_OF_TEN}]}
    schema: dict[str, Any] = {"type": "string"}
    if isinstance(type, Text) and type.choices:
        return {**schema, "enum": list(type.choices)}
    return {**schema, "pattern": f"^({type.pattern})$"} if type.pattern else {**schema, "minLength": 1}
