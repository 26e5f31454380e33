"""A field has another type now, of which bytes and JSON are the same.

What travels can be read. Code that uses the field has to change, and integers that lost or got their sign read the
other half of their range as other numbers.

Bad::

    message Wheel { int32 turns = 1; }    // before
    message Wheel { uint32 turns = 1; }   // after: -1 is read as 4294967295

Good::

    message Wheel { int32 turns = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.cardinality import broken_by_cardinality, cardinalities
from generator.changes.cures import back, was
from generator.changes.spelling import retyping, type_place
from generator.changes.types import retyped
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC101", "field-type-changed-in-code", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields whose old and new type can read each other's bytes and JSON; of a list that became a map, JSON says it."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in retyped(change, fields(change), Breaks.CODE):
        if broken_by_cardinality(*cardinalities(pair)) is Breaks.JSON:
            continue
        yield RULE.at(
            type_place(pair.new),
            retyping(pair, Breaks.CODE),
            f"{back(pair)}, or change the code that uses it on every side",
            earlier(change, type_place(pair.old), f"it was `{was(pair)}` here"),
            type=pair.owner,
            number=pair.new.number,
        )
