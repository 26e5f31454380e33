"""What the rows say of single fields: whether their presence is kept, and what an Any may hold.

A path leads through nested messages, lists and maps to a field of some message. What is said of it holds wherever that
message stands: it becomes one ROS message.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from typing import TypeVar

from roverlink.generator.diagnostics import Diagnostic, nearest
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.resolve import well_known
from roverlink.generator.resolve.conversion_rules import (
    CONTRADICTING_PATHS,
    DISAGREEING_ROWS,
    UNKNOWN_FIELD,
    WITHOUT_EFFECT,
)
from roverlink.generator.table import Row, Table

T = TypeVar("T")

Key = tuple[str, str]
"""A field, by the full name of its message and its own."""


class FieldSettings:
    """The settings of fields, by message and field."""

    def __init__(self, table: Table, schema: Schema, report: Callable[[Diagnostic], None]) -> None:
        self._schema, self._report = schema, report
        rows = [row for row in table.rows if row.proto in schema.messages]
        self.presence = self._collected("presence", ((row, row.presence) for row in rows), self._no_presence)
        self.anys = self._collected("any", ((row, row.anys) for row in rows), self._no_any)

    def _collected(
        self, group: str, rows: Iterator[tuple[Row, Mapping[str, T]]], obstacle: Callable[[ProtoField, T], str]
    ) -> dict[Key, T]:
        """What all rows say in one group; each path must lead to a field to which the setting applies."""
        settings: dict[Key, T] = {}
        said: dict[Key, Row] = {}
        for row, paths in rows:
            for path, value in paths.items():
                span = row.at(f"{group}.{path}")
                if row.standard:
                    self._report(WITHOUT_EFFECT.at(span, *without_effect_on_standard(group, row)))
                    continue
                found = self._field(row, group, path)
                if found is None:
                    continue
                key, field = found
                if why := obstacle(field, value):
                    self._report(WITHOUT_EFFECT.at(span, f"{path} {why}", f"take it out of `{group}`"))
                elif settings.setdefault(key, value) != value:
                    message = f"{'.'.join(key)} is said to be something else in another row"
                    also = [(said[key].span, f"the row {said[key].name}")]
                    self._report(DISAGREEING_ROWS.at(span, message, "say the same in both, or leave out one", also))
                said.setdefault(key, row)
        return settings

    def _field(self, row: Row, group: str, path: str) -> tuple[Key, ProtoField] | None:
        """The field that a path leads to; None, with a finding, where it leads to none."""
        for whole in itertools.accumulate(path.split("."), "{}.{}".format):
            if whole in row.ignore:
                told = f"{path} is named under `{group}`, and {whole} is ignored"
                self._report(CONTRADICTING_PATHS.at(row.at(f"{group}.{path}"), told, "keep one of them"))
                return None
        message: ProtoMessage | None = self._schema.messages[row.proto]
        *holders, name = path.split(".")
        for part in holders:
            message = self._held(message, part)
        field = _field_of(message, name)
        if message is None or field is None:
            known = [] if message is None else [one.name for one in message.fields]
            told = f"{row.proto} has no field {path!r}"
            self._report(UNKNOWN_FIELD.at(row.at(f"{group}.{path}"), told, nearest(name, known)))
            return None
        return (message.full_name, name), field

    def _held(self, message: ProtoMessage | None, name: str) -> ProtoMessage | None:
        """The message in a field: of a map that in its values."""
        field = _field_of(message, name)
        held = self._schema.messages.get(field.type_name) if field else None
        return self._held(held, "value") if held and held.map_entry else held

    def _no_presence(self, field: ProtoField, keep: bool) -> str:
        """Why a field's presence cannot be chosen; empty where it can."""
        if field.repeated:
            return "is repeated: it is never absent, only empty"
        if field.oneof:
            return f"stands in the oneof {field.oneof}, which says which of its members is set"
        if field.label == "required":
            return "is required: it is never absent"
        if field.type_name in well_known.TEXTS:
            return "becomes a text, which is empty where it is absent"
        if field.type_name == well_known.EMPTY and not keep:
            return "says nothing but that it is set"
        if field.label != "optional":
            return "does not tell absent from zero: it is not `optional`"
        return ""

    def _no_any(self, field: ProtoField, _: object) -> str:
        """Why a field holds no Any; empty where it does."""
        held = self._schema.messages.get(field.type_name)
        if held is not None and held.map_entry:
            field = held.fields[1]
        return "" if field.type_name == well_known.ANY else "is no google.protobuf.Any"


def without_effect_on_standard(key: str, row: Row) -> tuple[str, str]:
    """What is wrong with a key that shapes messages of our own in a row with a standard one, and what to do."""
    message = f"`{key}` shapes messages of our own, and {row.ros} is a standard message"
    return message, "take it out, or put it into a row that has a message of our own"


def _field_of(message: ProtoMessage | None, name: str) -> ProtoField | None:
    return next((field for field in message.fields if field.name == name), None) if message else None
