"""A field was deleted, as it should be: its number is reserved, and so is its name, or another field has it now.

Nothing that travels is misread. Code that uses the field does not compile any more.

Bad::

    message Imu { float x = 1; float y = 2; }                // before, while code uses y
    message Imu { float x = 1; reserved 2; reserved "y"; }   // after

Good::

    message Imu { float x = 1; float y = 2 [deprecated = true]; }   // until nothing uses y
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import MessagePair, each_once, earlier, gone_fields
from generator.changes.cures import names_in_use
from generator.changes.ranges import covers
from generator.changes.spelling import declaration_of_old
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.protos import ProtoField
from generator.subject import Change, Subject

RULE = Rule("SRC102", "field-deleted", __doc__, Severity.HINT)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are gone with their numbers reserved, and whose names are as well, or moved to other numbers.

    That a required one is gone has a rule of its own.
    """
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair, field in gone_fields(change):
        kept = field.name in pair.new.reserved_names or field.name in names_in_use(pair.new)
        if covers(pair.new.reserved, field.number) and kept and field.label != "required":
            message, help = _told(pair, field)
            yield RULE.at(
                pair.new.span,
                message,
                help,
                earlier(change, field.span, f"it was `{declaration_of_old(pair, field)}` here"),
                type=pair.new.full_name,
                number=field.number,
            )


def _told(pair: MessagePair, field: ProtoField) -> tuple[str, str]:
    """The message and the help."""
    moved = names_in_use(pair.new).get(field.name)
    if moved is None:
        return (
            f"{field.name} = {field.number} is gone from {pair.new.full_name}",
            "change the code that uses it; its number and its name are reserved, as they should be",
        )
    return (
        f"{field.name} moved from number {field.number} to {moved}: JSON takes the one for the other",
        "nothing, if it is the same thing; else call the new one something else, and reserve the name",
    )
