"""A field has another name, and JSON still calls it what it did.

Nothing that travels changes, but for JSON that was written with the names of the .proto file. Code that uses the field
has to change.

Bad::

    message Imu { float rawHeading = 1; }    // before
    message Imu { float raw_heading = 1; }   // after: both are rawHeading in JSON

Good::

    message Imu { float rawHeading = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, fields
from generator.changes.cures import back, was
from generator.changes.renames import Rename, json_name_changed, rename, renamed
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC104", "field-renamed-in-code", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are called something else, though not in JSON."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if rename(pair) is Rename.WORDING and not json_name_changed(pair):
            yield RULE.at(
                pair.new.at("name"),
                renamed(pair),
                f"{back(pair)}, or change the code that uses it on every side",
                earlier(change, pair.old.at("name"), f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )
