"""A field is in another oneof than before, and with the same fields.

It is alone there, or among new fields. What travels is the same; code that asks which field of the oneof is set has to
change.

Bad::

    message Order { int32 stop = 1; }                                // before
    message Order { oneof order { int32 stop = 1; bool go = 2; } }   // after

Good::

    message Order { int32 stop = 1; oneof order { bool go = 2; } }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.oneofs import broken_by_oneof, moved_back, moved_text, said_of_the_oneof
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC106", "oneof-of-a-field-changed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are in another oneof, in the same company, while the one that they were in is still there."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if broken_by_oneof(pair) is Breaks.CODE and not said_of_the_oneof(pair):
            yield RULE.at(
                pair.new.span,
                moved_text(pair),
                f"{moved_back(pair)}, or change the code that uses it on every side",
                earlier(change, pair.old.span, "it was here"),
                type=pair.owner,
                number=pair.new.number,
            )
