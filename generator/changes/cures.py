"""What to write instead."""

from __future__ import annotations

from generator.changes.numbers import next_enum_number, next_field_number
from generator.changes.pairing import EnumPair, FieldPair, MessagePair
from generator.changes.spelling import declaration
from generator.protos import ProtoField, ProtoMessage
from generator.subject import Subject


def written(pair: FieldPair) -> tuple[str, ProtoField, ProtoField]:
    """A field before and after as somebody wrote it, and its message: of a map's key or value, the map."""
    if pair.messages is None or not pair.in_map_entry:
        return pair.owner, pair.old, pair.new
    owner = pair.owner.rpartition(".")[0]
    old, new = (_map_of(schema.messages.get(owner), pair.owner) for schema in (pair.change.before, pair.change.after))
    return (owner, old, new) if old and new else (pair.owner, pair.old, pair.new)


def _map_of(message: ProtoMessage | None, entry: str) -> ProtoField | None:
    return next((field for field in message.fields if field.type_name == entry), None) if message else None


def before_and_after(pair: FieldPair) -> tuple[str, str]:
    """How a field was declared and is declared."""
    owner, old, new = written(pair)
    return declaration(old, pair.change.before, owner), declaration(new, pair.change.after, owner)


def back(pair: FieldPair) -> str:
    """How to undo what became of a field."""
    return f"put back `{before_and_after(pair)[0]}`"


def back_or_renumber(subject: Subject, pair: FieldPair) -> str:
    """How to undo what became of a field, or else to keep its number out of it."""
    owner, old, new = written(pair)
    number = None if pair.extension else next_field_number(subject, owner)
    if number is None:
        return f"{back(pair)}, or give the new one a number of its own"
    moved = declaration(new, pair.change.after, owner, number)
    return f"{back(pair)}; or give it a new number, the next free one is {number}: `{moved} reserved {old.number};`"


def back_or_reserve(pair: MessagePair, field: ProtoField) -> str:
    """What to write where a field was."""
    was = declaration(field, pair.change.before, pair.old.full_name)
    return f'put back `{was}`, or write `reserved {field.number}; reserved "{field.name}";`'


def value_back_or_reserve(number: int, names: tuple[str, ...]) -> str:
    """What to write where an enum's value was."""
    values = " ".join(f"{name} = {number};" for name in names)
    quoted = ", ".join(f'"{name}"' for name in names)
    return f"put back `{values}`, or write `reserved {number}; reserved {quoted};`"


def new_enum_number(subject: Subject, pair: EnumPair) -> str:
    """The number for something new in an enum."""
    number = next_enum_number(subject, pair.new.full_name)
    return "a number of its own" if number is None else f"a new number, the next free one is {number}"
