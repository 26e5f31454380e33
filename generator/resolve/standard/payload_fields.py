"""Fields of a payload, found by their paths."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.interfaces import Path, Source, SourceEnum
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.resolve import well_known
from roverlink.generator.resolve.standard.standard_rules import UnknownSourceField
from roverlink.suggestions import nearest

_TYPES = {**well_known.SCALARS, "bytes": "bytes", "enum": "int32"}


class Sources:
    """Lookup of the fields of a payload by their paths. Their values fill the fields of a standard message."""

    def __init__(self, schema: Schema, message: ProtoMessage, report: Callable[[Diagnostic], None]) -> None:
        self._schema, self._message, self._report = schema, message, report

    @property
    def proto(self) -> str:
        """Full name of the payload's message."""
        return self._message.full_name

    def find(self, dotted: str, span: Span) -> Source | None:
        """Return the payload's field at a path with dots, such as ``accel.x``.

        If the field does not exist or cannot be used, report the path at ``span`` and return None.
        """
        fields = self._along(dotted.split("."))
        if fields is None:
            help = nearest(dotted, self.paths(), "")
            self._report(UnknownSourceField.at(span, f"the proto message {self.proto!r} has no field {dotted!r}", help))
        elif why := _obstacle(fields):
            self._report(UnknownSourceField.at(span, f"the field {dotted!r} {why}"))
        else:
            return self._source(fields)
        return None

    def leads_somewhere(self, dotted: str) -> bool:
        """Return True if the payload has a field at the path, even one that cannot be used."""
        return self._along(dotted.split(".")) is not None

    def _along(self, path: list[str]) -> list[ProtoField] | None:
        """Return the field for each name in a path, the outermost field first; None if one of them does not exist."""
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
        """Return the path of every field in the payload, at any depth, such as ``accel.x``.

        A field with a single nested message is not listed itself; the fields of the nested message are.
        """
        return [".".join(path) for path in self._leaves(self._message, (), ())]

    def _leaves(self, message: ProtoMessage, path: Path, inside: tuple[str, ...]) -> Iterator[Path]:
        for field in message.fields:
            nested = self._schema.messages.get(field.type_name)
            own = (*path, field.name)
            # A message that contains itself would have endless paths; it ends at the first repetition.
            if nested is None or field.repeated or field.type_name in (*inside, message.full_name):
                yield own
            else:
                yield from self._leaves(nested, own, (*inside, message.full_name))

    def values_of(self, enum: SourceEnum) -> dict[str, int]:
        """Return the number of each declared value of an enum, by the value's name."""
        return {value.name: value.number for value in self._schema.enums[enum.name].values}

    def _source(self, fields: list[ProtoField]) -> Source:
        field = fields[-1]
        return Source(
            tuple(field.name for field in fields),
            _TYPES[field.type],
            field.repeated,
            (field.optional or bool(field.oneof)) and not field.repeated,
            self._enum(field.type_name) if field.type == "enum" else None,
            next((holder.oneof for holder in fields if holder.oneof), ""),
        )

    def _enum(self, name: str) -> SourceEnum:
        file = self._schema.enums[name].file
        return SourceEnum(name, self._schema.packages.get(file, ""), file)


def _obstacle(fields: list[ProtoField]) -> str:
    """Return the reason why the last field of a path cannot fill a field of a standard message; empty if it can."""
    *holders, field = fields
    if field.type in ("message", "group"):
        return "is a message; use one of its fields"
    if repeated := next((holder for holder in holders if holder.repeated), None):
        return f"is inside {repeated.name!r}, which is repeated"
    if word := next((field.name for field in fields if keyword.iskeyword(field.name)), ""):
        return f"cannot be used by generated code, because {word!r} is a Python keyword"
    if field.repeated and field.type in ("enum", "string", "bytes"):
        return f"is a repeated {field.type}, which is not supported yet"
    return ""
