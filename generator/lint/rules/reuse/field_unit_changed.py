"""A field was renamed, and its new name says another unit, scale or reference.

Number and type are the same, so there is no error. The receiver reads millimetres of an old sender as metres,
hundredths of a degree as degrees, or a difference as a position.

Bad::

    message Arm { int32 reach_mm = 1; }   // before
    message Arm { int32 reach_m = 1; }    // after

Good::

    message Arm { reserved 1; reserved "reach_mm"; int32 reach_m = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.comparison import FieldPair, SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.field_renames import Rename, measures, rename
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import name_place
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field
from roverlink.generator.lint.names.name_units import factor

RULE = Rule("WIR115", "field-unit-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose old and new name contain the same quantity in different units."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if rename(pair) is Rename.UNIT:
            yield changed_field(RULE, numbers, pair, _message(pair), name_place)


def _message(pair: FieldPair) -> str:
    old, new = measures(pair)
    message = f"`{pair.old.name} = {pair.old.number}` is now called {pair.new.name!r}"
    message = f"{message}: old values ({old.shown}) are read as {new.shown}"
    times = factor(old, new)
    if times is None or times == 1:
        return message
    size = f"{times:.6g} times too large" if times > 1 else f"{1 / times:.6g} times too small"
    return f"{message}, {size}"
