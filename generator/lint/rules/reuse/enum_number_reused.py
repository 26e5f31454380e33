"""A number of a deleted enum value is used again.

The value was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number that
was ever published. A board with old firmware may still send the old value, and the rover reads it as the new one.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }   // once
    enum Mode { IDLE = 0; }              // later
    enum Mode { IDLE = 0; ARM = 1; }     // now

Good::

    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import values_by_number
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.put_back_or_reserve import reserve
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared
from roverlink.generator.lint.free_numbers import next_enum_number
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, Schema

RULE = Rule("WIR112", "enum-number-reuse", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each enum value whose number belonged to another value in the ledger.

    A value that the ledger also contains with this number is left out.
    """
    if context.schema is None:
        return
    for name, gone in context.ledger.gone_values.items():
        enum, offered = context.schema.enums.get(name), set[int]()
        published = {(one.number, one.name) for one in context.ledger.values(name)}
        for number, values in values_by_number(enum).items() if enum else ():
            reused = [one for one in gone if one.number == number]
            if enum and reused and not any((number, value.name) in published for value in values):
                free = next_enum_number(context, name, offered)
                offered |= {free} if free else set()
                yield from (_finding(context.schema, enum, values, one, free) for one in reused)


def _finding(
    schema: Schema, enum: ProtoEnum, values: list[ProtoEnumValue], old: ProtoEnumValue, free: int | None
) -> Diagnostic:
    names, was = [value.name for value in values], old.name
    freed = reserve(enum, schema.syntax_of(enum.file), [(old.number, old.number)], [was])
    return RULE.at(
        values[0].at("number"),
        f"number {values[0].number} of the enum {enum.full_name!r} was {was!r} in the past, and is now {names[0]!r}",
        (
            f"write `{declared(names, free)} {freed}`: the number {free} is free"
            if free
            else f"declare {names[0]!r} in another enum"
        ),
        [(old.span, "published here")],
        type=enum.full_name,
        number=values[0].number,
    )
