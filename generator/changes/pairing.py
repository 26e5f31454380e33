"""The parts of a schema before and after, in pairs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from generator.protos import ProtoEnum, ProtoEnumValue, ProtoExtension, ProtoField, ProtoMessage, Schema
from generator.subject import Change


@dataclass(frozen=True, slots=True)
class MessagePair:
    """A message before and after."""

    change: Change
    old: ProtoMessage
    new: ProtoMessage


@dataclass(frozen=True, slots=True)
class EnumPair:
    """An enum before and after."""

    change: Change
    old: ProtoEnum
    new: ProtoEnum


@dataclass(frozen=True, slots=True)
class FieldPair:
    """A field before and after; or an extension, which is a field of another file's message."""

    change: Change
    owner: str
    """Full name of the message that it is a field of."""
    old: ProtoField
    new: ProtoField
    messages: MessagePair | None
    """The messages that it is declared in; None for an extension."""
    moved: bool = False
    """Whether it is an extension that is declared in another scope than before, which is part of its name."""

    @property
    def extension(self) -> bool:
        """Whether another file added it to the message."""
        return self.messages is None

    @property
    def in_map_entry(self) -> bool:
        """Whether it is the key or the value of a map."""
        return self.messages is not None and self.messages.new.map_entry


def messages(change: Change) -> Iterator[MessagePair]:
    """The messages that are there on both sides."""
    for name, new in change.after.messages.items():
        if name in change.before.messages:
            yield MessagePair(change, change.before.messages[name], new)


def enums(change: Change) -> Iterator[EnumPair]:
    """The enums that are there on both sides."""
    for name, new in change.after.enums.items():
        if name in change.before.enums:
            yield EnumPair(change, change.before.enums[name], new)


def fields(change: Change) -> Iterator[FieldPair]:
    """The fields and the extensions that are there on both sides."""
    for pair in messages(change):
        yield from fields_of_messages(pair)
    before = extensions_by_number(change.before)
    for key, extension in extensions_by_number(change.after).items():
        if key in before:
            moved = before[key].scope != extension.scope
            yield FieldPair(change, extension.extendee, before[key].field, extension.field, None, moved)


def fields_of_messages(pair: MessagePair) -> Iterator[FieldPair]:
    """The fields of a message that are there on both sides."""
    before = {field.number: field for field in pair.old.fields}
    for field in pair.new.fields:
        if field.number in before:
            yield FieldPair(pair.change, pair.new.full_name, before[field.number], field, pair)


def extensions_by_number(schema: Schema) -> dict[tuple[str, int], ProtoExtension]:
    """The extensions by the message that they extend and their number there."""
    return {(extension.extendee, extension.field.number): extension for extension in schema.extensions}


def gone_fields(change: Change) -> Iterator[tuple[MessagePair, ProtoField]]:
    """The fields whose numbers no field of their message has any more."""
    for pair in messages(change):
        left = {field.number for field in pair.new.fields}
        yield from ((pair, field) for field in pair.old.fields if field.number not in left)


def gone_values(change: Change) -> Iterator[tuple[EnumPair, int, tuple[str, ...]]]:
    """The numbers that no value of their enum has any more, with the names that they had."""
    for pair in enums(change):
        left = values_by_number(pair.new)
        for number, values in values_by_number(pair.old).items():
            if number not in left:
                yield pair, number, tuple(value.name for value in values)


def values_by_number(enum: ProtoEnum) -> dict[int, list[ProtoEnumValue]]:
    """The values of an enum by their numbers, of which each may have several names."""
    values: dict[int, list[ProtoEnumValue]] = {}
    for value in enum.values:
        values.setdefault(value.number, []).append(value)
    return values
