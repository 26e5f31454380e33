"""What .proto files say once protoc has read them: messages, fields and enums, with their comments and places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool

from generator.findings import Span

_SCALARS = {number: name.removeprefix("TYPE_").lower() for name, number in FieldDescriptorProto.Type.items()}


@dataclass(frozen=True, slots=True)
class ProtoField:
    """A field of a message, or of a oneof in it."""

    number: int
    name: str
    type: str
    """The scalar's name; or ``message``, ``enum``, ``group``."""
    type_name: str
    """Full name of the message or enum; empty for a scalar."""
    repeated: bool
    optional: bool
    """Whether it tells *absent* from *zero*; of a message field, only where it was declared ``optional``."""
    oneof: str
    """The oneof it stands in; empty for none."""
    comment: str
    span: Span

    @property
    def wire_type(self) -> str:
        """The type as a .proto file spells it."""
        return self.type_name or self.type


@dataclass(frozen=True, slots=True)
class ProtoMessage:
    """A message type."""

    full_name: str
    file: str
    fields: tuple[ProtoField, ...]
    comment: str
    span: Span
    map_entry: bool
    extendable: bool
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers that are reserved, both ends included."""
    reserved_names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ProtoEnumValue:
    """A declared value of an enum."""

    name: str
    number: int
    comment: str


@dataclass(frozen=True, slots=True)
class ProtoEnum:
    """An enum type."""

    full_name: str
    file: str
    values: tuple[ProtoEnumValue, ...]
    comment: str
    span: Span


@dataclass(frozen=True, slots=True)
class Schema:
    """What protoc made of the files that the table needs."""

    files: tuple[str, ...]
    """The closure, in the order in which protoc wants it."""
    messages: Mapping[str, ProtoMessage]
    enums: Mapping[str, ProtoEnum]


# --- from descriptors ---------------------------------------------------------------------------------------------

_Comments = Mapping[tuple[int, ...], tuple[str, int, int]]

# Field numbers in descriptor.proto, of which the paths in source_code_info are made.
_FILE_MESSAGE, _FILE_ENUM = 4, 5
_MESSAGE_FIELD, _MESSAGE_NESTED, _MESSAGE_ENUM = 2, 3, 4
_ENUM_VALUE = 2


def schema_of(compiled: FileDescriptorSet, shown_root: str) -> Schema:
    """The schema in a descriptor set; ``shown_root`` is how findings call the folder of its files."""
    messages: dict[str, ProtoMessage] = {}
    enums: dict[str, ProtoEnum] = {}
    pool = DescriptorPool()
    for file in compiled.file:
        pool.Add(file)
        reader = _FileReader(file, pool, shown_root)
        prefix = f"{file.package}." if file.package else ""
        for index, message in enumerate(file.message_type):
            reader.message(message, prefix, (_FILE_MESSAGE, index), messages, enums)
        for index, enum in enumerate(file.enum_type):
            reader.enum(enum, prefix, (_FILE_ENUM, index), enums)
    return Schema(tuple(file.name for file in compiled.file), messages, enums)


class _FileReader:
    """Reads one file's descriptors, with the comments and places that protoc kept for them."""

    def __init__(self, file: FileDescriptorProto, pool: DescriptorPool, shown_root: str) -> None:
        self._file, self._pool = file, pool
        self._shown = f"{shown_root}/{file.name}"
        self._places: _Comments = {
            tuple(location.path): (
                _clean(location.leading_comments) or _clean(location.trailing_comments),
                location.span[0] + 1,
                location.span[1] + 1,
            )
            for location in file.source_code_info.location
        }

    def _at(self, path: tuple[int, ...]) -> tuple[str, Span]:
        comment, line, column = self._places.get(path, ("", 0, 0))
        return comment, Span(self._shown, line, column)

    def message(
        self,
        message: DescriptorProto,
        prefix: str,
        path: tuple[int, ...],
        messages: dict[str, ProtoMessage],
        enums: dict[str, ProtoEnum],
    ) -> None:
        full_name = prefix + message.name
        comment, span = self._at(path)
        messages[full_name] = ProtoMessage(
            full_name,
            self._file.name,
            tuple(
                self._field(full_name, message, field, (*path, _MESSAGE_FIELD, index))
                for index, field in enumerate(message.field)
            ),
            comment,
            span,
            message.options.map_entry,
            bool(message.extension_range),
            tuple((reserved.start, reserved.end - 1) for reserved in message.reserved_range),
            tuple(message.reserved_name),
        )
        for index, nested in enumerate(message.nested_type):
            self.message(nested, f"{full_name}.", (*path, _MESSAGE_NESTED, index), messages, enums)
        for index, enum in enumerate(message.enum_type):
            self.enum(enum, f"{full_name}.", (*path, _MESSAGE_ENUM, index), enums)

    def _field(
        self, full_name: str, message: DescriptorProto, field: FieldDescriptorProto, path: tuple[int, ...]
    ) -> ProtoField:
        comment, span = self._at(path)
        named = field.type_name.removeprefix(".")
        kind = _SCALARS[field.type]
        named_message = kind in ("message", "group")
        required = field.label == FieldDescriptorProto.LABEL_REQUIRED
        presence = self._pool.FindFieldByName(f"{full_name}.{field.name}").has_presence and not required
        in_oneof = field.HasField("oneof_index") and not field.proto3_optional
        return ProtoField(
            number=field.number,
            name=field.name,
            type=kind,
            type_name=named,
            repeated=field.label == FieldDescriptorProto.LABEL_REPEATED,
            optional=field.proto3_optional or (presence and not named_message and not in_oneof),
            oneof=message.oneof_decl[field.oneof_index].name if in_oneof else "",
            comment=comment,
            span=span,
        )

    def enum(self, enum: EnumDescriptorProto, prefix: str, path: tuple[int, ...], enums: dict[str, ProtoEnum]) -> None:
        comment, span = self._at(path)
        values = tuple(
            ProtoEnumValue(value.name, value.number, self._at((*path, _ENUM_VALUE, index))[0])
            for index, value in enumerate(enum.value)
        )
        enums[prefix + enum.name] = ProtoEnum(prefix + enum.name, self._file.name, values, comment, span)


def _clean(comment: str) -> str:
    """A comment's text without the space after its slashes and without empty lines at its ends."""
    lines = [line.removeprefix(" ").rstrip() for line in comment.splitlines()]
    return "\n".join(lines).strip("\n")
