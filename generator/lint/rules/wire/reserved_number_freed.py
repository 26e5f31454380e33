"""A message or an enum no longer reserves a number that it reserved before.

The number was reserved because a deleted field or enum value had it. If a new field or value gets the number, the rover
misreads bytes of boards that still send the old one.

Bad::

    message Imu { reserved 2; float x = 1; }   // before
    message Imu { float x = 1; float y = 2; }   // after

Good::

    message Imu { reserved 2; float x = 1; float y = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.lint.comparison import EnumPair, MessagePair, SchemaChange, each_once, enums, messages
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.lint.free_numbers import NewNumbers, next_enum_number
from roverlink.generator.protos.number_ranges import Range, covers, missing, spelled

RULE = Rule("WIR106", "reserved-number-freed", __doc__)


@dataclass(frozen=True, slots=True)
class _User:
    """A field or enum value that uses a number which was reserved before."""

    name: str
    number: int
    span: Span
    moved: str
    """The declaration of the field or value with a free number; empty if no number is free."""


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each reserved range of a message or enum of which a part is no longer reserved."""
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in messages(change):
        for place, freed in _freed(pair):
            yield _finding(pair, place, freed, _fields(pair, numbers, freed))
    for of_enum in enums(change):
        for place, freed in _freed(of_enum):
            yield _finding(of_enum, place, freed, _values(of_enum, context, freed))


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


def _finding(pair: MessagePair | EnumPair, place: Span, freed: list[Range], users: list[_User]) -> Diagnostic:
    return RULE.at(
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
