"""Compatibility of a field's old and new oneof: decides if a new receiver misreads bytes of an old sender.

A receiver that reads two members of a oneof keeps the last one and drops the other. So a change of the other members
matters if sender and receiver both know these members (protobuf.dev/programming-guides/proto3, "Updating A Message
Type" and "Backwards-compatibility issues" of oneofs). The name of the oneof is not sent, and may change.
"""

from __future__ import annotations

from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.protos.schema import ProtoField, ProtoMessage


def broken_by_oneof(pair: FieldPair) -> bool:
    """Return True if a receiver misreads bytes because the field moved into or out of a oneof."""
    if pair.messages is None or pair.old.oneof == pair.new.oneof:
        return False
    old, new = pair.messages.old, pair.messages.new
    # A new member is no break: only a sender that knows it sends it, and a receiver that does not know it skips it.
    shared = {field.number for field in old.fields} & {field.number for field in new.fields}
    return partners(old, pair.old) & shared != partners(new, pair.new) & shared


def partners(message: ProtoMessage, field: ProtoField) -> set[int]:
    """Return the numbers of the other members of the field's oneof; empty if the field is in no oneof."""
    if not field.oneof:
        return set()
    return {member.number for member in message.fields if member.oneof == field.oneof} - {field.number}


def moved_text(pair: FieldPair) -> str:
    """Return a text that says how a field moved into, out of, or between oneofs."""
    what = f"the field `{pair.new.name} = {pair.new.number}`"
    if not pair.old.oneof:
        return f"{what} is now in the oneof {pair.new.oneof!r}"
    if not pair.new.oneof:
        return f"{what} is no longer in the oneof {pair.old.oneof!r}"
    return f"{what} was in the oneof {pair.old.oneof!r} and is now in {pair.new.oneof!r}"


def moved_back(pair: FieldPair) -> str:
    """Return a text that says how to undo a field's move into, out of, or between oneofs."""
    if pair.old.oneof:
        return f"put the field back into the oneof {pair.old.oneof!r}"
    return f"take the field out of the oneof {pair.new.oneof!r}"
