"""A field was renamed, and its new name says another unit, scale or reference.

Number and type are the same, so there is no error: millimetres of an old sender are read as metres, hundredths of a
degree as degrees, or a difference as a position.

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
from roverlink.generator.lint.fixits.put_back_or_reserve import was
from roverlink.generator.lint.free_numbers import NewNumbers, back_or_renumber
from roverlink.generator.lint.names.name_units import factor

RULE = Rule("WIR115", "field-unit-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield fields whose old and new names say the same quantity in different units."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if rename(pair) is Rename.UNIT:
            yield RULE.at(
                pair.new.at("name"),
                _message(pair),
                back_or_renumber(numbers, pair),
                change.earlier(pair.old.at("name"), f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _message(pair: FieldPair) -> str:
    old, new = measures(pair)
    message = (
        f"`{pair.old.name} = {pair.old.number}` is now called {pair.new.name!r}: {old.shown} is read as {new.shown}"
    )
    times = factor(old, new)
    if times is None or times == 1:
        return message
    size = f"{times:.6g} times too large" if times > 1 else f"{1 / times:.6g} times too small"
    return f"{message}, {size}"
