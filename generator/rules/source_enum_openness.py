"""An enum is open now and was closed, or the other way round.

A receiver keeps a number that it does not know in a field of an open enum. Of a closed one it leaves the field unset,
so that the value is read as the first one.

Bad::

    enum Mode { IDLE = 0; }                                             // before
    enum Mode { option features.enum_type = CLOSED; IDLE = 0; }         // after

Good::

    enum Mode { IDLE = 0; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, enums
from generator.changes.cures import type_feature
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC112", "enum-openness-changed", __doc__, Severity.WARNING)
_CONSEQUENCE = {
    "OPEN": "code is given numbers that no value has",
    "CLOSED": "what is sent with a number that no value has is read as the first value",
}


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Enums with another `enum_type`."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in enums(change):
        old, new = (enum.facets.get("enum_type", "") for enum in (pair.old, pair.new))
        if old != new and not change.of_ledger:
            yield RULE.at(
                pair.new.at("enum_type"),
                f"{pair.new.full_name} was {old.lower()} and is {new.lower()} now: {_CONSEQUENCE[new]}",
                type_feature(pair, "enum_type", old),
                earlier(change, pair.old.at("enum_type"), f"it was {old.lower()} here"),
                type=pair.new.full_name,
            )
