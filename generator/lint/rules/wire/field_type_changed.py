"""A field has a type now whose bytes mean something else.

Bytes carry a field's number, not its type. A board that was not flashed goes on sending the old type, and the rover
reads its bytes as the new one: as other values, or not at all, without any error.

Bad::

    message Imu { float heading = 3; }   // before
    message Imu { int32 heading = 3; }   // after

Good::

    message Imu { reserved 3; int32 heading = 4; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import retyping, type_place
from roverlink.generator.lint.fixits.put_back_or_reserve import was
from roverlink.generator.lint.free_numbers import NewNumbers, back_or_renumber

RULE = Rule("WIR101", "field-type-changed-on-the-wire", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Fields whose old and new type cannot read each other."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if broken_by_type(pair):
            yield RULE.at(
                type_place(pair.new),
                retyping(pair),
                back_or_renumber(numbers, pair),
                change.earlier(type_place(pair.old), f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )
