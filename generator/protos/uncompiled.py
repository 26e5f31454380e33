"""Declarations of .proto files that do not compile, added to the schema of the files that do.

A board may run firmware from a commit whose files do not compile on their own, for example because they import a file
of another repository. The tolerant parser reads the declarations of such files. It does not read options: the default
of a field is unknown, and so is its name in JSON.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from roverlink.generator.diagnostics import Span, shown
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
