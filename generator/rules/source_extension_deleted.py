"""An extension is gone, has another number, or stands in another file.

A receiver does not know the old number any more and skips what is sent with it. Code that uses the extension does not
find it where it was.

Bad::

    extend Rover { optional int32 bonus = 100; }   // before
    extend Rover { optional int32 bonus = 110; }   // after

Good::

    extend Rover { optional int32 bonus = 100; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier
from generator.changes.absences import absent_extensions
from generator.changes.spelling import declaration
from generator.diagnostics import Diagnostic, Rule, Severity, Span
from generator.protos import ProtoExtension, Schema
from generator.subject import Change, Subject

RULE = Rule("SRC109", "extension-deleted", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Extensions whose number of their message nothing has any more, or something in a file out of reach."""
    return each_once(subject, lambda change: _findings(subject, change))


def _findings(subject: Subject, change: Change) -> Iterator[Diagnostic]:
    for old, new, missed in absent_extensions(subject, change):
        was = declaration(old.field, change.before, old.extendee, change.before.syntax_of(old.file))
        what, span = _became(old, new, missed, change.after)
        yield RULE.at(
            span,
            f"`extend {old.extendee} {{ {was} }}` {what}",
            "put it back, or change the code that uses it on every side",
            [] if span == old.field.span else earlier(change, old.field.span, "it was here"),
            type=old.extendee,
            number=old.field.number,
        )


def _became(old: ProtoExtension, new: ProtoExtension | None, missed: Span, after: Schema) -> tuple[str, Span]:
    """What became of an extension, and where to say so."""
    if new is not None:
        return f"moved from {old.file} to {new.file}", missed
    for other in after.extensions:
        if (other.extendee, other.scope, other.field.name) == (old.extendee, old.scope, old.field.name):
            return f"has the number {other.field.number} now", other.field.at("number")
    return f"is gone from {old.file}", missed
