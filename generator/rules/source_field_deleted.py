"""A field was deleted, as it should be: its number and its name are reserved.

Nothing that travels is misread. Code that uses the field does not compile any more.

Bad::

    message Imu { float x = 1; float y = 2; }                // before, while code uses y
    message Imu { float x = 1; reserved 2; reserved "y"; }   // after

Good::

    message Imu { float x = 1; float y = 2 [deprecated = true]; }   // until nothing uses y
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, gone_fields
from generator.changes.ranges import covers
from generator.changes.spelling import declaration
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC102", "field-deleted", Severity.HINT)


def check(subject: Subject) -> Iterator[Finding]:
    """Fields that are gone, and whose number and name are reserved."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair, field in gone_fields(change):
        if covers(pair.new.reserved, field.number) and field.name in pair.new.reserved_names:
            was = declaration(field, change.before, pair.old.full_name)
            yield RULE.at(
                pair.new.span,
                f"`{was}` is gone from {pair.new.full_name}",
                "change the code that uses it; its number and its name are reserved, as they should be",
                earlier(change, field.span, "it was here"),
                type=pair.new.full_name,
                number=field.number,
            )
