"""Rules about changes of fields that other programs misread: type, cardinality, default, oneof."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from operator import attrgetter

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.lint.comparison import FieldPair, MessagePair, SchemaChange, each_once, fields, messages
from roverlink.generator.lint.comparison.cardinality import (
    broken_by_cardinality,
    cardinalities,
    only_required,
    required_changes,
    shown,
)
from roverlink.generator.lint.comparison.default_values import default, default_changed
from roverlink.generator.lint.comparison.default_values import shown as shown_default
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.comparison.oneof_changes import broken_by_oneof, moved_back, moved_text
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration, declaration_of_old, retyping, type_place
from roverlink.generator.lint.fixits.put_back_or_reserve import back, put_back
from roverlink.generator.lint.free_numbers import NewNumbers, back_or_renumber, changed_field
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.schema import ProtoField


class FieldTypeChangedOnTheWire(LintRule, id="WIR101"):
    """A field has a new type that reads the same bytes differently.

    Bytes carry a field's number and its wire type, but not its declared type (encoding guide, "Message Structure"). A
    board with old firmware still sends the old type. The rover reads wrong values from its bytes, or no value, without
    an error.

    Bad::

        message Imu { float heading = 3; }   // before
        message Imu { int32 heading = 3; }   // after

    Good::

        message Imu { reserved 3; int32 heading = 4; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field whose new type misreads bytes of the old type."""
        return each_once(context.changes, lambda change: _retyped(context, change))


def _retyped(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if broken_by_type(pair):
            yield changed_field(FieldTypeChangedOnTheWire, numbers, pair, retyping(pair), type_place)


_WITHOUT_PACKED_LISTS = frozenset({"string", "bytes", "message", "group"})


class FieldCardinalityChangedOnTheWire(LintRule, id="WIR103"):
    """A field changes between one value and many values.

    A list of numbers is packed into one length-delimited value, which is not a number (encoding guide, "Packed Repeated
    Fields"). A receiver that expects one number skips such a list. If it gets several single values, it keeps only the
    last one.

    Bad::

        message Arm { float joint = 1; }            // before
        message Arm { repeated float joint = 1; }   // after

    Good::

        message Arm { reserved 1; reserved "joint"; repeated float joints = 2; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field that changed between a single value, repeated values and a map.

        Changes from or to `required` are left out, because another rule checks them.
        """
        return each_once(context.changes, lambda change: _recounted(context, change))


def _recounted(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        old, new = cardinalities(pair)
        if broken_by_cardinality(old, new) and not only_required(old, new):
            message = (
                f"`{pair.new.name} = {pair.new.number}` was {shown(old)} and is now {shown(new)}: {_consequence(pair)}"
            )
            yield changed_field(FieldCardinalityChangedOnTheWire, numbers, pair, message, attrgetter("span"))


def _consequence(pair: FieldPair) -> str:
    lost = "a receiver that expects one value keeps only the last of several values"
    if {pair.old.type, pair.new.type} <= _WITHOUT_PACKED_LISTS:
        return lost
    return f"{lost}, and skips a packed list"


class RequiredFieldChanged(LintRule, id="WIR104"):
    """A field became required, is no longer required, or was deleted while it was required.

    A receiver for which the field is required rejects every message that lacks the field. So senders and receivers
    would have to change at the same moment.

    Bad::

        message Id { optional int32 board = 1; }   // before
        message Id { required int32 board = 1; }   // after

    Good::

        message Id { optional int32 board = 1; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field number that is `required` only before the change, or only after it.

        Fields that are repeated on the other side are left out, because another rule reports them.
        """
        return each_once(context.changes, _required)


def _required(change: SchemaChange) -> Iterator[Diagnostic]:
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
    return RequiredFieldChanged.at(
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
    return RequiredFieldChanged.at(
        new.span,
        f"`{new.name} = {new.number}` {became}: messages of older senders, without this field, are rejected",
        f"write `{declaration(optional, pair.change.after, pair.new.full_name, pair.syntax)}`",
        pair.change.earlier(place, known),
        type=pair.new.full_name,
        number=new.number,
    )


class FieldMovedBetweenOneofs(LintRule, id="WIR105"):
    """A field moved into a oneof, out of a oneof, or to a oneof with other members.

    A receiver keeps only the last member of a oneof that it reads (encoding guide, "Last One Wins"). If one side sends
    two fields, and the other side has both in one oneof, all but one are lost.

    Bad::

        message Order { int32 stop = 1; int32 go = 2; }             // before
        message Order { oneof what { int32 stop = 1; int32 go = 2; } }   // after

    Good::

        message Order { int32 stop = 1; int32 go = 2; oneof what { int32 halt = 3; int32 run = 4; } }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field that is together with other fields in a oneof than before."""
        return each_once(context.changes, lambda change: _moved(context, change))


def _moved(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        if broken_by_oneof(pair):
            yield FieldMovedBetweenOneofs.at(
                pair.new.span,
                f"{moved_text(pair)}: a receiver keeps only the last field of a oneof",
                back_or_renumber(numbers, pair, moved_back(pair)),
                change.earlier(pair.old.span, "it was here"),
                type=pair.owner,
                number=pair.new.number,
            )


class FieldDefaultChanged(LintRule, id="WIR108"):
    """The default value of a field changed, so an absent field is read as another value than before.

    A message does not contain the default. If the sender does not set the field, nothing is sent for it, and the
    receiver uses the default that it was compiled with. After the change, old and new programs read different values
    from the same message.

    Bad::

        message Pid { optional float gain = 1 [default = 1.5]; }   // before
        message Pid { optional float gain = 1 [default = 2]; }     // after

    Good::

        message Pid { optional float gain = 1 [default = 1.5]; }   // and send 2 where 2 is meant
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field with another default than before.

        Fields with an incompatible type are left out.
        """
        return each_once(context.changes, _redefaulted)


def _redefaulted(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if default_changed(pair) and not broken_by_type(pair):
            old, new = shown_default(pair.old, change.before), shown_default(pair.new, change.after)
            yield FieldDefaultChanged.at(
                pair.new.at("default"),
                f"`{pair.new.name} = {pair.new.number}`, if absent, was read as {old}, and is now read as {new}",
                f"{_undo(pair)}, and set the field to {new} in each message where this value is meant",
                change.earlier(pair.old.at("default"), f"it was {old} here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _undo(pair: FieldPair) -> str:
    if (pair.old.type, pair.old.type_name) != (pair.new.type, pair.new.type_name):
        return back(pair)
    if "default" in pair.new.facets and "default" not in pair.old.facets:
        return "remove the default again"
    value = _old_value(pair)
    declared = _with_default(pair, value) if value and pair.syntax.name != "proto3" else ""
    if "default" in pair.old.facets:
        return f"put back `{declared}`" if declared else back(pair)
    first = f"put {value or shown_default(pair.old, pair.change.before)} first in the enum {pair.new.type_name!r} again"
    return f"write `{declared}`, or {first}" if declared else first


def _old_value(pair: FieldPair) -> str:
    """Return the old default of a field; for an enum, the current name of its number, or empty if there is none."""
    if pair.new.type != "enum":
        return pair.old.facets["default"]
    number = default(pair.old, pair.change.before)
    values = pair.change.after.enums[pair.new.type_name].values
    return next((value.name for value in values if value.number == number), "")


def _with_default(pair: FieldPair, value: str) -> str:
    field = dataclasses.replace(pair.new, facets={**pair.new.facets, "default": value})
    return declaration(field, pair.change.after, pair.owner, pair.syntax)


_OPTION = "message_set_wire_format"


class MessageSetFormatChanged(LintRule, id="WIR109"):
    """The option `message_set_wire_format` of a message changed.

    With this option, each extension is encoded as a group that contains the number of the extension. A program that
    uses one of the two formats cannot read the other.

    Bad::

        message Extras { extensions 4 to max; }   // before
        message Extras { option message_set_wire_format = true; extensions 4 to max; }   // after

    Good::

        message Extras { extensions 4 to max; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each message whose option `message_set_wire_format` changed."""
        return each_once(context.changes, _reformatted)


def _reformatted(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        old, new = (message.facets.get(_OPTION, "false") for message in (pair.old, pair.new))
        if old != new and not change.of_ledger:
            yield MessageSetFormatChanged.at(
                pair.new.span,
                f"{_OPTION} of {pair.new.full_name!r} was {old}, and is now {new}: no program reads both formats",
                f"put back `option {_OPTION} = true;`" if old == "true" else f"remove `option {_OPTION} = true;`",
                change.earlier(pair.old.span, f"it was {old} here"),
                type=pair.new.full_name,
            )
