"""The judgement of fields and enum values that exist before and after a change."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from roverlink.generator.lint.comparison.cardinality import cardinalities, cardinality, is_map
from roverlink.generator.lint.comparison.enum_renames import moved_away, moved_here
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type, kind
from roverlink.generator.lint.comparison.judgement import (
    Judgement,
    Meaning,
    Part,
    TypePair,
    TypeState,
    judge_compounds,
    judge_field,
    judge_types,
    judge_value,
    least,
)
from roverlink.generator.lint.comparison.pairing import EnumPair, FieldPair, MessagePair, fields
from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.protos.schema import (
    ProtoEnum,
    ProtoEnumValue,
    ProtoField,
    ProtoMessage,
    Schema,
    default_json_name,
)


@lru_cache(maxsize=2)  # the changes since the baseline and since the ledger; several rules ask about each
def judged_fields(change: SchemaChange) -> list[tuple[FieldPair, Judgement]]:
    """Return each field that exists before and after a change, with its judgement."""
    return [(pair, judge_pair(pair)) for pair in fields(change)]


def judge_pair(pair: FieldPair) -> Judgement:
    """Judge a field that exists before and after a change."""
    if broken_by_type(pair):
        return Judgement(Meaning.WIRE)
    if pair.in_map_entry:
        return Judgement(Meaning.SAME)
    counts = cardinalities(pair)
    old, new = (_part(field, count) for field, count in zip((pair.old, pair.new), counts, strict=True))
    others = pair.messages.old.fields if pair.messages else ()
    moved = any(field.name == new.name and field.number != new.number for field in others)
    types = _types(pair)
    judged = judge_field(old, new, types, moved)
    return judged if types else judge_compounds(judged, old.name, new.name, frozenset(), _names(pair.messages))


def judge_number(pair: EnumPair, number: int, gone: Sequence[str], values: Sequence[ProtoEnumValue]) -> Judgement:
    """Judge a number of an enum that lost the names ``gone``, and has the names of ``values`` now."""
    if other := moved_here(pair, number) or moved_away(pair, number):
        return Judgement(Meaning.OTHER, f"{other.name!r} had another number, or has another one now")
    if any(value.number == number and value.name not in gone for value in pair.old.values):
        return Judgement(Meaning.SAME)  # an alias has kept its name
    states = type_state(pair.old, pair.change.before), type_state(pair.new, pair.change.after)
    shared = states[0].shared_words | states[1].shared_words
    names = [value.name for value in (*pair.old.values, *pair.new.values)]
    return least(
        judge_compounds(
            judge_value(Part(number, old), Part(number, new.name), False, shared), old, new.name, shared, names
        )
        for old in gone
        for new in values
    )


def _names(pair: MessagePair | None) -> list[str]:
    return [field.name for message in (pair.old, pair.new) for field in message.fields] if pair else []


def judge_payload(change: SchemaChange, old: str, new: str, *names: str) -> Judgement | None:
    """Judge the message ``new``, which is a payload with the number that the message ``old`` had before a change.

    ``names`` are the old and the new name of the payload. Returns None if one of the messages is unknown.
    """
    types = _pair(change, old, new)
    return judge_types(types, *names) if types else None


def type_state(type: ProtoMessage | ProtoEnum, schema: Schema) -> TypeState:
    """Return a message or enum of a schema as it is judged."""
    if isinstance(type, ProtoEnum):
        return TypeState(type.full_name, tuple(Part(value.number, value.name) for value in type.values))
    return TypeState(type.full_name, tuple(_part(field, cardinality(field, schema)) for field in type.fields))


def _part(field: ProtoField, count: str) -> Part:
    payload = bool(field.oneof and field.type == "message")
    # The ledger knows no names in JSON. Few fields have an unusual one.
    json_name = field.json_name or default_json_name(field.name)
    return Part(field.number, field.name, kind(field), count, json_name, payload)


def _types(pair: FieldPair) -> TypePair | None:
    change = pair.change
    # The entry of a map is named after the field.
    if is_map(pair.old, change.before) or is_map(pair.new, change.after):
        return None
    return _pair(change, pair.old.type_name, pair.new.type_name)


def _pair(change: SchemaChange, old: str, new: str) -> TypePair | None:
    before, after = change.before, change.after
    was = before.messages.get(old) or before.enums.get(old)
    now = after.messages.get(new) or after.enums.get(new)
    if was is None or now is None:
        return None
    beside = _declares(before, new) and _declares(after, old)
    return TypePair(type_state(was, before), type_state(now, after), beside)


def _declares(schema: Schema, name: str) -> bool:
    return name in schema.messages or name in schema.enums
