"""A field moved into a oneof, out of a oneof, or to a oneof with other members.

A receiver keeps only the last member of a oneof that it reads (encoding guide, "Last One Wins"). If one side sends two
fields, and the other side has both in one oneof, all but one are lost.

Bad::

    message Order { int32 stop = 1; int32 go = 2; }             // before
    message Order { oneof what { int32 stop = 1; int32 go = 2; } }   // after

Good::

    message Order { int32 stop = 1; int32 go = 2; oneof what { int32 halt = 3; int32 run = 4; } }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.oneof_changes import broken_by_oneof, moved_back, moved_text
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.free_numbers import NewNumbers, back_or_renumber

RULE = Rule("WIR105", "field-moved-between-oneofs", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field that is together with other fields in a oneof than before."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if broken_by_oneof(pair):
            yield RULE.at(
                pair.new.span,
                f"{moved_text(pair)}: a receiver keeps only the last field of a oneof",
                back_or_renumber(numbers, pair, moved_back(pair)),
                change.earlier(pair.old.span, "it was here"),
                type=pair.owner,
                number=pair.new.number,
            )
