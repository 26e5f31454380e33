"""An absent field is read as something else than before.

A default never travels: the sender leaves the field out, and each side fills in the value that it was compiled with.
The two then go on with different values for the same message.

Bad::

    message Pid { optional float gain = 1 [default = 1.5]; }   // before
    message Pid { optional float gain = 1 [default = 2]; }     // after

Good::

    message Pid { optional float gain = 1 [default = 1.5]; }   // and send 2 where 2 is meant
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import Breaks, each_once, earlier, fields
from generator.changes.defaults import default_changed, shown
from generator.changes.types import broken_by_type
from generator.findings import Finding, Rule
from generator.subject import Change, Subject

RULE = Rule("WIR108", "field-default-changed")


def check(subject: Subject) -> Iterator[Finding]:
    """Fields with another default, unless their type is already said to be another."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in fields(change):
        if default_changed(pair) and broken_by_type(pair) is not Breaks.WIRE:
            old, new = shown(pair.old, change.before), shown(pair.new, change.after)
            yield RULE.at(
                pair.new.at("default"),
                f"{pair.new.name} = {pair.new.number} was {old} where it is absent, and is {new} now",
                f"put back the default {old}, and send {new} where that is meant",
                earlier(change, pair.old.at("default"), f"it was {old} here"),
                type=pair.owner,
                number=pair.new.number,
            )
