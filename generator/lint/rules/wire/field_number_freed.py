"""The number of a deleted field is not reserved.

The number looks free. If a new field gets it, the rover reads bytes of boards that still send the old field as the new
field.

Bad::

    message Imu { float x = 1; float y = 2; }   // before
    message Imu { float x = 1; }                // after

Good::

    message Imu { float x = 1; reserved 2; reserved "y"; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import MessagePair, SchemaChange, each_once, gone_fields
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration_of_old
from roverlink.generator.lint.fixits.put_back_or_reserve import names_in_use, put_back_or_reserve
from roverlink.generator.protos.number_ranges import covers
from roverlink.generator.protos.schema import ProtoField

RULE = Rule("WIR102", "field-number-freed", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number that a field had before, and that is neither used nor reserved now."""
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair, field in gone_fields(change):
        if not covers(pair.new.reserved, field.number):
            yield RULE.at(
                pair.new.span,
                _message(pair, field),
                put_back_or_reserve(pair, field),
                change.earlier(field.span, f"it was `{declaration_of_old(pair, field)}` here"),
                type=pair.new.full_name,
                number=field.number,
            )


def _message(pair: MessagePair, field: ProtoField) -> str:
    moved = names_in_use(pair.new).get(field.name)
    if moved is not None:
        return (
            f"{field.name!r} moved from number {field.number} to {moved}, but the number {field.number} is not reserved"
        )
    return f"`{field.name} = {field.number}` was deleted from {pair.new.full_name!r}, but its number is not reserved"
