"""The judgement of fields and enum values that exist before and after a change."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator.lint.comparison.cardinality import cardinalities, cardinality, is_map
from roverlink.generator.lint.comparison.enum_renames import moved_away, moved_here
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type, kind
from roverlink.generator.lint.comparison.judgement import (
    Judgement,
    Meaning,
    Part,
    TypePair,
    TypeState,
    judge_field,
    judge_value,
    least,
)
from roverlink.generator.lint.comparison.pairing import EnumPair, FieldPair
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, ProtoField, ProtoMessage, Schema


def judge_pair(pair: FieldPair) -> Judgement:
    """Judge a field that exists before and after a change."""
    if broken_by_type(pair):
        return Judgement(Meaning.WIRE)
    if pair.in_map_entry:
        return Judgement(Meaning.SAME)
    counts = cardinalities(pair)
    old, new = (_part(field, count) for field, count in zip((pair.old, pair.new), counts, strict=True))
    others = pair.messages.old.fields if pair.messages else ()
    names = frozenset(field.name for field in others if field.number != pair.new.number)
    return judge_field(old, new, _types(pair), names)


def judge_number(pair: EnumPair, number: int, gone: Sequence[str], values: Sequence[ProtoEnumValue]) -> Judgement:
    """Judge a number of an enum that lost the names ``gone``, and has the names of ``values`` now."""
    if other := moved_here(pair, number) or moved_away(pair, number):
        return Judgement(Meaning.OTHER, f"{other.name!r} had another number, or has another one now")
    if any(value.number == number and value.name not in gone for value in pair.old.values):
        return Judgement(Meaning.SAME)  # an alias has kept its name
    states = type_state(pair.old, pair.change.before), type_state(pair.new, pair.change.after)
    shared = states[0].shared_words | states[1].shared_words
    return least(
        judge_value(Part(number, name), Part(number, value.name), frozenset(), shared)
        for name in gone
        for value in values
    )


def type_state(type: ProtoMessage | ProtoEnum, schema: Schema) -> TypeState:
    """Return a message or enum of a schema as it is judged."""
    if isinstance(type, ProtoEnum):
        return TypeState(type.full_name, tuple(Part(value.number, value.name) for value in type.values))
    return TypeState(type.full_name, tuple(_part(field, cardinality(field, schema)) for field in type.fields))


def _part(field: ProtoField, count: str) -> Part:
    payload = bool(field.oneof and field.type == "message")
    return Part(field.number, field.name, kind(field), count, field.json_name, payload)


def _types(pair: FieldPair) -> TypePair | None:
    change = pair.change
    before, after = change.before, change.after
    # The entry of a map is named after the field.
    if is_map(pair.old, before) or is_map(pair.new, after):
        return None
    old = before.messages.get(pair.old.type_name) or before.enums.get(pair.old.type_name)
    new = after.messages.get(pair.new.type_name) or after.enums.get(pair.new.type_name)
    if old is None or new is None:
        return None
    beside = _declares(before, new.full_name) and _declares(after, old.full_name)
    return TypePair(type_state(old, before), type_state(new, after), beside)


def _declares(schema: Schema, name: str) -> bool:
    return name in schema.messages or name in schema.enums
