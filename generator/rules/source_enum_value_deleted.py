"""An enum value was deleted, as it should be: its number and its name are reserved.

Nothing that travels is misread. Code that uses the value does not compile any more.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }                      // before, while code uses DRIVE
    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; }   // after

Good::

    enum Mode { IDLE = 0; DRIVE = 1 [deprecated = true]; }   // until nothing uses it
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, gone_values
from generator.changes.ranges import covers
from generator.changes.spelling import value_place
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC113", "enum-value-deleted", Severity.HINT)


def check(subject: Subject) -> Iterator[Finding]:
    """Values that are gone, and whose number and names are reserved."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair, number, names in gone_values(change):
        if covers(pair.new.reserved, number) and set(names) <= set(pair.new.reserved_names):
            yield RULE.at(
                pair.new.span,
                f"`{', '.join(names)} = {number};` is gone from {pair.new.full_name}",
                "change the code that uses it; its number and its name are reserved, as they should be",
                earlier(change, value_place(pair.old, number), "it was here"),
                type=pair.new.full_name,
                number=number,
            )
