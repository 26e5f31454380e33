"""Target `jsonschema`: a JSON Schema of each payload, in protobuf's JSON format with the names of the .proto file.

`roverlink listen` prints this format, which is defined in https://protobuf.dev/programming-guides/json. The JSON Schema
of mapping.yaml comes from another module: `roverlink.generator.emit.mapping_json_schema`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from roverlink.generator import ir
from roverlink.generator.emit.render import REGENERATE, Files

Schema = dict[str, Any]

_WORDS = ("NaN", "Infinity", "-Infinity")
_DECIMAL = {"int64": r"^-?[0-9]+$", "uint64": r"^[0-9]+$"}
_SCALARS: Mapping[str, Schema] = {
    "bool": {"type": "boolean"},
    "string": {"type": "string"},
    "bytes": {"type": "string", "contentEncoding": "base64"},
    "float": {"anyOf": [{"type": "number"}, {"enum": [*_WORDS]}]},
    "int32": {"type": "integer", "minimum": -(2**31), "maximum": 2**31 - 1},
    "uint32": {"type": "integer", "minimum": 0, "maximum": 2**32 - 1},
    # Protobuf writes 64-bit integers as strings, because many JSON readers keep numbers as doubles.
    "int64": {"anyOf": [{"type": "string", "pattern": _DECIMAL["int64"]}, {"type": "integer"}]},
    "uint64": {"anyOf": [{"type": "string", "pattern": _DECIMAL["uint64"]}, {"type": "integer", "minimum": 0}]},
}
_SPELLINGS = {
    "double": "float",
    "sint32": "int32",
    "sfixed32": "int32",
    "fixed32": "uint32",
    "sint64": "int64",
    "sfixed64": "int64",
    "fixed64": "uint64",
}
_WELL_KNOWN: Mapping[str, Schema] = {
    "google.protobuf.Any": {"type": "object", "required": ["@type"]},
    "google.protobuf.Duration": {"type": "string", "pattern": r"^-?[0-9]+(\.[0-9]{1,9})?s$"},
    "google.protobuf.FieldMask": {"type": "string"},
    "google.protobuf.ListValue": {"type": "array"},
    "google.protobuf.Struct": {"type": "object"},
    "google.protobuf.Timestamp": {"type": "string", "format": "date-time"},
    "google.protobuf.Value": {},
    "google.protobuf.BoolValue": _SCALARS["bool"],
    "google.protobuf.BytesValue": _SCALARS["bytes"],
    "google.protobuf.DoubleValue": _SCALARS["float"],
    "google.protobuf.FloatValue": _SCALARS["float"],
    "google.protobuf.Int32Value": _SCALARS["int32"],
    "google.protobuf.Int64Value": _SCALARS["int64"],
    "google.protobuf.StringValue": _SCALARS["string"],
    "google.protobuf.UInt32Value": _SCALARS["uint32"],
    "google.protobuf.UInt64Value": _SCALARS["uint64"],
}


def emit(bridge: ir.Bridge) -> Files:
    """Yield a JSON Schema file for each row. The file contains the schemas of all types that the payload uses."""
    schemas = _Schemas(bridge)
    for route in bridge.routes:
        proto = route.proto
        schema = {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "$comment": REGENERATE,
            "title": f"{route.name} ({route.number}): {proto}",
            "$ref": f"#/$defs/{proto}",
            "$defs": {name: schemas.of(name) for name in sorted(schemas.reached(proto))},
        }
        yield f"generated/jsonschema/{route.name}.json", f"{json.dumps(schema, indent=2, ensure_ascii=False)}\n"


class _Schemas:
    """JSON Schemas of the messages and enums that a bridge can send or receive, by full name."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self._messages = {message.name: message for message in bridge.wire_messages}
        self._enums = {enum.name: enum for enum in bridge.wire_enums}
        self._comments = {
            (conversion.proto, field.proto_path[0]): field.ros.comment
            for conversion in bridge.conversions().values()
            for field in conversion.fields
            if len(field.proto_path) == 1
        }

    def reached(self, name: str) -> set[str]:
        """Return the full names of a message and of all messages and enums inside it, at any depth."""
        reached: set[str] = set()
        waiting = [name]
        while waiting:
            one = waiting.pop()
            if one not in reached and one not in _WELL_KNOWN:
                reached.add(one)
                waiting += [field.type for field in self._fields(one) if _scalar(field.type) is None]
        return {name for name in reached if not self._is_map_entry(name)}

    def _fields(self, name: str) -> tuple[ir.WireField, ...]:
        return self._messages[name].fields if name in self._messages else ()

    def _is_map_entry(self, name: str) -> bool:
        return name in self._messages and self._messages[name].map_entry

    def of(self, name: str) -> Schema:
        """Return the JSON Schema of a message or an enum, by its full name."""
        if name in self._enums:
            names = list(dict.fromkeys(value.name for value in self._enums[name].values))
            return {"anyOf": [{"enum": names}, _SCALARS["int32"]]}
        message = self._messages[name]
        schema: Schema = {
            "type": "object",
            "additionalProperties": False,
            "properties": {field.name: self._property(name, field) for field in message.fields},
        }
        if exclusive := [_at_most_one(members) for members in _oneofs(message)]:
            schema["allOf"] = exclusive
        return schema

    def _property(self, message: str, field: ir.WireField) -> Schema:
        described: Schema = {}
        if comment := self._comments.get((message, field.name)):
            described["description"] = " ".join(comment.split())
        return {**described, **self._value(field)}

    def _value(self, field: ir.WireField) -> Schema:
        if self._is_map_entry(field.type):
            key, value = self._fields(field.type)
            return {"type": "object", "additionalProperties": self._one(value.type), **_keys(key.type)}
        one = self._one(field.type)
        return {"type": "array", "items": one} if field.label == "repeated" else one

    def _one(self, type: str) -> Schema:
        if type in _WELL_KNOWN:
            return dict(_WELL_KNOWN[type])
        return dict(_scalar(type) or {"$ref": f"#/$defs/{type}"})


def _scalar(type: str) -> Schema | None:
    return _SCALARS.get(_SPELLINGS.get(type, type))


def _keys(type: str) -> Schema:
    """Return the part of a map's JSON Schema that restricts the keys. In JSON, all keys are strings."""
    if type == "string":
        return {}
    return {"propertyNames": {"pattern": "^(true|false)$" if type == "bool" else r"^-?[0-9]+$"}}


def _oneofs(message: ir.WireMessage) -> Iterator[list[str]]:
    members: dict[str, list[str]] = {}
    for field in message.fields:
        if field.oneof:
            members.setdefault(field.oneof, []).append(field.name)
    yield from (names for names in members.values() if len(names) > 1)


def _at_most_one(names: list[str]) -> Schema:
    """Return a JSON Schema that allows at most one of the oneof's members ``names``."""
    given = [{"required": [name]} for name in names]
    return {"oneOf": [*given, {"not": {"anyOf": given}}]}
