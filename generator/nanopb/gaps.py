"""Why a field has no largest size."""

from __future__ import annotations

from collections.abc import Iterator

from generator.nanopb.bounds import Bounds
from generator.nanopb.reckoning import BoundedField
from generator.protos import Schema

_STATIC = frozenset({"FT_DEFAULT", "FT_STATIC", "FT_INLINE"})


def gap_in(field: BoundedField, schema: Schema, bounds: Bounds) -> str:
    """Why a field has none, be there a message in it or not; empty if that is not so.

    nanopb refuses a file for some of these; for most it leaves a field to functions that the user writes, and then
    nobody knows how much those encode.
    """
    return next(_gaps(field, schema, bounds), "")


def _gaps(field: BoundedField, schema: Schema, bounds: Bounds) -> Iterator[str]:
    given = field.given
    if given.type not in _STATIC:
        yield f"its type is {given.type}"
    if field.repeated and given.max_count is None:
        yield f"{_kind(field, schema)} without max_count"
    elif given.fixed_count and given.max_count is None:
        yield "fixed_count without max_count"
    if field.capacity is None and "string" in (field.type, field.field.type):
        yield "a string without max_size or max_length"
    if field.capacity is None and "bytes" in (field.type, field.field.type):
        yield "bytes without max_size"
    if field.type == "group":
        yield "a group, which nanopb does not support"
    if field.type == "message" and field.inner not in schema.messages:
        yield "type_override names a message, and it has none"
    if field.type == "enum" and field.field.type_name not in schema.enums:
        yield "type_override names an enum, and it has none"
    if field.inner and bounds.of_message(field.inner).skipped:
        yield f"nanopb leaves {field.inner} out"


def _kind(field: BoundedField, schema: Schema) -> str:
    message = schema.messages.get(field.field.type_name)
    return "a map" if message and message.map_entry else "repeated"
