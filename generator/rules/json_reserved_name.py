"""A name that was reserved is not any more.

It was reserved because something was called that. A new field or value of the name would read the old one's values out
of JSON, logs and saved parameters.

Bad::

    message Imu { reserved 2; reserved "y"; float x = 1; }   // before
    message Imu { reserved 2; float x = 1; }                 // after

Good::

    message Imu { reserved 2; reserved "y"; float x = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import EnumPair, MessagePair, each_once, earlier, enums, messages
from generator.changes.cures import names_in_use, reserve_names
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("JSN109", "reserved-name-freed", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Names of messages and enums that were reserved."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    pairs: list[MessagePair | EnumPair] = [*messages(change), *enums(change)]
    for pair in pairs:
        used = names_in_use(pair.new)
        for name in dict.fromkeys(pair.old.reserved_names):
            if name not in pair.new.reserved_names:
                yield RULE.at(
                    pair.new.span,
                    f'{pair.new.full_name} does not reserve "{name}" any more{_use(name, used)}',
                    _help(name, used, reserve_names([name], pair.syntax)),
                    earlier(change, pair.old.at(f"reserved {name}"), "reserved here"),
                    type=pair.new.full_name,
                )


def _use(name: str, used: dict[str, int]) -> str:
    return f", and uses it for {name} = {used[name]}" if name in used else ""


def _help(name: str, used: dict[str, int], reserved: str) -> str:
    back = f"put back `{reserved}`"
    return f"call {name} = {used[name]} something else, and {back}" if name in used else back
