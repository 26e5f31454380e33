"""A field has a type now that JSON writes differently, or that holds fewer values.

The bytes are read, and numbers that do not fit are cut off in silence. In JSON the value has another form: a 64-bit
integer is a string, an enum is its name, bytes are base64.

Bad::

    message Wheel { int32 ticks = 1; }   // before
    message Wheel { int64 ticks = 1; }   // after: an old board cuts them to 32 bits

Good::

    message Wheel { int32 ticks = 1 [deprecated = true]; int64 total_ticks = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.cures import back_or_renumber, was
from generator.changes.renumbering import NewNumbers
from generator.changes.spelling import retyping, type_place
from generator.changes.types import retyped
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN101", "field-type-changed-in-json", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields whose old and new type can read each other's bytes, but not JSON."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Diagnostic]:
    numbers = NewNumbers(subject, change)
    for pair in retyped(change, fields(change), Breaks.JSON):
        yield RULE.at(
            type_place(pair.new),
            retyping(pair, Breaks.JSON),
            back_or_renumber(numbers, pair),
            earlier(change, type_place(pair.old), f"it was `{was(pair)}` here"),
            type=pair.owner,
            number=pair.new.number,
        )
