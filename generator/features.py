"""Features of protobuf's editions: what a file, message, field or enum does unless it says otherwise.

The defaults of proto2, proto3 and the editions are those of descriptor.proto (`FeatureSet`, `edition_defaults`); proto2
and proto3 behave as editions with other defaults. Of the features that belong to one language, those are here that
change how strings are held or checked; their names here are `cpp_string_type` and `java_utf8_validation`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from google.protobuf.descriptor_pb2 import Edition, FeatureSet, FieldDescriptorProto, FileDescriptorProto
from google.protobuf.empty_pb2 import Empty
from google.protobuf.unknown_fields import UnknownFieldSet

from generator.protos import Syntax

Features = Mapping[str, str]
"""The value of each feature, by its name."""

_EDITIONS: Features = {
    "field_presence": "EXPLICIT",
    "enum_type": "OPEN",
    "repeated_field_encoding": "PACKED",
    "utf8_validation": "VERIFY",
    "message_encoding": "LENGTH_PREFIXED",
    "json_format": "ALLOW",
    "cpp_string_type": "STRING",
    "java_utf8_validation": "DEFAULT",
}
_EDITION_2024: Features = {**_EDITIONS, "cpp_string_type": "VIEW"}
_PROTO3: Features = {**_EDITIONS, "field_presence": "IMPLICIT"}
_PROTO2: Features = {
    **_EDITIONS,
    "enum_type": "CLOSED",
    "repeated_field_encoding": "EXPANDED",
    "utf8_validation": "NONE",
    "json_format": "LEGACY_BEST_EFFORT",
}
_OF_LANGUAGES = {
    1000: ("cpp_string_type", 2, {1: "VIEW", 2: "CORD", 3: "STRING"}),  # google/protobuf/cpp_features.proto
    1001: ("java_utf8_validation", 2, {1: "DEFAULT", 2: "VERIFY"}),  # google/protobuf/java_features.proto
}
_LABELS = {
    FieldDescriptorProto.LABEL_REPEATED: "repeated",
    FieldDescriptorProto.LABEL_REQUIRED: "required",
}
_LABEL_OF_PRESENCE = {"EXPLICIT": "optional", "LEGACY_REQUIRED": "required"}


def features_of_file(file: FileDescriptorProto) -> Features:
    """What holds in a file."""
    editions = _EDITION_2024 if file.edition >= Edition.EDITION_2024 else _EDITIONS
    syntax = {"proto3": _PROTO3, "editions": editions}.get(file.syntax, _PROTO2)
    if file.options.java_string_check_utf8:
        syntax = {**syntax, "java_utf8_validation": "VERIFY"}
    return overridden(syntax, file.options.features)


def syntax_of_file(file: FileDescriptorProto) -> Syntax:
    """How a file is written."""
    if file.syntax != "editions":
        return Syntax(file.syntax or "proto2")
    features = features_of_file(file)
    year = Edition.Name(file.edition).removeprefix("EDITION_")
    return Syntax(year, features["field_presence"], features["message_encoding"])


def overridden(inherited: Features, own: FeatureSet) -> Features:
    """What holds where something sets features of its own."""
    given = {
        field.name: field.enum_type.values_by_number[value].name for field, value in own.ListFields() if field.enum_type
    }
    given |= _of_languages(own)
    return {**inherited, **given} if given else inherited


def _of_languages(own: FeatureSet) -> dict[str, str]:
    """Those that descriptor.proto itself does not know; they are extensions."""
    given: dict[str, str] = {}
    if not own.ByteSize():
        return given
    for number, extension in _fields(own.SerializeToString()):
        if number in _OF_LANGUAGES:
            name, wanted, values = _OF_LANGUAGES[number]
            value = dict(_fields(extension)).get(wanted)
            given |= {name: values[value]} if value in values else {}
    return given


def _fields(message: bytes) -> Iterator[tuple[int, Any]]:
    """The numbers and the values in a message of whatever type."""
    fields = UnknownFieldSet(Empty.FromString(message))
    for index in range(len(fields)):
        yield fields[index].field_number, fields[index].data


def label_of(field: FieldDescriptorProto, features: Features) -> str:
    """``repeated``, ``required``, ``optional`` where absence can be told from zero, or nothing."""
    if label := _LABELS.get(field.label):
        return label
    always = field.proto3_optional or field.HasField("oneof_index")
    if always or field.type in (FieldDescriptorProto.TYPE_MESSAGE, FieldDescriptorProto.TYPE_GROUP):
        return _LABEL_OF_PRESENCE.get(features["field_presence"], "optional")
    return _LABEL_OF_PRESENCE.get(features["field_presence"], "")
