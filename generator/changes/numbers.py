"""Numbers that nothing uses, has used or is going to use."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from generator.changes.ranges import Range
from generator.declarations import LARGEST_ENUM_NUMBER, LARGEST_FIELD_NUMBER
from generator.protos import Schema
from generator.subject import Subject
from generator.table import IMPLEMENTATION_NUMBERS

_IMPLEMENTATION = (IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1)


def next_field_number(subject: Subject, full_name: str, taken: Iterable[int] = ()) -> int | None:
    """The number for the next field of a message: above every one that is known; None where there is none left.

    ``taken`` are those that others were offered already.
    """
    known = {*taken} | {number for schema in _schemas(subject) for number in _fields(schema, full_name)}
    if owner := subject.ledger.messages.get(full_name):
        known |= {number.fact.number for number in owner.numbers}
    for _, message in subject.declared(full_name):
        known |= {claim.number for claim in message.claims}
    closed = [_IMPLEMENTATION]
    for schema in _schemas(subject):
        if message_type := schema.messages.get(full_name):
            closed += [*message_type.reserved, *message_type.extension_ranges]
    return _above(known, closed, LARGEST_FIELD_NUMBER)


def next_enum_number(subject: Subject, full_name: str, taken: Iterable[int] = ()) -> int | None:
    """The number for the next value of an enum: above every one that is known; None where there is none left."""
    known, closed = {-1, *taken}, list[Range]()
    for enum in (schema.enums[full_name] for schema in _schemas(subject) if full_name in schema.enums):
        known |= {value.number for value in enum.values}
        closed += enum.reserved
    if owner := subject.ledger.enums.get(full_name):
        known |= {number.fact.number for number in owner.numbers}
    for file in subject.files.values():
        known |= {c.number for enum in file.all_enums() if enum.full_name == full_name for c in enum.claims}
    return _above(known, closed, LARGEST_ENUM_NUMBER)


def _schemas(subject: Subject) -> Iterator[Schema]:
    if subject.schema is not None:
        yield subject.schema
    yield from (change.before for change in subject.changes)


def _fields(schema: Schema, full_name: str) -> Iterator[int]:
    if message := schema.messages.get(full_name):
        yield from (field.number for field in message.fields)


def _above(known: Iterable[int], closed: Iterable[Range], largest: int) -> int | None:
    number = max(known, default=0) + 1
    for first, last in sorted(closed):
        if first <= number <= last:
            number = last + 1
    return number if number <= largest else None
