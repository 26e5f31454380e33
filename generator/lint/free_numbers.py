"""Free numbers for fields and enum values, which help texts offer to the user.

A number is free if no declaration, no comment and no published state has used it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.ir.protobuf_facts import IMPLEMENTATION_NUMBERS, LARGEST_FIELD_NUMBER
from roverlink.generator.lint.comparison import EnumPair, FieldPair, MessagePair, SchemaChange
from roverlink.generator.lint.comparison.judged_changes import judge_pair
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.comparison.oneof_changes import broken_by_oneof
from roverlink.generator.lint.comparison.pairing import fields_of_messages, written
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.lint.fixits.put_back_or_reserve import back, reserve, was
from roverlink.generator.protos.number_ranges import Range, covers, missing
from roverlink.generator.protos.parser import LARGEST_ENUM_NUMBER
from roverlink.generator.protos.schema import ProtoField, Schema

_IMPLEMENTATION = (IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1)


def next_field_number(context: Context, full_name: str, taken: Iterable[int] = ()) -> int | None:
    """Return a free number for a new field of a message; None if no number is left.

    The number is larger than all numbers that fields of the message use, used earlier, or have in a comment.

    ``taken`` are numbers that help texts have already offered for other fields.
    """
    known = {*taken} | {number for schema in _schemas(context) for number in _fields(schema, full_name)}
    known |= {field.number for field in context.ledger.fields(full_name)} | {*context.ledger.burned_in(full_name)}
    for _, message in context.declared(full_name):
        known |= {claim.number for claim in message.claims}
    closed = [_IMPLEMENTATION]
    for schema in _schemas(context):
        if message_type := schema.messages.get(full_name):
            closed += [*message_type.reserved, *message_type.extension_ranges]
    return _above(known, closed, LARGEST_FIELD_NUMBER)


def next_enum_number(context: Context, full_name: str, taken: Iterable[int] = ()) -> int | None:
    """Return a free number for a new value of an enum; None if no number is left.

    The number is larger than all numbers that values of the enum use, used earlier, or have in a comment.

    ``taken`` are numbers that help texts have already offered for other values.
    """
    # With -1, the first value of an empty enum gets 0, which proto3 demands (Language Guide proto3, "Enumerations").
    known, closed = {-1, *taken}, list[Range]()
    for enum in (schema.enums[full_name] for schema in _schemas(context) if full_name in schema.enums):
        known |= {value.number for value in enum.values}
        closed += enum.reserved
    known |= {value.number for value in context.ledger.values(full_name)} | {*context.ledger.burned_in(full_name)}
    for file in context.files.values():
        known |= {claim.number for enum in file.enums if enum.full_name == full_name for claim in enum.claims}
    return _above(known, closed, LARGEST_ENUM_NUMBER)


def new_numbers(context: Context, pair: EnumPair) -> dict[str, int]:
    """Return a free number for each new enum value that took the number of an old value.

    The keys are the names of the new values.
    """
    known, taken = {value.name for value in pair.old.values}, {value.number for value in pair.old.values}
    numbers: dict[str, int] = {}
    for value in pair.new.values:
        if value.name not in known and value.number in taken:
            number = next_enum_number(context, pair.new.full_name, numbers.values())
            numbers |= {} if number is None else {value.name: number}
    return numbers


class NewNumbers:
    """Free numbers that help texts offer for fields that need another number; each free number is offered once."""

    def __init__(self, context: Context, change: SchemaChange) -> None:
        self._context = context
        self._change = change
        self._of: dict[str, dict[int, int]] = {}

    def of(self, owner: str, number: int) -> int | None:
        """Return the free number that is offered for a field of the message ``owner``; None if none is left.

        ``number`` is the current number of the field.
        """
        if owner not in self._of:
            self._of[owner] = self._handed_out(owner)
        return self._of[owner].get(number) or next_field_number(self._context, owner, self._of[owner].values())

    def _handed_out(self, owner: str) -> dict[int, int]:
        offered: dict[int, int] = {}
        old, new = self._change.before.messages.get(owner), self._change.after.messages.get(owner)
        for field in misplaced_fields(MessagePair(self._change, old, new)) if old and new else ():
            number = next_field_number(self._context, owner, offered.values())
            if number is not None:
                offered[field.number] = number
        return offered


def back_or_renumber(numbers: NewNumbers, pair: FieldPair, undo: str = "") -> str:
    """Return a help text that tells how to undo the change of a field, or how to give the field a new number.

    ``undo`` is the first part of the text; if it is empty, the text says to put back the old declaration.
    """
    owner, old, new = written(pair)
    undo = undo or back(pair)
    message = pair.change.after.messages.get(owner)
    number = None if pair.extension else numbers.of(owner, new.number)
    if number is None or message is None:
        return f"{undo}, or give the new field its own number"
    moved = declaration(new, pair.change.after, owner, pair.syntax, number)
    freed = reserve(message, pair.syntax, [(old.number, old.number)], [old.name])
    return f"{undo}; or give it the free number {number}: `{moved} {freed}`"


def changed_field(
    rule: type[Rule], numbers: NewNumbers, pair: FieldPair, message: str, place: Callable[[ProtoField], Span]
) -> Diagnostic:
    """Return the diagnostic for a change that makes old values of a field unreadable.

    ``place`` returns the part of a field's declaration to point at, such as its name or its type.
    """
    owner, _, new = written(pair)
    return rule.at(
        place(pair.new),
        message,
        back_or_renumber(numbers, pair),
        pair.change.earlier(place(pair.old), f"it was `{was(pair)}` here"),
        type=owner,
        number=new.number,
    )


def _schemas(context: Context) -> Iterator[Schema]:
    yield context.schema
    yield from (schema for change in context.changes for schema in (change.before, change.after))


def _fields(schema: Schema, full_name: str) -> Iterator[int]:
    if message := schema.messages.get(full_name):
        yield from (field.number for field in message.fields)


def _above(known: Iterable[int], closed: Iterable[Range], largest: int) -> int | None:
    number = max(known, default=0) + 1
    for first, last in sorted(closed):
        if first <= number <= last:
            number = last + 1
    return number if number <= largest else None


def misplaced_fields(pair: MessagePair) -> Iterator[ProtoField]:
    """Yield the new fields whose number belonged to another field before, or was reserved before."""
    # A number that was reserved once had another meaning, which only old boards still know.
    freed = [part for was in pair.old.reserved for part in missing(was, pair.new.reserved)]
    pairs = {field_pair.new.number: field_pair for field_pair in fields_of_messages(pair)}
    for field in sorted(pair.new.fields, key=lambda field: field.number):
        one = pairs.get(field.number)
        of_another = one is not None and (_is_another(one) or any(map(_is_another, _inside_of_map(one))))
        if of_another or covers(freed, field.number):
            yield field


def _is_another(pair: FieldPair) -> bool:
    return judge_pair(pair).meaning not in (Meaning.SAME, Meaning.RENAMED) or broken_by_oneof(pair)


def _inside_of_map(pair: FieldPair) -> Iterator[FieldPair]:
    """Yield the key and the value of a map field, each as it was before the change and as it is now.

    Yield nothing for other fields.
    """
    change = pair.change
    old, new = change.before.messages.get(pair.old.type_name), change.after.messages.get(pair.new.type_name)
    if old and new and new.map_entry and old.full_name == new.full_name:
        yield from fields_of_messages(MessagePair(change, old, new))
