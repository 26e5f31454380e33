"""Rules about numbers that had a meaning and are not reserved: something else could take them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.comparison import (
    EnumPair,
    MessagePair,
    SchemaChange,
    each_once,
    enums,
    gone_fields,
    gone_values,
    messages,
)
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration, declaration_of_old, value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import names_in_use, put_back_or_reserve, value_back_or_reserve
from roverlink.generator.lint.free_numbers import NewNumbers, next_enum_number
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.number_ranges import Range, covers, missing, spelled
from roverlink.generator.protos.schema import ProtoField


class FieldNumberFreed(LintRule, id="WIR102"):
    """The number of a deleted field is not reserved.

    The number looks free. If a new field gets it, the rover reads bytes of boards that still send the old field as the
    new field.

    Bad::

        message Imu { float x = 1; float y = 2; }   // before
        message Imu { float x = 1; }                // after

    Good::

        message Imu { float x = 1; reserved 2; reserved "y"; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each number that a field had before, and that is neither used nor reserved now."""
        return each_once(context.changes, _freed_fields)


def _freed_fields(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair, field in gone_fields(change):
        if not covers(pair.new.reserved, field.number):
            yield FieldNumberFreed.at(
                pair.new.span,
                _field_message(pair, field),
                put_back_or_reserve(pair, field),
                change.earlier(field.span, f"it was `{declaration_of_old(pair, field)}` here"),
                type=pair.new.full_name,
                number=field.number,
            )


def _field_message(pair: MessagePair, field: ProtoField) -> str:
    moved = names_in_use(pair.new).get(field.name)
    if moved is not None:
        return (
            f"{field.name!r} moved from number {field.number} to {moved}, but the number {field.number} is not reserved"
        )
    return f"`{field.name} = {field.number}` was deleted from {pair.new.full_name!r}, but its number is not reserved"


@dataclass(frozen=True, slots=True)
class _User:
    """A field or enum value that uses a number which was reserved before."""

    name: str
    number: int
    span: Span
    moved: str
    """The declaration of the field or value with a free number; empty if no number is free."""


class ReservedNumberFreed(LintRule, id="WIR106"):
    """A message or an enum no longer reserves a number that it reserved before.

    The number was reserved because a deleted field or enum value had it. If a new field or value gets the number, the
    rover misreads bytes of boards that still send the old one.

    Bad::

        message Imu { reserved 2; float x = 1; }   // before
        message Imu { float x = 1; float y = 2; }   // after

    Good::

        message Imu { reserved 2; float x = 1; float y = 3; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each reserved range of a message or enum of which a part is no longer reserved."""
        return each_once(context.changes, lambda change: _freed_ranges(context, change))


def _freed_ranges(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in messages(change):
        for place, freed in _freed(pair):
            yield _unreserved(pair, place, freed, _fields(pair, numbers, freed))
    for of_enum in enums(change):
        for place, freed in _freed(of_enum):
            yield _unreserved(of_enum, place, freed, _values(of_enum, context, freed))


def _freed(pair: MessagePair | EnumPair) -> Iterator[tuple[Span, list[Range]]]:
    """Yield the place of each old reserved range, and the parts of the range that are no longer reserved."""
    for was in dict.fromkeys(pair.old.reserved):
        if freed := list(missing(was, pair.new.reserved)):
            yield pair.old.at(f"reserved {was[0]} to {was[1]}"), freed


def _fields(pair: MessagePair, numbers: NewNumbers, freed: list[Range]) -> list[_User]:
    users, name = [], pair.new.full_name
    for field in sorted(pair.new.fields, key=lambda field: field.number):
        if covers(freed, field.number):
            number = numbers.of(name, field.number)
            moved = declaration(field, pair.change.after, name, pair.syntax, number) if number else ""
            users.append(_User(field.name, field.number, field.at("number"), moved))
    return users


def _values(pair: EnumPair, context: Context, freed: list[Range]) -> list[_User]:
    users, offered = [], dict[int, int | None]()
    for value in sorted(pair.new.values, key=lambda value: value.number):
        if covers(freed, value.number):
            if value.number not in offered:
                offered[value.number] = next_enum_number(context, pair.new.full_name, filter(None, offered.values()))
            number = offered[value.number]
            users.append(
                _User(value.name, value.number, value.at("number"), f"{value.name} = {number};" if number else "")
            )
    return users


def _unreserved(pair: MessagePair | EnumPair, place: Span, freed: list[Range], users: list[_User]) -> Diagnostic:
    return ReservedNumberFreed.at(
        pair.new.span,
        f"{pair.new.full_name!r} no longer reserves {spelled(freed)}{_use(users)}",
        _help(f"reserved {spelled(freed)};", users),
        [*pair.change.earlier(place, "reserved here"), *((user.span, "used here") for user in users)],
        type=pair.new.full_name,
        number=freed[0][0] if freed[0][0] == freed[-1][1] else None,
    )


def _use(users: list[_User]) -> str:
    shown = ", ".join(f"`{user.name} = {user.number}`" for user in users)
    return f", and uses it for {shown}" if users else ""


def _help(reserved: str, users: list[_User]) -> str:
    if not users:
        return f"put back `{reserved}`"
    names = ", ".join(user.name for user in users)
    if not all(user.moved for user in users):
        return f"declare {names} in another type, and put back the `reserved` statement"
    declared = " ".join(user.moved for user in users)
    return f"give {names} a new number, and put back the `reserved` statement: `{declared} {reserved}`"


class EnumValueNumberFreed(LintRule, id="WIR107"):
    """The number of a deleted enum value is not reserved.

    The number looks free. If a new value gets it, the rover misreads boards that still send the old value.

    Bad::

        enum Mode { IDLE = 0; DRIVE = 1; }   // before
        enum Mode { IDLE = 0; }              // after

    Good::

        enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each former number of an enum value that is neither used nor reserved now."""
        return each_once(context.changes, _freed_values)


def _freed_values(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair, number, names in gone_values(change):
        if not covers(pair.new.reserved, number):
            yield EnumValueNumberFreed.at(
                pair.new.span,
                _value_message(pair, number, names),
                value_back_or_reserve(pair, number, names),
                change.earlier(value_place(pair.old, number), "it was here"),
                type=pair.new.full_name,
                number=number,
            )


def _value_message(pair: EnumPair, number: int, names: tuple[str, ...]) -> str:
    moved = {value.name: value.number for value in pair.new.values if value.name in names}
    for name, now in moved.items():
        return f"{name!r} moved from number {number} to {now}, but the number {number} is not reserved"
    return f"`{', '.join(names)} = {number};` was deleted from {pair.new.full_name!r}, but its number is not reserved"
