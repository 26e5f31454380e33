"""Fields of a payload by path, down to scalars and enums."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.ir.interfaces import Path, Source
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.resolve.standard.standard_rules import UNKNOWN_SOURCE

_TYPES = {
    "double": "float64",
    "float": "float32",
    "bool": "bool",
    "string": "string",
    "bytes": "bytes",
    "enum": "int32",
    **dict.fromkeys(("int32", "sint32", "sfixed32"), "int32"),
    **dict.fromkeys(("int64", "sint64", "sfixed64"), "int64"),
    **dict.fromkeys(("uint32", "fixed32"), "uint32"),
    **dict.fromkeys(("uint64", "fixed64"), "uint64"),
}


class Sources:
    """Fields of a payload that a mapping can use."""

    def __init__(self, schema: Schema, message: ProtoMessage, report: Callable[[Diagnostic], None]) -> None:
        self._schema, self._message, self._report = schema, message, report

    @property
    def proto(self) -> str:
        """Full name of the payload's message."""
        return self._message.full_name

    def find(self, dotted: str, span: Span) -> Source | None:
        """Return the field at a path; report the path at ``span`` and return None if it cannot be used."""
        fields = self._along(dotted.split("."))
        if fields is None:
            help = nearest(dotted, self.paths())
            self._report(UNKNOWN_SOURCE.at(span, f"{self.proto!r} has no field {dotted!r}", help))
        elif why := _obstacle(fields):
            self._report(UNKNOWN_SOURCE.at(span, f"{dotted!r} {why}"))
        else:
            return _source(fields)
        return None

    def leads_somewhere(self, dotted: str) -> bool:
        """Return True if a path leads to a field of any type."""
        return self._along(dotted.split(".")) is not None

    def _along(self, path: list[str]) -> list[ProtoField] | None:
        """Return the fields along a path; None if it leads nowhere."""
        fields: list[ProtoField] = []
        message: ProtoMessage | None = self._message
        for name in path:
            field = next((field for field in message.fields if field.name == name), None) if message else None
            if field is None:
                return None
            fields.append(field)
            message = self._schema.messages.get(field.type_name)
        return fields

    def paths(self) -> list[str]:
        """Return every path to a field that is not a single message."""
        return [".".join(path) for path in self._leaves(self._message, (), ())]

    def _leaves(self, message: ProtoMessage, path: Path, inside: tuple[str, ...]) -> Iterator[Path]:
        for field in message.fields:
            nested = self._schema.messages.get(field.type_name)
            own = (*path, field.name)
            if nested is None or field.repeated or field.type_name in (*inside, message.full_name):
                yield own
            else:
                yield from self._leaves(nested, own, (*inside, message.full_name))

    def values_of(self, enum: str) -> dict[str, int]:
        """Return the declared values of an enum, by name."""
        return {value.name: value.number for value in self._schema.enums[enum].values}


def _obstacle(fields: list[ProtoField]) -> str:
    """Return the reason why the last field of a path cannot be used; empty if it can."""
    *holders, field = fields
    if field.type in ("message", "group"):
        return "is a message; use one of its fields"
    if repeated := next((holder for holder in holders if holder.repeated), None):
        return f"is inside {repeated.name!r}, which is repeated"
    if word := next((field.name for field in fields if keyword.iskeyword(field.name)), ""):
        return f"cannot be used by generated code, because {word!r} is a Python keyword"
    if field.repeated and field.type in ("enum", "string", "bytes"):
        return f"is a repeated {field.type}, which mappings do not support yet"
    return ""


def _source(fields: list[ProtoField]) -> Source:
    field = fields[-1]
    return Source(
        tuple(field.name for field in fields),
        _TYPES[field.type],
        field.repeated,
        (field.optional or bool(field.oneof)) and not field.repeated,
        field.type_name if field.type == "enum" else "",
        next((holder.oneof for holder in fields if holder.oneof), ""),
    )
