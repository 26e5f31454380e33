"""A field became required, is no longer required, or was deleted while it was required.

A receiver for which the field is required rejects every message that lacks the field. So senders and receivers would
have to change at the same moment.

Bad::

    message Id { optional int32 board = 1; }   // before
    message Id { required int32 board = 1; }   // after

Good::

    message Id { optional int32 board = 1; }
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import MessagePair, SchemaChange, each_once, messages
from roverlink.generator.lint.comparison.cardinality import required_changes
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration, declaration_of_old
from roverlink.generator.lint.fixits.put_back_or_reserve import put_back
from roverlink.generator.protos.schema import ProtoField

RULE = Rule("WIR104", "required-field-changed", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field number that is `required` only before the change, or only after it.

    Fields that are repeated on the other side are left out, because another rule reports them.
    """
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        for old, new in required_changes(pair):
            if new is not None and new.label == "required":
                yield _added(pair, old, new)
            elif old is not None:
                yield _not_any_more(pair, old, new)


def _not_any_more(pair: MessagePair, old: ProtoField, new: ProtoField | None) -> Diagnostic:
    became, help = f"was deleted from {pair.new.full_name!r}", put_back(pair, old)
    if new is not None:
        declared = declaration(old, pair.change.before, pair.old.full_name, pair.syntax)
        became, help = "is no longer required", f"put back `{declared}`"
    return RULE.at(
        new.span if new else pair.new.span,
        f"`{old.name} = {old.number}` was required, and {became}: older receivers reject messages without it",
        help,
        pair.change.earlier(old.span, f"it was `{declaration_of_old(pair, old)}` here"),
        type=pair.new.full_name,
        number=old.number,
    )


def _added(pair: MessagePair, old: ProtoField | None, new: ProtoField) -> Diagnostic:
    became, place, known = "is new and required", pair.old.span, "the message was here, without it"
    if old is not None:
        became, place, known = (
            "is now required, but was not before",
            old.span,
            f"it was `{declaration_of_old(pair, old)}` here",
        )
    optional = dataclasses.replace(new, label="optional")
    return RULE.at(
        new.span,
        f"`{new.name} = {new.number}` {became}: messages of older senders, without this field, are rejected",
        f"write `{declaration(optional, pair.change.after, pair.new.full_name, pair.syntax)}`",
        pair.change.earlier(place, known),
        type=pair.new.full_name,
        number=new.number,
    )
