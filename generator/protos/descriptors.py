"""Conversion of protoc's descriptors to a `Schema`, roverlink's own classes for messages, fields and enums."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    Edition,
    EnumDescriptorProto,
    EnumValueDescriptorProto,
    FeatureSet,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from roverlink.generator.diagnostics import Span
from roverlink.generator.protos.schema import (
    ProtoEnum,
    ProtoEnumValue,
    ProtoExtension,
    ProtoField,
    ProtoMessage,
    Schema,
    Syntax,
)
from roverlink.generator.protos.source_locations import Path, Places

_SCALARS = {number: name.removeprefix("TYPE_").lower() for name, number in FieldDescriptorProto.Type.items()}

# Field numbers in descriptor.proto. A path of a SourceCodeInfo.Location is made of them, and of indices.
_FILE_MESSAGE, _FILE_ENUM, _FILE_EXTENSION = 4, 5, 7
_MESSAGE_FIELD, _MESSAGE_NESTED, _MESSAGE_ENUM, _MESSAGE_EXTENSION = 2, 3, 4, 6
_ENUM_VALUE = 2


def schema_of(compiled: FileDescriptorSet, shown_root: str) -> Schema:
    """Return the schema for protoc's descriptor set.

    ``shown_root`` is the folder of the .proto files, as diagnostics print it.
    """
    readers = [_FileReader(file, shown_root) for file in compiled.file]
    return Schema(
        files=tuple(file.name for file in compiled.file),
        messages={message.full_name: message for reader in readers for message in reader.messages},
        enums={enum.full_name: enum for reader in readers for enum in reader.enums},
        extensions=tuple(extension for reader in readers for extension in reader.extensions),
        file_options={file.name: file.options.SerializeToString() for file in compiled.file},
        packages={file.name: file.package for file in compiled.file},
        syntaxes={file.name: syntax_of_file(file) for file in compiled.file},
        descriptors=compiled,
    )


class _FileReader:
    """Converter of the descriptors of one .proto file to messages and enums, with their places and comments."""

    def __init__(self, file: FileDescriptorProto, shown_root: str) -> None:
        self._file = file
        self._places = Places(file, shown_root)
        self.messages: list[ProtoMessage] = []
        self.enums: list[ProtoEnum] = []
        self.extensions: list[ProtoExtension] = []
        features, prefix = features_of_file(file), f"{file.package}." if file.package else ""
        for index, message in enumerate(file.message_type):
            self._message(message, prefix, (_FILE_MESSAGE, index), features)
        for index, enum in enumerate(file.enum_type):
            self._enum(enum, prefix, (_FILE_ENUM, index))
        self._extensions(file.extension, "", (_FILE_EXTENSION,), features)

    def _message(
        self, message: DescriptorProto, prefix: str, path: Path, inherited: Features, place: Span | None = None
    ) -> None:
        """Convert a message and all types inside it, and add them to the lists of the reader.

        ``prefix`` stands before the message's name (``rover.Arm.``), and ``path`` is its path in protobuf's
        `SourceCodeInfo`. ``place`` is set only for the entry message of a map: it is the place of the map field.
        """
        full_name, features = prefix + message.name, overridden(inherited, message.options.features)
        declared = self._itself(message, full_name, path, features, place)
        self.messages.append(declared)
        # A map is sugar for a nested message `XxxEntry` with key and value, and a repeated field of it
        # (descriptor.proto, `map_entry`). Diagnostics about the entry have to point to the map that the user wrote.
        maps = {field.type_name: field.at("type_name") for field in declared.fields}
        for index, nested in enumerate(message.nested_type):
            of_map = maps.get(f"{full_name}.{nested.name}") if nested.options.map_entry else None
            self._message(nested, f"{full_name}.", (*path, _MESSAGE_NESTED, index), features, of_map)
        for index, enum in enumerate(message.enum_type):
            self._enum(enum, f"{full_name}.", (*path, _MESSAGE_ENUM, index))
        self._extensions(message.extension, full_name, (*path, _MESSAGE_EXTENSION), features)

    def _itself(
        self, message: DescriptorProto, full_name: str, path: Path, features: Features, place: Span | None
    ) -> ProtoMessage:
        """Return a message with its fields, but without the types that are declared inside it."""
        real_oneofs = {field.oneof_index for field in message.field if _in_oneof(field)}
        return ProtoMessage(
            span=place or self._places.span(path),
            places=self._places.of_message(path, message),
            comment=self._places.comment(path),
            options=message.options.SerializeToString(),
            full_name=full_name,
            file=self._file.name,
            fields=tuple(
                self._field(field, message, (*path, _MESSAGE_FIELD, index), features, place)
                for index, field in enumerate(message.field)
            ),
            oneofs=tuple(oneof.name for index, oneof in enumerate(message.oneof_decl) if index in real_oneofs),
            map_entry=message.options.map_entry,
            # Ranges of messages exclude their end, those of enums include it (descriptor.proto).
            extension_ranges=tuple((range.start, range.end - 1) for range in message.extension_range),
            reserved=tuple((range.start, range.end - 1) for range in message.reserved_range),
            reserved_names=tuple(message.reserved_name),
            facets=_facets(message_set_wire_format=message.options.message_set_wire_format),
        )

    def _extensions(self, fields: Iterable[FieldDescriptorProto], scope: str, path: Path, inherited: Features) -> None:
        for index, field in enumerate(fields):
            declared = self._field(field, DescriptorProto(), (*path, index), inherited)
            # protoc resolves every name to a full one, and marks it with a leading dot (descriptor.proto, `type_name`).
            extendee = field.extendee.removeprefix(".")
            self.extensions.append(ProtoExtension(extendee, scope, declared, self._file.name))

    def _field(
        self,
        field: FieldDescriptorProto,
        message: DescriptorProto,
        path: Path,
        inherited: Features,
        place: Span | None = None,
    ) -> ProtoField:
        if _in_oneof(field):
            inherited = overridden(inherited, message.oneof_decl[field.oneof_index].options.features)
        features = overridden(inherited, field.options.features)
        return ProtoField(
            span=place or self._places.span(path),
            places=self._places.of_field(path),
            comment=self._places.comment(path),
            options=field.options.SerializeToString(),
            number=field.number,
            name=field.name,
            type=_SCALARS[field.type],
            type_name=field.type_name.removeprefix("."),
            label=label_of(field, features),
            declared_optional=field.proto3_optional,
            oneof=message.oneof_decl[field.oneof_index].name if _in_oneof(field) else "",
            json_name=field.json_name,
            facets=_facets_of_field(field, message, features),
        )

    def _enum(self, enum: EnumDescriptorProto, prefix: str, path: Path) -> None:
        reserved = tuple(
            (range.start, range.end) for range in enum.reserved_range
        )  # EnumReservedRange includes its end; ReservedRange of messages does not
        self.enums.append(
            ProtoEnum(
                span=self._places.span(path),
                places=self._places.of_enum(path, enum),
                comment=self._places.comment(path),
                options=enum.options.SerializeToString(),
                full_name=prefix + enum.name,
                file=self._file.name,
                values=tuple(self._value(value, (*path, _ENUM_VALUE, index)) for index, value in enumerate(enum.value)),
                reserved=reserved,
                reserved_names=tuple(enum.reserved_name),
            )
        )

    def _value(self, value: EnumValueDescriptorProto, path: Path) -> ProtoEnumValue:
        return ProtoEnumValue(
            span=self._places.span(path),
            places=self._places.of_value(path),
            comment=self._places.comment(path),
            options=value.options.SerializeToString(),
            name=value.name,
            number=value.number,
        )


def _in_oneof(field: FieldDescriptorProto) -> bool:
    """Return True if the field is in a oneof that the .proto file declares.

    protoc makes a synthetic oneof for each `optional` field of proto3 (descriptor.proto, `proto3_optional`).
    """
    return field.HasField("oneof_index") and not field.proto3_optional


def _facets_of_field(field: FieldDescriptorProto, message: DescriptorProto, features: Features) -> dict[str, str]:
    return _facets(
        default=field.default_value,
        delimited=features["message_encoding"] == "DELIMITED" and _may_be_delimited(field, message),
    )


def _may_be_delimited(field: FieldDescriptorProto, message: DescriptorProto) -> bool:
    """Return True if the edition's feature `message_encoding` applies to a field, so that it may be encoded as a group.

    The feature applies to message fields, but not to maps and the fields of their entries.
    """
    of_map = any(
        nested.options.map_entry and field.type_name.endswith(f".{message.name}.{nested.name}")
        for nested in message.nested_type
    )
    return field.type == FieldDescriptorProto.TYPE_MESSAGE and not of_map and not message.options.map_entry


def _facets(**given: str | bool) -> dict[str, str]:
    """Return the settings that are not empty or False, each as text: True becomes ``"true"``."""
    return {name: "true" if value is True else str(value) for name, value in given.items() if value}


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
