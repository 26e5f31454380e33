"""A number that a message had for another field once is used again.

The field was deleted long ago, and with it what reserved its number. The ledger knows every number that was ever
published: a board with the old field may still be out there, and its bytes are read as the new one.

Bad::

    message Imu { float x = 1; float y = 2; }      // once
    message Imu { float x = 1; }                   // later
    message Imu { float x = 1; int32 state = 2; }  // now

Good::

    message Imu { float x = 1; reserved 2; reserved "y"; int32 state = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator import ir
from generator.changes import Breaks
from generator.changes.cures import reserve
from generator.changes.numbers import next_field_number
from generator.changes.spelling import declaration
from generator.changes.types import broken_by_kind
from generator.diagnostics import Diagnostic, Rule
from generator.ledger import Number
from generator.protos import ProtoField, ProtoMessage, Schema
from generator.subject import Subject

RULE = Rule("WIR111", "field-number-reuse-in-message", __doc__)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields whose number the ledger has for another one that is gone, unless it has this one as well."""
    if subject.schema is None:
        return
    for name, owner in subject.ledger.messages.items():
        message, offered = subject.schema.messages.get(name), set[int]()
        for field in message.fields if message else ():
            published = [number for number in owner.numbers if number.fact.number == field.number]
            gone = [number for number in published if number.gone]
            if message and gone and not any(_is_the_same(number, field) for number in published):
                free = next_field_number(subject, name, offered)
                offered |= {free} if free else set()
                yield from (_finding(subject.schema, message, field, number, free) for number in gone)


def _is_the_same(number: Number, field: ProtoField) -> bool:
    """Whether a fact is about this very field, if with a type that reads the same bytes."""
    fact = number.fact
    if not isinstance(fact, ir.WireField) or fact.name != field.name:
        return False
    return fact.type == field.wire_type or broken_by_kind(fact.type, field.wire_type) is not Breaks.WIRE


def _finding(schema: Schema, message: ProtoMessage, field: ProtoField, number: Number, free: int | None) -> Diagnostic:
    fact = number.fact
    was = f"{fact.name} ({fact.type})" if isinstance(fact, ir.WireField) else fact.name
    return RULE.at(
        field.at("number"),
        f"number {field.number} of {message.full_name} was {was} once, and is given to {field.name}",
        _help(schema, message, field, fact.name, free) if free else f"find another place for {field.name}",
        [(number.span, "published here")],
        type=message.full_name,
        number=field.number,
    )


def _help(schema: Schema, message: ProtoMessage, field: ProtoField, was: str, free: int) -> str:
    syntax = schema.syntax_of(message.file)
    moved = declaration(field, schema, message.full_name, syntax, free)
    freed = reserve(message, syntax, [(field.number, field.number)], [was])
    return f"write `{moved} {freed}`: {free} is free"
