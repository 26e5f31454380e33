"""The number of a deleted enum value is not reserved.

The number looks free. If a new value gets it, the rover misreads boards that still send the old value.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }   // before
    enum Mode { IDLE = 0; }              // after

Good::

    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import EnumPair, SchemaChange, each_once, gone_values
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import value_back_or_reserve
from roverlink.generator.protos.number_ranges import covers

RULE = Rule("WIR107", "enum-value-number-freed", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number that an enum value had before, and that is neither used nor reserved now."""
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair, number, names in gone_values(change):
        if not covers(pair.new.reserved, number):
            yield RULE.at(
                pair.new.span,
                _message(pair, number, names),
                value_back_or_reserve(pair, number, names),
                change.earlier(value_place(pair.old, number), "it was here"),
                type=pair.new.full_name,
                number=number,
            )


def _message(pair: EnumPair, number: int, names: tuple[str, ...]) -> str:
    moved = {value.name: value.number for value in pair.new.values if value.name in names}
    for name, now in moved.items():
        return f"{name!r} moved from number {number} to {now}, but the number {number} is not reserved"
    return f"`{', '.join(names)} = {number};` was deleted from {pair.new.full_name!r}, but its number is not reserved"
