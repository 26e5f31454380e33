"""Diagnostics about numbers that belonged to another field or enum value in the ledger, mapping.lock."""

from __future__ import annotations

from collections.abc import Iterator, Set
from typing import TypeVar

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.accepted_past import is_accepted, meaning_of
from roverlink.generator.lint.comparison import EnumPair, FieldPair, MessagePair, SchemaChange, values_by_number
from roverlink.generator.lint.comparison.judged_changes import judge_number, judge_pair
from roverlink.generator.lint.comparison.judgement import Judgement, Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.lint.fixits.put_back_or_reserve import reserve
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared
from roverlink.generator.lint.free_numbers import next_enum_number, next_field_number
from roverlink.generator.lock import Burned
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField

_T = TypeVar("_T")
_KEPT = frozenset({Meaning.SAME, Meaning.RENAMED})


def reused_fields(rule: type[Rule], context: Context, meanings: Set[Meaning]) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each field whose number belonged to a deleted field in the ledger.

    Only fields with one of the given judgements are reported. A field is left out if the ledger also contains it with
    its number, even with another name that means the same.
    """
    change = SchemaChange(context.ledger.schema, context.schema, of_ledger=True)
    for name, gone in context.ledger.gone_fields.items():
        before, after = change.before.messages.get(name), change.after.messages.get(name)
        if before is None or after is None:
            continue
        messages, offered = MessagePair(change, before, after), set[int]()
        for field in after.fields:
            known = [past for past in context.ledger.fields(name) if past.number == field.number]
            known = [past for past in known if not is_accepted(context, name, past, field)]
            pairs = [FieldPair(change, name, past, field, messages, (before.file, after.file)) for past in known]
            judged = [(pair, judge_pair(pair)) for pair in pairs]
            if reused := [(pair, judgement) for pair, judgement in _reused(judged) if pair.old in gone]:
                free = next_field_number(context, name, offered)
                offered |= {free} if free else set()
                yield from (
                    _field(rule, pair, judgement, free) for pair, judgement in reused if judgement.meaning in meanings
                )


def _reused(judged: list[tuple[_T, Judgement]]) -> list[tuple[_T, Judgement]]:
    """Return the judged declarations of a number; an empty list if the number has kept the meaning of one of them."""
    return [] if any(judgement.meaning in _KEPT for _, judgement in judged) else judged


def _field(rule: type[Rule], pair: FieldPair, judged: Judgement, free: int | None) -> Diagnostic:
    old, new = pair.old, pair.new
    was = f"{old.name!r} ({old.wire_type})"
    message = f"number {new.number} of {pair.owner!r} was {was} in the past, and is now {new.name!r}"
    return rule.at(
        new.at("number"),
        message if judged.certain else f"{message}: {judged.reason}",
        _field_help(pair, free) if free else f"declare {new.name!r} in another message",
        [(old.span, "published here")],
        type=pair.owner,
        number=new.number,
    )


def _field_help(pair: FieldPair, free: int) -> str:
    moved = declaration(pair.new, pair.change.after, pair.owner, pair.syntax, free)
    message = pair.change.after.messages[pair.owner]
    freed = reserve(message, pair.syntax, [(pair.old.number, pair.old.number)], [pair.old.name])
    return f"write `{moved} {freed}`: the number {free} is free"


def reused_values(rule: type[Rule], context: Context, meanings: Set[Meaning]) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each enum value whose number belonged to a deleted value in the ledger.

    Only values with one of the given judgements are reported. A value is left out if the ledger also contains it with
    its number, even with another name that means the same.
    """
    change = SchemaChange(context.ledger.schema, context.schema, of_ledger=True)
    for name, gone in context.ledger.gone_values.items():
        before, after = change.before.enums.get(name), change.after.enums.get(name)
        if before is None or after is None:
            continue
        pair, offered = EnumPair(change, before, after), set[int]()
        for number, values in values_by_number(after).items():
            known = [past for past in context.ledger.values(name) if past.number == number]
            known = [past for past in known if not is_accepted(context, name, past, *values)]
            judged = [(past, _judge(pair, past, values)) for past in known]
            if reused := [(old, judgement) for old, judgement in _reused(judged) if old in gone]:
                free = next_enum_number(context, name, offered)
                offered |= {free} if free else set()
                yield from (
                    _value(rule, pair, values, old, judgement, free)
                    for old, judgement in reused
                    if judgement.meaning in meanings
                )


def burned_fields(rule: type[Rule], context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each field with a burned number that it must not have."""
    for name, message in context.schema.messages.items():
        for field in message.fields:
            if burned := context.ledger.must_not_be(name, field.number, meaning_of(field)):
                yield _of_burned(rule, burned, field, next_field_number(context, name))


def burned_values(rule: type[Rule], context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic of the rule for each enum value with a burned number that it must not have."""
    for name, enum in context.schema.enums.items():
        for number, values in values_by_number(enum).items():
            forbidden = [context.ledger.must_not_be(name, number, meaning_of(value)) for value in values]
            # With an alias, the number may have an earlier name beside the one that it may keep.
            if all(forbidden) and forbidden[0]:
                yield _of_burned(rule, forbidden[0], values[0], next_enum_number(context, name))


def _of_burned(rule: type[Rule], burned: Burned, now: ProtoField | ProtoEnumValue, free: int | None) -> Diagnostic:
    was = f"number {burned.number} of {burned.owner!r} was used for {burned.description} in the past"
    return rule.at(
        now.at("number"),
        f"{was}, and must never be used again",
        f"give {now.name!r} the number {free}, which is free" if free else f"declare {now.name!r} in another type",
        type=burned.owner,
        number=burned.number,
    )


def _judge(pair: EnumPair, old: ProtoEnumValue, values: list[ProtoEnumValue]) -> Judgement:
    if old.name in {value.name for value in values}:
        return Judgement(Meaning.SAME)
    return judge_number(pair, old.number, [old.name], values)


def _value(
    rule: type[Rule],
    pair: EnumPair,
    values: list[ProtoEnumValue],
    old: ProtoEnumValue,
    judged: Judgement,
    free: int | None,
) -> Diagnostic:
    enum, names = pair.new, [value.name for value in values]
    freed = reserve(enum, pair.syntax, [(old.number, old.number)], [old.name])
    was = f"number {old.number} of the enum {enum.full_name!r} was {old.name!r} in the past, and is now {names[0]!r}"
    return rule.at(
        values[0].at("number"),
        was if judged.certain else f"{was}: {judged.reason}",
        (
            f"write `{declared(names, free)} {freed}`: the number {free} is free"
            if free
            else f"declare {names[0]!r} in another enum"
        ),
        [(old.span, "published here")],
        type=enum.full_name,
        number=old.number,
    )
