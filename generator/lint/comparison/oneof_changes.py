"""Compatibility of a field's old and new oneof: tells if bytes are misread.

A receiver that reads two members of a oneof keeps the last one and drops the other. So the other members of a field's
oneof matter, as far as both sides know them (protobuf.dev/programming-guides/proto3, "Updating A Message Type" and
"Backwards-compatibility issues" of oneofs). The oneof's name is not sent.
"""

from __future__ import annotations

from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.protos.schema import ProtoField, ProtoMessage


def broken_by_oneof(pair: FieldPair) -> bool:
    """Return True if bytes are misread because the field joined or left a oneof."""
    if pair.messages is None or pair.old.oneof == pair.new.oneof:
        return False
    old, new = pair.messages.old, pair.messages.new
    shared = {field.number for field in old.fields} & {field.number for field in new.fields}
    return partners(old, pair.old) & shared != partners(new, pair.new) & shared


def partners(message: ProtoMessage, field: ProtoField) -> set[int]:
    """Return the numbers of the other fields in a field's oneof."""
    if not field.oneof:
        return set()
    return {one.number for one in message.fields if one.oneof == field.oneof} - {field.number}


def moved_text(pair: FieldPair) -> str:
    """Describe how a field moved."""
    what = f"the field `{pair.new.name} = {pair.new.number}`"
    if not pair.old.oneof:
        return f"{what} is now in the oneof {pair.new.oneof!r}"
    if not pair.new.oneof:
        return f"{what} is no longer in the oneof {pair.old.oneof!r}"
    return f"{what} was in the oneof {pair.old.oneof!r} and is now in {pair.new.oneof!r}"


def moved_back(pair: FieldPair) -> str:
    """Describe how to undo the move."""
    if pair.old.oneof:
        return f"put the field back into the oneof {pair.old.oneof!r}"
    return f"take the field out of the oneof {pair.new.oneof!r}"
