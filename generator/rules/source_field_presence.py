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
from generator.changes.cures import back, was
from generator.changes.oneofs import broken_by_oneof, said_of_the_oneof
from generator.changes.types import broken_by_type
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC103", "field-presence-changed", __doc__, Severity.WARNING)
_TOLD = "told absent from zero, and does not any more"
_TELLS = "tells absent from zero now, and did not"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are singular on both sides, and on one of them know absence."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        old, new = cardinalities(pair)
        if broken_by_cardinality(old, new) is Breaks.CODE and not _follows_from_another_fault(pair):
            yield RULE.at(
                pair.new.span,
                f"{pair.new.name} = {pair.new.number} {_TOLD if new == IMPLICIT else _TELLS}",
                _help(pair),
                earlier(change, pair.old.span, f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _follows_from_another_fault(pair: FieldPair) -> bool:
    """Whether its type or its oneof changed, which is said already."""
    of_oneof = broken_by_oneof(pair) is not Breaks.NOTHING and not said_of_the_oneof(pair)
    return broken_by_type(pair) is Breaks.WIRE or of_oneof


def _help(pair: FieldPair) -> str:
    old, new = pair.old_syntax, pair.syntax
    if old.is_edition and new.is_edition and old.presence != new.presence:
        return f"{back(pair)}, or `option features.field_presence = {old.presence};` for the whole file"
    if new.name == "proto2":  # where no field but a list is without
        return f"put back `{old.statement}`"
    return back(pair)
