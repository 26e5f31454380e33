"""A message or an enum is declared in another file.

What travels is the same. Code includes or imports what is generated from the old file, and does not find it there.

Bad::

    // imu.proto before, sensors.proto after
    message Imu { float heading = 1; }

Good::

    // imu.proto, and nothing else than this in it
    import public "sensors.proto";
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier
from generator.changes.absences import absent_types
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC108", "type-moved", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Messages and enums that another file declares than before, which the old one does not hand on."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Diagnostic]:
    for absence in absent_types(subject, change):
        if absence.new is not None:
            old, new = absence.old, absence.new
            was = [] if absence.span == old.span else earlier(change, old.span, "it was here")
            yield RULE.at(
                absence.span,
                f"{old.full_name} moved from {old.file} to {new.file}",
                f'put it back; or let {old.file} stay with `import public "{new.file}";`',
                [(new.span, "it is here now"), *was],
                type=old.full_name,
            )
