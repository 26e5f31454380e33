"""The name of a deleted field is not reserved.

Its number is, so bytes are safe. A new field of that name would read the old one's values out of JSON, logs and saved
parameters.

Bad::

    message Imu { float x = 1; reserved 2; }   // before, y was 2

Good::

    message Imu { float x = 1; reserved 2; reserved "y"; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, gone_fields
from generator.changes.cures import names_in_use, put_back_or_reserve
from generator.changes.ranges import covers
from generator.changes.spelling import declaration_of_old
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN102", "field-name-freed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are gone and whose number is reserved, but not their name, which no other field has either."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair, field in gone_fields(change):
        free = field.name not in pair.new.reserved_names and field.name not in names_in_use(pair.new)
        if covers(pair.new.reserved, field.number) and free:
            yield RULE.at(
                pair.new.span,
                f"{field.name} = {field.number} is gone from {pair.new.full_name}, and its name is not reserved",
                put_back_or_reserve(pair, field),
                earlier(change, field.span, f"it was `{declaration_of_old(pair, field)}` here"),
                type=pair.new.full_name,
                number=field.number,
            )
