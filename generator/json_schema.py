"""The JSON Schema of mapping.yaml, from its format."""

from __future__ import annotations

from typing import Any

from generator.feed_format import DEFINITIONS
from generator.table_format import TABLE
from generator.value_types import (
    AnyOf,
    Boolean,
    Duration,
    Integer,
    ListOf,
    MapOf,
    Named,
    Network,
    Number,
    Object,
    Scalar,
    Text,
    Type,
)

_POWER_OF_TEN = r"^[-+]?[0-9]+[eE][-+]?[0-9]+$"
"""A number such as 1e-7, which YAML 1.1 reads as a text."""


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of mapping.yaml."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "roverlink mapping.yaml",
        **_schema_of(TABLE),
        "$defs": {name: _forms_schema(type) for name, type in DEFINITIONS.items()},
    }


def _schema_of(type: Type) -> dict[str, Any]:
    for name, definition in DEFINITIONS.items():
        if type is definition or type == Named(name):
            return {"$ref": f"#/$defs/{name}"}
    if isinstance(type, Integer):
        return {"type": "integer", "minimum": type.minimum, "maximum": type.maximum}
    if isinstance(type, Boolean):
        return {"type": "boolean"}
    if isinstance(type, Scalar):
        return {"type": ["string", "number", "boolean"]}
    if isinstance(type, (Duration, Network)):
        return {"type": "string", "pattern": f"^({type.pattern})$"}
    if isinstance(type, Number):
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": _POWER_OF_TEN}]}
    if isinstance(type, ListOf):
        return _list_schema(type)
    if isinstance(type, MapOf):
        return {"type": "object", "propertyNames": _names_schema(type), "additionalProperties": _schema_of(type.value)}
    if isinstance(type, Object):
        return _object_schema(type)
    if isinstance(type, AnyOf):
        return _forms_schema(type)
    return _text_schema(type) if isinstance(type, Text) else _schema_of(DEFINITIONS[type.name])


def _forms_schema(type: AnyOf) -> dict[str, Any]:
    return {"anyOf": [_schema_of(form) for form in type.forms]}


def _names_schema(type: MapOf) -> dict[str, Any]:
    return {"pattern": f"^({type.key.pattern})$"} if type.key.pattern else {}


def _list_schema(type: ListOf) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": "array", "items": _schema_of(type.item)}
    if type.least:
        schema["minItems"] = type.least
    if isinstance(type.item, (Text, Network)) and type.unique:
        schema["uniqueItems"] = True
    return schema


def _text_schema(type: Text) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": "string"} if type.choices or type.pattern else {"type": "string", "minLength": 1}
    if type.choices:
        schema["enum"] = list(type.choices)
    if type.pattern:
        schema["pattern"] = f"^({type.pattern})$"
    return schema


def _object_schema(type: Object) -> dict[str, Any]:
    schema: dict[str, Any] = {
        "type": "object",
        "additionalProperties": _schema_of(type.others.value) if type.others else False,
        "required": [name for name, key in type.keys.items() if key.required],
        "properties": {name: {"description": key.meaning, **_schema_of(key.type)} for name, key in type.keys.items()},
    }
    if type.others:
        schema["propertyNames"] = _names_schema(type.others)
    return schema
