"""A message or an enum is gone.

Code that uses it does not compile any more. What fields with its type became is said at them.

Bad::

    message Imu { ... }    // before
    message Gyro { ... }   // after, for what was Imu

Good::

    message Imu { ... }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier
from generator.changes.absences import absent_types, heir
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC107", "type-deleted", __doc__, Severity.WARNING)
_OR_CHANGE = "or change the code that uses it on every side"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Messages and enums whose full name nothing has any more; the ledger does not say what is still in use."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Diagnostic]:
    for absence in absent_types(subject, change):
        if absence.new is None:
            old, now = absence.old, heir(change, absence.old)
            file = "" if old.file in change.after.files else ", and so is that file"
            alike = f"; {now} is new and has the same contents" if now else ""
            yield RULE.at(
                absence.span,
                f"{old.full_name} is gone from {old.file}{file}{alike}",
                f"{f'rename {now} back to {old.full_name}' if now else 'put it back'}, {_OR_CHANGE}",
                [] if absence.span == old.span else earlier(change, old.span, "it was here"),
                type=old.full_name,
            )
