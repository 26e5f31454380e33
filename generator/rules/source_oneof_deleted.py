"""A oneof is gone, or is called something else.

Its name never travels. Code that asks which of its fields is set does not compile any more. What of its fields is read
differently is said at them.

Bad::

    message Order { oneof command { int32 stop = 1; } }   // before
    message Order { oneof order { int32 stop = 1; } }     // after

Good::

    message Order { oneof command { int32 stop = 1; } }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import MessagePair, each_once, earlier, messages
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.protos import ProtoField
from generator.subject import Change, Subject

RULE = Rule("SRC105", "oneof-deleted", __doc__, Severity.WARNING)


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Oneofs whose name no oneof of the message has any more."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in messages(change):
        for name in pair.old.oneofs:
            if name not in pair.new.oneofs:
                yield RULE.at(
                    pair.new.span,
                    _message(pair, name),
                    f"{_cure(pair, name)}, or change the code that uses it on every side",
                    earlier(change, pair.old.at(f"oneof {name}"), "it was here"),
                    type=pair.new.full_name,
                )


def _message(pair: MessagePair, name: str) -> str:
    left = _left(pair, name)
    now = ", ".join(sorted({field.oneof for field in left if field.oneof}))
    alone = ", ".join(field.name for field in left if not field.oneof)
    where = [f"its fields are in {now} now"] * bool(now) + [f"no oneof has {alone} any more"] * bool(alone)
    return "; ".join([f"the oneof {name} is gone from {pair.new.full_name}", *where])


def _cure(pair: MessagePair, name: str) -> str:
    left = _left(pair, name)
    if not left:
        return "put it back with its fields"
    [now, *others] = sorted({field.oneof for field in left})
    if now and not others and now not in pair.old.oneofs:
        return f"rename the oneof {now} back to {name}"
    return f"put {', '.join(field.name for field in left)} back into `oneof {name}`"


def _left(pair: MessagePair, name: str) -> list[ProtoField]:
    """The fields that were in the oneof and are still there."""
    members = {field.number for field in pair.old.fields if field.oneof == name}
    return [field for field in pair.new.fields if field.number in members]
