"""protoc's view of a file in the words of `generator.declarations`, so that the two can be compared."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from pathlib import Path

import grpc_tools
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    Edition,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from grpc_tools import protoc

from generator.declarations import Enum, EnumValue, Extend, Field, File, Import, Message, resolve_type

WELL_KNOWN = Path(grpc_tools.__file__).parent / "_proto"
_TYPES = {number: name.removeprefix("TYPE_").lower() for name, number in FieldDescriptorProto.Type.items()}
_LABELS = {FieldDescriptorProto.LABEL_REPEATED: "repeated", FieldDescriptorProto.LABEL_REQUIRED: "required"}


def compiled(root: Path, name: str) -> list[FileDescriptorProto]:
    """Descriptors of what a file imports, and of itself as the last; none if protoc refuses it."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "set")
        flags = ["--include_imports", "--include_source_info", "--experimental_editions", f"--descriptor_set_out={out}"]
        silenced, kept = os.open(os.devnull, os.O_WRONLY), os.dup(2)
        os.dup2(silenced, 2)
        try:
            code = protoc.main(["protoc", f"-I{root}", f"-I{WELL_KNOWN}", *flags, name])
        finally:
            os.dup2(kept, 2)
            os.close(silenced)
            os.close(kept)
        return list(FileDescriptorSet.FromString(out.read_bytes()).file) if code == 0 else []


# --- protoc's ---------------------------------------------------------------------------------------------------


class Theirs:
    """A file as protoc describes it."""

    def __init__(self, file: FileDescriptorProto) -> None:
        self._file = file
        self._places = {tuple(location.path): location for location in file.source_code_info.location}

    def file(self) -> File:
        """All of it."""
        file = self._file
        extends = [
            Extend(field.extendee[1:], file.package, (self._field((7, index), field, None),), 0, 0)
            for index, field in enumerate(file.extension)
        ]
        messages = tuple(self._message((4, index), file.package, item) for index, item in enumerate(file.message_type))
        for index, message in enumerate(file.message_type):
            extends += self._extends((4, index), file.package, message)
        kinds = dict.fromkeys(file.public_dependency, "public") | dict.fromkeys(file.weak_dependency, "weak")
        editions = {"editions": Edition.Name(file.edition).removeprefix("EDITION_")}
        return File(
            syntax=editions.get(file.syntax, file.syntax or "proto2"),
            package=file.package,
            imports=tuple(
                Import(path, kinds.get(index, ""), *self._at((3, index))[1:3])
                for index, path in enumerate(file.dependency)
            ),
            messages=messages,
            enums=tuple(self._enum((5, index), file.package, item) for index, item in enumerate(file.enum_type)),
            extends=tuple(extends),
            problems=(),
        )

    def _at(self, path: tuple[int, ...]) -> tuple[str, int, int, int]:
        location = self._places[path]
        comment = _clean(location.leading_comments) or _clean(location.trailing_comments)
        line, column, *end = location.span
        return comment, line + 1, column + 1, (end[0] if len(end) == 2 else line) + 1

    def _extends(self, path: tuple[int, ...], scope: str, message: DescriptorProto) -> list[Extend]:
        name = f"{scope}.{message.name}" if scope else message.name
        extends = [
            Extend(field.extendee[1:], name, (self._field((*path, 6, index), field, None),), 0, 0)
            for index, field in enumerate(message.extension)
        ]
        for index, nested in enumerate(message.nested_type):
            extends += self._extends((*path, 3, index), name, nested)
        return extends

    def _message(self, path: tuple[int, ...], scope: str, message: DescriptorProto) -> Message:
        name = f"{scope}.{message.name}" if scope else message.name
        comment, line, column, end_line = self._at(path)
        synthetic = {field.oneof_index for field in message.field if field.proto3_optional}
        return Message(
            name=message.name,
            full_name=name,
            fields=tuple(self._field((*path, 2, index), item, message) for index, item in enumerate(message.field)),
            oneofs=tuple(oneof.name for index, oneof in enumerate(message.oneof_decl) if index not in synthetic),
            messages=tuple(
                self._message((*path, 3, index), name, item)
                for index, item in enumerate(message.nested_type)
                if not item.options.map_entry
            ),
            enums=tuple(self._enum((*path, 4, index), name, item) for index, item in enumerate(message.enum_type)),
            reserved=tuple((item.start, item.end - 1) for item in message.reserved_range),
            reserved_names=tuple(message.reserved_name),
            extension_ranges=tuple((item.start, item.end - 1) for item in message.extension_range),
            options={},
            comment=comment,
            claims=(),
            line=line,
            column=column,
            end_line=end_line,
        )

    def _field(self, path: tuple[int, ...], field: FieldDescriptorProto, message: DescriptorProto | None) -> Field:
        entries = {entry.name: entry for entry in message.nested_type if entry.options.map_entry} if message else {}
        entry = entries.get(field.type_name.rpartition(".")[2])
        key, value = (_type_of(item) for item in entry.field) if entry else ("", "")
        in_oneof = field.HasField("oneof_index") and not field.proto3_optional
        label = "" if entry else _LABELS.get(field.label, "")
        if not (label or entry or in_oneof) and (field.proto3_optional or self._file.syntax in ("", "proto2")):
            label = "optional"
        comment, line, column, _ = self._at(path)
        oneof = message.oneof_decl[field.oneof_index].name if message and in_oneof else ""
        type = f"map<{key}, {value}>" if entry else _type_of(field)
        return Field(field.number, field.name, type, key, value, label, oneof, {}, comment, line, column)

    def _enum(self, path: tuple[int, ...], scope: str, enum: EnumDescriptorProto) -> Enum:
        comment, line, column, end_line = self._at(path)
        return Enum(
            name=enum.name,
            full_name=f"{scope}.{enum.name}" if scope else enum.name,
            values=tuple(
                EnumValue(value.name, value.number, {}, *self._at((*path, 2, index))[:3])
                for index, value in enumerate(enum.value)
            ),
            reserved=tuple((item.start, item.end) for item in enum.reserved_range),
            reserved_names=tuple(enum.reserved_name),
            options={},
            comment=comment,
            claims=(),
            line=line,
            column=column,
            end_line=end_line,
        )


