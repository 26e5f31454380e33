"""A message or an enum is not meant for JSON any more.

With the feature `json_format` no longer ALLOW, as in proto2, protoc does not see to it that names in JSON are distinct,
and runtimes may refuse to write or read it.

Bad::

    message Imu { float heading = 1; }                                                     // before
    message Imu { option features.json_format = LEGACY_BEST_EFFORT; float heading = 1; }   // after

Good::

    message Imu { float heading = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import EnumPair, MessagePair, each_once, earlier, enums, messages
from generator.changes.cures import type_feature
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN106", "json-support-dropped", __doc__, Severity.WARNING)
_FULL = "ALLOW"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Messages and enums whose `json_format` was ALLOW."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    pairs: list[MessagePair | EnumPair] = [*messages(change), *enums(change)]
    for pair in pairs:
        old, new = (one.facets.get("json_format", "") for one in (pair.old, pair.new))
        if old == _FULL != new:
            yield RULE.at(
                pair.new.at("json_format"),
                f"json_format of {pair.new.full_name} was {old} and is {new or 'unknown'} now",
                type_feature(pair, "json_format", _FULL),
                earlier(change, pair.old.at("json_format"), f"it was {old} here"),
                type=pair.new.full_name,
            )
