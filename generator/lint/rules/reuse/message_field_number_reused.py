"""A number of a deleted field is used again.

The field was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number that
was ever published. A board with old firmware may still send the old field, and the rover reads its bytes as the new
field.

Bad::

    message Imu { float x = 1; float y = 2; }      // once
    message Imu { float x = 1; }                   // later
    message Imu { float x = 1; int32 state = 2; }  // now

Good::

    message Imu { float x = 1; reserved 2; reserved "y"; int32 state = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison.field_type_changes import broken_by_kind
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.lint.fixits.put_back_or_reserve import reserve
from roverlink.generator.lint.free_numbers import next_field_number
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

RULE = Rule("WIR111", "field-number-reuse-in-message", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose number belonged to another field in the ledger.

    A field that the ledger also contains with this number is left out.
    """
    if context.schema is None:
        return
    for name, gone in context.ledger.gone_fields.items():
        message, offered = context.schema.messages.get(name), set[int]()
        for field in message.fields if message else ():
            reused = [one for one in gone if one.number == field.number]
            if message and reused and not any(_is_the_same(one, field) for one in context.ledger.fields(name)):
                free = next_field_number(context, name, offered)
                offered |= {free} if free else set()
                yield from (_finding(context.schema, message, field, one, free) for one in reused)


def _is_the_same(old: ProtoField, new: ProtoField) -> bool:
    """Return True if a published field and a field have the same number, name and meaning of the bytes."""
    if (old.number, old.name) != (new.number, new.name):
        return False
    return old.wire_type == new.wire_type or not broken_by_kind(old.wire_type, new.wire_type)


def _finding(schema: Schema, message: ProtoMessage, field: ProtoField, old: ProtoField, free: int | None) -> Diagnostic:
    was = f"{old.name!r} ({old.wire_type})"
    return RULE.at(
        field.at("number"),
        f"number {field.number} of {message.full_name!r} was {was} in the past, and is now {field.name!r}",
        _help(schema, message, field, old.name, free) if free else f"declare {field.name!r} in another message",
        [(old.span, "published here")],
        type=message.full_name,
        number=field.number,
    )


def _help(schema: Schema, message: ProtoMessage, field: ProtoField, was: str, free: int) -> str:
    syntax = schema.syntax_of(message.file)
    moved = declaration(field, schema, message.full_name, syntax, free)
    freed = reserve(message, syntax, [(field.number, field.number)], [was])
    return f"write `{moved} {freed}`: the number {free} is free"
