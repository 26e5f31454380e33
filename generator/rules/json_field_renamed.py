"""A field has another name, and so has its value in JSON.

Bytes carry the number alone. JSON, logs, saved parameters and generated code know the name; what was written under the
old one is ignored, or refused.

Bad::

    message Imu { float heading = 1; }       // before
    message Imu { float heading_raw = 1; }   // after

Good::

    message Imu { float heading_raw = 1 [json_name = "heading"]; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import FieldPair, each_once, earlier, fields
from generator.changes.cures import back, was
from generator.changes.renames import Rename, json_name_changed, old_json_name, rename, renamed
from generator.changes.spelling import declaration
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN104", "field-renamed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Fields that are called something else in JSON too, and still seem to be the same thing."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if rename(pair) is Rename.WORDING and json_name_changed(pair):
            yield RULE.at(
                pair.new.at("name"),
                f"{renamed(pair)}, in JSON too",
                _help(pair),
                earlier(change, pair.old.at("name"), f"it was `{was(pair)}` here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _help(pair: FieldPair) -> str:
    if pair.moved:
        return "put it back where it was"
    name = "" if pair.extension or pair.in_map_entry else old_json_name(pair)
    if not name:
        return back(pair)
    kept = declaration(pair.new, pair.change.after, pair.owner, pair.syntax, json_name=name)
    return f"{back(pair)}, or keep its name in JSON: `{kept}`"
