"""A 64-bit integer has another type in JavaScript.

With `jstype`, code has a string or a number, or what the generator takes by itself.

Bad::

    message Wheel { int64 ticks = 1; }                        // before
    message Wheel { int64 ticks = 1 [jstype = JS_STRING]; }   // after

Good::

    message Wheel { int64 ticks = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, fields
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC114", "jstype-changed", __doc__, Severity.WARNING)
_TYPES = frozenset({"int64", "uint64", "sint64", "fixed64", "sfixed64"})


def check(subject: Subject) -> Iterator[Diagnostic]:
    """64-bit integers with another `jstype`."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        old, new = (field.facets.get("jstype", "JS_NORMAL") for field in (pair.old, pair.new))
        if old != new and {pair.old.type, pair.new.type} <= _TYPES and not change.of_ledger:
            yield RULE.at(
                pair.new.at("jstype"),
                f"jstype of {pair.new.name} = {pair.new.number} was {old} and is {new} now",
                f"put back `[jstype = {old}]`",
                earlier(change, pair.old.at("jstype"), f"it was {old} here"),
                type=pair.owner,
                number=pair.new.number,
            )
