"""The name of a deleted enum value is not reserved.

Its number is, so bytes are safe. JSON has an enum's names: a new value of that name would be read out of what was
written about the old one.

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }   // before
    enum Mode { reserved 1; IDLE = 0; }  // after

Good::

    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, gone_values
from generator.changes.cures import names_in_use, value_back_or_reserve
from generator.changes.ranges import covers
from generator.changes.spelling import value_place
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN108", "enum-value-name-freed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Values that are gone and whose number is reserved, with a name that neither is nor belongs to another value."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair, number, names in gone_values(change):
        kept = {*pair.new.reserved_names, *names_in_use(pair.new)}
        free = [name for name in names if name not in kept]
        if covers(pair.new.reserved, number) and free:
            yield RULE.at(
                pair.new.span,
                f"{', '.join(free)} = {number} is gone from {pair.new.full_name}, and the name is not reserved",
                value_back_or_reserve(pair, number, names),
                earlier(change, value_place(pair.old, number), "it was here"),
                type=pair.new.full_name,
                number=number,
            )
