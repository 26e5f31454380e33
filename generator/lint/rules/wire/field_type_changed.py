"""A field has a new type that reads the same bytes differently.

Bytes carry a field's number and its wire type, but not its declared type (encoding guide, "Message Structure"). A board
with old firmware still sends the old type. The rover reads wrong values from its bytes, or no value, without an error.

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
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field

RULE = Rule("WIR101", "field-type-changed-on-the-wire", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose new type misreads bytes of the old type."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if broken_by_type(pair):
            yield changed_field(RULE, numbers, pair, retyping(pair), type_place)
