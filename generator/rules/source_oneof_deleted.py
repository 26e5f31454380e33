"""A oneof is gone, or is called something else.

Its name never travels. Code that asks which of its fields is set does not compile any more; what became of its fields
is said at them.

Bad::

    message Order { oneof command { int32 stop = 1; } }   // before
    message Order { oneof order { int32 stop = 1; } }     // after

Good::

    message Order { oneof command { int32 stop = 1; } }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import MessagePair, each_once, earlier, messages
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC105", "oneof-deleted", Severity.WARNING)


def check(subject: Subject) -> Iterator[Finding]:
    """Oneofs whose name no oneof of the message has any more."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in messages(change):
        for name in pair.old.oneofs:
            if name not in pair.new.oneofs:
                yield RULE.at(
                    pair.new.span,
                    _message(pair, name),
                    f"put back `oneof {name}`, or change the code that uses it on every side",
                    earlier(change, pair.old.at(f"oneof {name}"), "it was here"),
                    type=pair.new.full_name,
                )


def _message(pair: MessagePair, name: str) -> str:
    members = {field.number for field in pair.old.fields if field.oneof == name}
    now = sorted({field.oneof for field in pair.new.fields if field.number in members and field.oneof})
    where = f"; its fields are in {', '.join(now)} now" if now else ""
    return f"the oneof {name} is gone from {pair.new.full_name}{where}"
