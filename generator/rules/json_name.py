"""JSON has another name for a field that is still called the same.

What was written under the old name is ignored, or refused.

Bad::

    message Imu { float heading = 1; }                       // before
    message Imu { float heading = 1 [json_name = "yaw"]; }   // after

Good::

    message Imu { float heading = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, fields
from generator.changes.renames import Rename, json_name_changed, rename
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN105", "json-name-changed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields with another `json_name`; what follows from a new name is said there."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if rename(pair) is Rename.NONE and json_name_changed(pair) and not change.of_ledger:
            yield RULE.at(
                pair.new.at("json_name"),
                f"{pair.new.name} = {pair.new.number} was {pair.old.json_name} in JSON and is {pair.new.json_name} now",
                f'put back the name with `[json_name = "{pair.old.json_name}"]`',
                earlier(change, pair.old.at("json_name"), f"it was {pair.old.json_name} here"),
                type=pair.owner,
                number=pair.new.number,
            )
