"""A field is a map now and was a list of the same entries, or the other way round.

The bytes are the same; JSON has an object for a map, and an array for a list.

Bad::

    message Log { map<string, int32> counts = 1; }   // before
    message Log {                                    // after
      message CountsEntry { string key = 1; int32 value = 2; }
      repeated CountsEntry counts = 1;
    }

Good::

    message Log { map<string, int32> counts = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.cardinality import MAP, broken_by_cardinality, cardinalities
from generator.changes.cures import back, was
from generator.changes.types import broken_by_type
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN103", "field-cardinality-changed-in-json", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that hold another number of values, as JSON shows and bytes do not; and whose bytes can be read."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        old, new = cardinalities(pair)
        of_json = broken_by_cardinality(old, new) is Breaks.JSON
        if of_json and broken_by_type(pair) is not Breaks.WIRE:
            form = "an object where it had an array" if new == MAP else "an array where it had an object"
            yield RULE.at(
                pair.new.span,
                f"{pair.new.name} = {pair.new.number} was {old} and is {new} now: JSON has {form}",
                back(pair),
                earlier(change, pair.old.span, f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )
