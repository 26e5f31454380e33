"""A field changes between one value and many values.

A list of numbers is packed into one length-delimited value, which is not a number (encoding guide, "Packed Repeated
Fields"). A receiver that expects one number skips such a list. If it gets several single values, it keeps only the last
one.

Bad::

    message Arm { float joint = 1; }            // before
    message Arm { repeated float joint = 1; }   // after

Good::

    message Arm { reserved 1; reserved "joint"; repeated float joints = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator
from operator import attrgetter

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import FieldPair, SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.cardinality import broken_by_cardinality, cardinalities, only_required, shown
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field

RULE = Rule("WIR103", "field-cardinality-changed-on-the-wire", __doc__)
_WITHOUT_PACKED_LISTS = frozenset({"string", "bytes", "message", "group"})


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field that changed between a single value, repeated values and a map.

    Changes from or to `required` are left out, because another rule checks them.
    """
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        old, new = cardinalities(pair)
        if broken_by_cardinality(old, new) and not only_required(old, new):
            message = (
                f"`{pair.new.name} = {pair.new.number}` was {shown(old)} and is now {shown(new)}: {_consequence(pair)}"
            )
            yield changed_field(RULE, numbers, pair, message, attrgetter("span"))


def _consequence(pair: FieldPair) -> str:
    lost = "a receiver that expects one value keeps only the last of several values"
    if {pair.old.type, pair.new.type} <= _WITHOUT_PACKED_LISTS:
        return lost
    return f"{lost}, and skips a packed list"
