"""A field holds many values now where it held one, or one where it held many, or it became required.

A list of numbers is packed into one value, which is no number; of several values a singular field keeps the last. A
required field makes whoever lacks it refuse the whole message.

Bad::

    message Arm { float joint = 1; }            // before
    message Arm { repeated float joint = 1; }   // after

Good::

    message Arm { reserved 1; reserved "joint"; repeated float joints = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.cardinality import broken_by_cardinality, cardinalities, shown
from generator.changes.cures import back_or_renumber, before_and_after
from generator.findings import Finding, Rule
from generator.subject import Change, Subject

RULE = Rule("WIR103", "field-cardinality-changed-on-the-wire")


def check(subject: Subject) -> Iterator[Finding]:
    """Fields that hold another number of values, as bytes show."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Finding]:
    for pair in fields(change):
        old, new = cardinalities(pair)
        if broken_by_cardinality(old, new) is Breaks.WIRE:
            was, _ = before_and_after(pair)
            yield RULE.at(
                pair.new.span,
                f"{pair.new.name} = {pair.new.number} was {shown(old)} and is {shown(new)} now",
                back_or_renumber(subject, pair),
                earlier(change, pair.old.span, f"it was `{was}` here"),
                type=pair.owner,
                number=pair.new.number,
            )
