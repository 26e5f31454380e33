"""A field tells absent from zero now and did not before, or the other way round.

The bytes can be read by both sides. Code has a `has_...` for the one and none for the other; and a zero that is set is
sent by the one and left out by the other, so that a receiver may take it for absent.

Bad::

    message Imu { optional float heading = 1; }   // before
    message Imu { float heading = 1; }            // after: a heading of 0 looks like none

Good::

    message Imu { optional float heading = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, FieldPair, each_once, earlier, fields
from generator.changes.cardinality import IMPLICIT, broken_by_cardinality, cardinalities
from generator.changes.cures import back, before_and_after
from generator.changes.oneofs import broken_by_oneof
from generator.changes.types import broken_by_type
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC103", "field-presence-changed", Severity.WARNING)
_TOLD = "told absent from zero, and does not any more"
_TELLS = "tells absent from zero now, and did not"


def check(subject: Subject) -> Iterator[Finding]:
    """Fields that are singular on both sides, and on one of them know absence."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in fields(change):
        old, new = cardinalities(pair)
        if broken_by_cardinality(old, new) is Breaks.CODE and not _follows_from_another_fault(pair):
            was, _ = before_and_after(pair)
            yield RULE.at(
                pair.new.span,
                f"{pair.new.name} = {pair.new.number} {_TOLD if new == IMPLICIT else _TELLS}",
                back(pair),
                earlier(change, pair.old.span, f"it was `{was}` here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _follows_from_another_fault(pair: FieldPair) -> bool:
    """Whether its type or its oneof changed, which is said already."""
    return broken_by_type(pair) is Breaks.WIRE or broken_by_oneof(pair) is not Breaks.NOTHING
