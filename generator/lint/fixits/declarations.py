"""Declarations as text of a .proto file, for messages and help texts that quote old and new declarations."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Span
from roverlink.generator.lint.comparison import default_values
from roverlink.generator.lint.comparison.cardinality import is_map
from roverlink.generator.lint.comparison.field_type_changes import kind
from roverlink.generator.lint.comparison.pairing import FieldPair, MessagePair, written
from roverlink.generator.protos.schema import ProtoEnum, ProtoField, Schema, Syntax

_PRESENCE = {"optional": "EXPLICIT", "required": "LEGACY_REQUIRED", "": "IMPLICIT"}


def declaration(field: ProtoField, schema: Schema, owner: str, syntax: Syntax, number: int | None = None) -> str:
    """Return a field's declaration as text of a .proto file, such as ``repeated float range = 3;``.

    ``owner`` is the full name of the message around the field. ``syntax`` is the syntax of the file for which the text
    is written. ``number`` replaces the field's own number.
    """
    is_group = field.type == "group" and not syntax.is_edition
    name = field.type_name.rpartition(".")[2] if is_group else field.name
    type = "group" if is_group else type_of(field, schema, owner)
    options = ", ".join(_options(field, schema, syntax))
    options = f" [{options}]" if options else ""
    end = " { ... }" if is_group else ";"
    return f"{_label(field, schema, syntax)}{type} {name} = {number or field.number}{options}{end}"


def declaration_of_old(pair: MessagePair, field: ProtoField) -> str:
    """Return the declaration of an old field in the syntax that its file had before the change."""
    before = pair.change.before
    return declaration(field, before, pair.old.full_name, before.syntax_of(pair.old.file))


def _label(field: ProtoField, schema: Schema, syntax: Syntax) -> str:
    # A map takes no label (Language Guide, "Maps": map fields cannot be repeated).
    if is_map(field, schema):
        return ""
    if field.repeated:
        return "repeated "
    # Members of a oneof take no label, and editions express presence as a feature (below, `_options`).
    if field.oneof or syntax.is_edition:
        return ""
    if field.label == "required":
        return "required "
    return "optional " if field.optional or syntax.name == "proto2" else ""


def _options(field: ProtoField, schema: Schema, syntax: Syntax) -> Iterator[str]:
    if "default" in field.facets and syntax.name != "proto3":
        yield f"default = {default_values.shown(field, schema)}"
    if not syntax.is_edition:
        return
    holds_message = field.type in ("message", "group")
    presence = "" if field.repeated or field.oneof else _PRESENCE[field.label]
    if presence and presence != syntax.presence and (not holds_message or field.label == "required"):
        yield f"features.field_presence = {presence}"
    encoding = "DELIMITED" if kind(field) == "group" else "LENGTH_PREFIXED"
    if holds_message and encoding != syntax.encoding and not is_map(field, schema):
        yield f"features.message_encoding = {encoding}"


def type_of(field: ProtoField, schema: Schema, owner: str) -> str:
    """Return a field's type as a .proto file writes it inside the message ``owner``: ``float``, ``map<string, Pose>``.

    The packages and messages around both `owner` and the type are left out; see `from_within`.
    """
    entry = schema.messages.get(field.type_name)
    if entry is not None and is_map(field, schema):
        key, value = sorted(entry.fields, key=lambda field: field.number)
        return f"map<{key.type}, {type_of(value, schema, owner)}>"
    return from_within(owner, field.type_name) if field.type_name else field.type


def name_place(field: ProtoField) -> Span:
    """Return the place of a field's name."""
    return field.at("name")


def type_place(field: ProtoField) -> Span:
    """Return the place of the type in a field's declaration."""
    return field.places.get("type") or field.at("type_name")


def value_place(enum: ProtoEnum, number: int) -> Span:
    """Return the place of the first enum value that has ``number``; the place of the enum if no value has it."""
    return next((value.span for value in enum.values if value.number == number), enum.span)


def retyping(pair: FieldPair) -> str:
    """Return a text that describes the change of a field's type, for a diagnostic.

    If the name stayed, the text also says how a receiver with the other version of the .proto file reads the value.
    """
    old, new = pair.old, pair.new
    old_type = type_text(old, pair.change.before, pair.owner)
    new_type = type_text(new, pair.change.after, pair.owner)
    if old.name != new.name and not pair.in_map_entry:
        return f"number {new.number} was {old.name!r} ({old_type}), and is now {new.name!r} ({new_type})"
    what = f"`{new.name} = {new.number}`"
    if pair.in_map_entry:
        of_map = written(pair).new
        what = f"the {new.name} of the map `{of_map.name} = {of_map.number}`"
    comma = "," if kind(old) == "group" else ""
    return f"{what} was {old_type}{comma} and is now {new_type}: {_misreading(kind(old), kind(new))}"


def type_text(field: ProtoField, schema: Schema, owner: str) -> str:
    """Return a field's type as text for a diagnostic: ``float``, or ``rover.Pose, delimited as a group``."""
    if kind(field) == "group":
        return f"{field.type_name}, delimited as a group"
    return type_of(field, schema, "" if field.type_name and not is_map(field, schema) else owner)


def from_within(owner: str, full_name: str) -> str:
    """Return the short name of a type inside the message ``owner``, without the packages and messages around both.

    Inside ``rover.Imu``, the type ``rover.Vector`` is ``Vector``.
    """
    scope = owner
    while scope:
        if full_name.startswith(f"{scope}."):
            return full_name.removeprefix(f"{scope}.")
        scope = scope.rpartition(".")[0]
    return full_name


# The record types of the encoding guide ("Message Structure"): VARINT, I32, I64, LEN, and SGROUP with EGROUP. A parser
# reads the record type from the tag. If it is not the expected one, the record becomes an unknown field.
_WIRE_TYPES = {
    **dict.fromkeys(("int32", "int64", "uint32", "uint64", "sint32", "sint64", "bool", "enum"), "varint"),
    **dict.fromkeys(("fixed32", "sfixed32", "float"), "four bytes"),
    **dict.fromkeys(("fixed64", "sfixed64", "double"), "eight bytes"),
    **dict.fromkeys(("string", "bytes", "message"), "length and bytes"),
    "group": "group",
}


def _misreading(old: str, new: str) -> str:
    if _WIRE_TYPES.get(old) != _WIRE_TYPES.get(new):
        return "a receiver of the other version skips the value as unknown"
    if "message" in (old, new) or old == new == "enum":
        return "a receiver of the other version reads it with another meaning"
    if new == "string":
        return "a receiver rejects the whole message if the bytes are not UTF-8"
    return "a receiver of the other version reads another value"
