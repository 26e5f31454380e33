"""A field is required now and was not before, or is not any more, or went although it was.

Whoever knows a field as required refuses every message without it, the whole of it. Both sides would have to change at
the same moment.

Bad::

    message Id { optional int32 board = 1; }   // before
    message Id { required int32 board = 1; }   // after

Good::

    message Id { optional int32 board = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import MessagePair, each_once, earlier, messages
from generator.changes.spelling import declaration
from generator.findings import Finding, Rule
from generator.protos import ProtoField, ProtoMessage
from generator.subject import Change, Subject

RULE = Rule("WIR104", "required-field-changed")


def check(subject: Subject) -> Iterator[Finding]:
    """Numbers that are required on one side alone."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in messages(change):
        before, after = _required(pair.old), _required(pair.new)
        yield from (_gone(pair, field) for number, field in before.items() if number not in after)
        yield from (_added(pair, field) for number, field in after.items() if number not in before)


def _required(message: ProtoMessage) -> dict[int, ProtoField]:
    return {field.number: field for field in message.fields if field.label == "required"}


def _gone(pair: MessagePair, field: ProtoField) -> Finding:
    was = declaration(field, pair.change.before, pair.old.full_name)
    message = f"`{was}` is not required any more: older receivers refuse messages without it"
    also = earlier(pair.change, field.span, "it was here")
    return RULE.at(
        pair.new.span, message, f"put back `{was}`", also, type=pair.new.full_name, number=field.number
    )  # fmt: skip


def _added(pair: MessagePair, field: ProtoField) -> Finding:
    message = f"{field.name} = {field.number} is required now: messages of older senders are refused"
    kept = declaration(field, pair.change.after, pair.new.full_name).replace("required ", "optional ", 1)
    return RULE.at(field.span, message, f"write `{kept}`", type=pair.new.full_name, number=field.number)
