"""What protoc and the tolerant parser say of a file, so that the two can be compared."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import grpc_tools
from google.protobuf.descriptor_pb2 import Edition, FileDescriptorProto, FileDescriptorSet
from grpc_tools import protoc

from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.parser import File, resolve_type
from roverlink.generator.protos.schema import Declared, ProtoEnum, ProtoField, ProtoMessage

WELL_KNOWN = Path(grpc_tools.__file__).parent / "_proto"


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


# --- both, in words that can be compared ------------------------------------------------------------------------


def theirs(file: FileDescriptorProto) -> dict[str, Any]:
    """What a file declares as protoc describes it; the descriptors are read as the generator reads them."""
    schema = schema_of(FileDescriptorSet(file=[file]), "")
    kinds = dict.fromkeys(file.public_dependency, "public") | dict.fromkeys(file.weak_dependency, "weak")
    editions = {"editions": Edition.Name(file.edition).removeprefix("EDITION_")}
    places = {tuple(location.path): location for location in file.source_code_info.location}

    def field(one: ProtoField) -> tuple[Any, ...]:
        entry = schema.messages.get(one.type_name)
        if entry and entry.map_entry:
            key, value = (part.wire_type for part in entry.fields)
            return _field(one, f"map<{key}, {value}>", "")
        written = one.declared_optional or (one.label == "optional" and file.syntax in ("", "proto2") and not one.oneof)
        if one.repeated or (one.label == "required" and file.syntax != "editions"):  # there, it is a feature
            written_label = one.label
        else:
            written_label = "optional" if written else ""
        return _field(one, "group" if one.type == "group" else one.wire_type, written_label)

    return {
        "syntax": editions.get(file.syntax, file.syntax or "proto2"),
        "package": file.package,
        "imports": [
            (path, kinds.get(index, ""), *(part + 1 for part in places[3, index].span[:2]))
            for index, path in enumerate(file.dependency)
        ],
        "messages": [
            _message(message, [field(one) for one in message.fields])
            for message in schema.messages.values()
            if not message.map_entry
        ],
        "enums": _enums(schema.enums.values()),
        "extensions": [(one.extendee, one.scope, field(one.field)) for one in schema.extensions],
    }


def ours(file: File, names: frozenset[str]) -> dict[str, Any]:
    """What was read of a file, with types by their full names."""

    def field(one: ProtoField, scope: str) -> tuple[Any, ...]:
        if match := re.fullmatch(r"map<(.*), (.*)>", one.type):
            return _field(one, f"map<{match[1]}, {resolve_type(match[2], scope, names) or match[2]}>", one.label)
        return _field(one, resolve_type(one.type, scope, names) or one.type, one.label)

    return {
        "syntax": file.syntax or "proto2",
        "package": file.package,
        "imports": [(one.path, one.kind, one.line, one.column) for one in file.imports],
        "messages": [
            _message(message, [field(one, message.full_name) for one in message.fields]) for message in file.messages
        ],
        "enums": _enums(file.enums),
        "extensions": [
            (resolve_type(one.extendee, scope, names), one.scope, field(one.field, scope))
            for one in file.extensions
            for scope in [one.scope or file.package]
        ],
    }


def declared_names(files: list[FileDescriptorProto]) -> frozenset[str]:
    """Full names of the messages and enums in files."""
    schema = schema_of(FileDescriptorSet(file=files), "")
    messages = (message.full_name for message in schema.messages.values() if not message.map_entry)
    return frozenset((*messages, *schema.enums))


def _place(declared: Declared) -> tuple[int, int]:
    return declared.span.line, declared.span.column


def _field(field: ProtoField, type: str, label: str) -> tuple[Any, ...]:
    return field.number, field.name, type, label, field.oneof, field.fact.json_name, *_place(field)


def _message(message: ProtoMessage, fields: list[tuple[Any, ...]]) -> tuple[Any, ...]:
    numbers = message.reserved, message.reserved_names, message.extension_ranges
    return message.full_name, fields, message.oneofs, *numbers, *_place(message)


def _enums(enums: Iterable[ProtoEnum]) -> list[tuple[Any, ...]]:
    return sorted(
        (
            enum.full_name,
            [(value.name, value.number, *_place(value)) for value in enum.values],
            enum.reserved,
            enum.reserved_names,
            *_place(enum),
        )
        for enum in enums
    )
