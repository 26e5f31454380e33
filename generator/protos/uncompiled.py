"""Declarations of .proto files that do not compile, added to the schema of the files that do.

A board may run firmware from a commit whose files do not compile on their own, for example because they import a file
of another repository. The tolerant parser reads the declarations of such files. It does not read options: the default
of a field is unknown, and so is its name in JSON.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass, replace
from typing import NamedTuple

from roverlink.generator.diagnostics import Span, shown
from roverlink.generator.ir.protobuf_facts import OWN_FILES
from roverlink.generator.protos.parser import SCALARS, File, map_types, resolve_type
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema, Syntax


def with_uncompiled(schema: Schema, files: Mapping[str, File], shown_root: str) -> Schema:
    """Return a schema with the messages and enums of its uncompiled files, as far as the parser can read them.

    ``files`` are all parsed files by path, and ``shown_root`` is the name of their folder in diagnostics. A field whose
    type no file declares counts as a message of this name.
    """
    added = {path: files[path] for path in schema.uncompiled if path in files}
    if not added:
        return schema
    messages, enums, syntaxes = dict(schema.messages), dict(schema.enums), dict(schema.syntaxes)
    for path, file in added.items():
        syntaxes[path] = Syntax(file.syntax or "proto2")
        for enum in file.enums:
            values = tuple(replace(value, span=_in(shown_root, path, value.span)) for value in enum.values)
            declared = replace(enum, file=path, values=values, span=_in(shown_root, path, enum.span))
            enums.setdefault(enum.full_name, declared)
    names = frozenset((*messages, *enums, *(message.full_name for file in added.values() for message in file.messages)))
    for path, file in added.items():
        for message in file.messages:
            for linked in _Linker(names, frozenset(enums), shown_root, path).linked(message):
                messages.setdefault(linked.full_name, linked)
    return replace(schema, messages=messages, enums=enums, syntaxes=syntaxes)


class ReadFiles(NamedTuple):
    """The .proto files of one state: what protoc could compile, and what the tolerant parser read."""

    schema: Schema
    files: Mapping[str, File]
    shown_root: str
    """The name of the folder of the files in diagnostics."""

    def without_an_import(self) -> set[str]:
        """Return the paths of the files that do not compile because an import is missing, and that can be parsed."""
        lacking, before = set[str](), -1
        while len(lacking) > before:
            before = len(lacking)
            lacking |= {
                path
                for path, file in self.files.items()
                if any(one in lacking or self._is_missing(one) for one in file.imported)
            }
        return {path for path in lacking.intersection(self.schema.uncompiled) if not self.files[path].broken}

    def declaring(self, names: Set[str]) -> set[str]:
        """Return the paths of the files that declare one of the messages and enums."""
        return {path for path, file in self.files.items() if not names.isdisjoint(_declared_in(file))}

    def parsed(self, paths: Set[str]) -> Schema:
        """Return the schema in which the tolerant parser has read some files, and protoc the others."""
        uncompiled = self.schema.uncompiled
        # If two files declare one name, the one that protoc could compile counts.
        read = sorted(paths & self.files.keys(), key=lambda path: (path in uncompiled, path))
        left = replace(
            self.schema,
            messages={name: one for name, one in self.schema.messages.items() if one.file not in paths},
            enums={name: one for name, one in self.schema.enums.items() if one.file not in paths},
            extensions=tuple(one for one in self.schema.extensions if one.file not in paths),
            uncompiled=tuple(read),
        )
        return replace(with_uncompiled(left, self.files, self.shown_root), uncompiled=uncompiled)

    def _is_missing(self, imported: str) -> bool:
        return imported not in self.files and not imported.startswith(OWN_FILES)


def read_alike(before: ReadFiles, after: ReadFiles) -> tuple[Schema, Schema]:
    """Return the schemas of two states, for a comparison, with all files that only lack an import.

    The tolerant parser reads such a file in both states, because protoc knows more about a file: the two would differ
    without a change. A file that the parser cannot read in one of the states is left out.
    """
    lacking = before.without_an_import() | after.without_an_import()
    if not lacking:
        return before.schema, after.schema
    names = {
        name
        for state in (before, after)
        for path in lacking
        if path in state.files
        for name in _declared_in(state.files[path])
    }
    paths = lacking | before.declaring(names) | after.declaring(names)
    broken = {path for state in (before, after) for path in paths if path in state.files and state.files[path].broken}
    return before.parsed(paths - broken), after.parsed(paths - broken)


def _declared_in(file: File) -> set[str]:
    return {message.full_name for message in file.messages} | {enum.full_name for enum in file.enums}


def _in(shown_root: str, path: str, span: Span) -> Span:
    return replace(span, file=shown(shown_root, path))


@dataclass(frozen=True, slots=True)
class _Linker:
    """Converter of a parsed message, whose types are as the file writes them, to one with full names."""

    names: frozenset[str]
    enums: frozenset[str]
    shown_root: str
    path: str

    def linked(self, message: ProtoMessage) -> Iterator[ProtoMessage]:
        """Yield a message, and an entry message for each of its maps, as protoc makes them."""
        fields = []
        for field in message.fields:
            if found := map_types(field.type):
                name = "".join(part[:1].upper() + part[1:] for part in field.name.split("_"))
                parts = [
                    ProtoField(span=field.span, number=number, name=part, type=type)
                    for number, (part, type) in enumerate(zip(("key", "value"), found, strict=True), 1)
                ]
                entry = replace(message, full_name=f"{message.full_name}.{name}Entry", span=field.span)
                yield self._with(replace(entry, map_entry=True, reserved=(), extension_ranges=()), parts)
                field = replace(field, type=f".{entry.full_name}", label="repeated")
            fields.append(field)
        yield self._with(message, fields)

    def _with(self, message: ProtoMessage, fields: list[ProtoField]) -> ProtoMessage:
        here = _in(self.shown_root, self.path, message.span)
        linked = tuple(self._field(field, message) for field in fields)
        return replace(message, file=self.path, span=here, fields=linked)

    def _field(self, field: ProtoField, message: ProtoMessage) -> ProtoField:
        span = _in(self.shown_root, self.path, field.span)
        if field.type in SCALARS:
            return replace(field, span=span)
        if field.type == "group":
            # The field of a group has the name of the group's message in small letters.
            inside = (name for name in self.names if name.lower() == f"{message.full_name}.{field.name}".lower())
            return replace(field, span=span, type_name=next(inside, ""))
        name = resolve_type(field.type, message.full_name, self.names) or field.type.removeprefix(".")
        return replace(field, span=span, type="enum" if name in self.enums else "message", type_name=name)
