"""Features of protobuf's editions that change bytes: what the fields of a file or message do unless they say otherwise.

The defaults of proto2, proto3 and the editions are those of descriptor.proto (`FeatureSet`, `edition_defaults`); proto2
and proto3 behave as editions with other defaults.
"""

from __future__ import annotations

from collections.abc import Mapping

from google.protobuf.descriptor_pb2 import Edition, FeatureSet, FieldDescriptorProto, FileDescriptorProto

from roverlink.generator.protos.schema import Syntax

Features = Mapping[str, str]
"""The value of each feature, by its name."""

_EDITIONS: Features = {"field_presence": "EXPLICIT", "message_encoding": "LENGTH_PREFIXED"}
_PROTO3: Features = {**_EDITIONS, "field_presence": "IMPLICIT"}
_LABELS = {
    FieldDescriptorProto.LABEL_REPEATED: "repeated",
    FieldDescriptorProto.LABEL_REQUIRED: "required",
}
_LABEL_OF_PRESENCE = {"EXPLICIT": "optional", "LEGACY_REQUIRED": "required"}


def features_of_file(file: FileDescriptorProto) -> Features:
    """What holds in a file."""
    return overridden(_PROTO3 if file.syntax == "proto3" else _EDITIONS, file.options.features)


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
    return {**inherited, **given} if given else inherited


def label_of(field: FieldDescriptorProto, features: Features) -> str:
    """``repeated``, ``required``, ``optional`` where absence can be told from zero, or nothing."""
    if label := _LABELS.get(field.label):
        return label
    always = field.proto3_optional or field.HasField("oneof_index")
    if always or field.type in (FieldDescriptorProto.TYPE_MESSAGE, FieldDescriptorProto.TYPE_GROUP):
        return _LABEL_OF_PRESENCE.get(features["field_presence"], "optional")
    return _LABEL_OF_PRESENCE.get(features["field_presence"], "")
