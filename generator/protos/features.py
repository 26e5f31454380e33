"""Features of protobuf's editions that change the encoding: field presence and message encoding.

A file, message or oneof passes its features on to what it declares; each declaration may override them. The defaults
come from descriptor.proto (`FeatureSet`, `edition_defaults`). Proto2 and proto3 are editions with other defaults.
"""

from __future__ import annotations

from collections.abc import Mapping

from google.protobuf.descriptor_pb2 import Edition, FeatureSet, FieldDescriptorProto, FileDescriptorProto

from roverlink.generator.protos.schema import Syntax

Features = Mapping[str, str]
"""The value of each feature of an edition, by the feature's name."""

_EDITIONS: Features = {"field_presence": "EXPLICIT", "message_encoding": "LENGTH_PREFIXED"}
_PROTO3: Features = {**_EDITIONS, "field_presence": "IMPLICIT"}
_LABELS = {
    FieldDescriptorProto.LABEL_REPEATED: "repeated",
    FieldDescriptorProto.LABEL_REQUIRED: "required",
}
_LABEL_OF_PRESENCE = {"EXPLICIT": "optional", "LEGACY_REQUIRED": "required"}


def features_of_file(file: FileDescriptorProto) -> Features:
    """Return the features that a file passes on to its messages and enums, including the defaults of its edition."""
    return overridden(_PROTO3 if file.syntax == "proto3" else _EDITIONS, file.options.features)


def syntax_of_file(file: FileDescriptorProto) -> Syntax:
    """Return the syntax that a file declares. The result for an edition contains the features that the file sets."""
    if file.syntax != "editions":
        return Syntax(file.syntax or "proto2")
    features = features_of_file(file)
    year = Edition.Name(file.edition).removeprefix("EDITION_")
    return Syntax(year, features["field_presence"], features["message_encoding"])


def overridden(inherited: Features, own: FeatureSet) -> Features:
    """Return the features of a declaration: the inherited features, overridden by the features that it sets itself."""
    # Unset features are not in ListFields: protoc writes into the options only what the file sets itself.
    given = {
        field.name: field.enum_type.values_by_number[value].name for field, value in own.ListFields() if field.enum_type
    }
    return {**inherited, **given} if given else inherited


def label_of(field: FieldDescriptorProto, features: Features) -> str:
    """Return the label of a field: ``repeated``, ``required``, ``optional`` (absent differs from zero), or empty."""
    # Only proto2 uses LABEL_REQUIRED. In an edition, such a field has the feature LEGACY_REQUIRED instead.
    if label := _LABELS.get(field.label):
        return label
    always = field.proto3_optional or field.HasField("oneof_index")
    if always or field.type in (FieldDescriptorProto.TYPE_MESSAGE, FieldDescriptorProto.TYPE_GROUP):
        return _LABEL_OF_PRESENCE.get(features["field_presence"], "optional")
    return _LABEL_OF_PRESENCE.get(features["field_presence"], "")