def _clean(comment: str) -> str:
    """As the generator shows comments: without the space after the slashes, and without empty lines at the ends."""
    return "\n".join(line.removeprefix(" ").rstrip() for line in comment.splitlines()).strip("\n")


def _type_of(field: FieldDescriptorProto) -> str:
    group = field.type == FieldDescriptorProto.TYPE_GROUP
    return "group" if group else field.type_name.removeprefix(".") or _TYPES[field.type]


# --- ours -------------------------------------------------------------------------------------------------------


def declared_names(files: list[FileDescriptorProto]) -> frozenset[str]:
    """Full names of the messages and enums in files."""
    described = [Theirs(file).file() for file in files]
    return frozenset(item.full_name for file in described for item in (*file.all_messages(), *file.all_enums()))


def comparable(file: File, names: frozenset[str]) -> File:
    """What was read, with types by their full names, and without what protoc does not tell in the same way."""
    extends = [
        Extend(resolve_type(extend.extendee, extend.scope, names) or "", extend.scope, (item,), 0, 0)
        for extend in file.extends
        for item in _fields(extend.fields, extend.scope, names)
    ]
    return replace(
        file,
        syntax=file.syntax or "proto2",
        messages=tuple(_message(message, names) for message in file.messages),
        enums=tuple(_enum(enum) for enum in file.enums),
        extends=tuple(extends),
    )


def _message(message: Message, names: frozenset[str]) -> Message:
    return replace(
        message,
        fields=_fields(message.fields, message.full_name, names),
        messages=tuple(_message(nested, names) for nested in message.messages),
        enums=tuple(_enum(enum) for enum in message.enums),
        options={},
        claims=(),
    )


def _enum(enum: Enum) -> Enum:
    return replace(enum, values=tuple(replace(value, options={}) for value in enum.values), options={}, claims=())


def _fields(fields: tuple[Field, ...], scope: str, names: frozenset[str]) -> tuple[Field, ...]:
    return tuple(_field(field, scope, names) for field in fields)


def _field(field: Field, scope: str, names: frozenset[str]) -> Field:
    value = resolve_type(field.value_type, scope, names) or field.value_type
    type = f"map<{field.key_type}, {value}>" if value else resolve_type(field.type, scope, names) or field.type
    return replace(field, type=type, value_type=value, options={})
