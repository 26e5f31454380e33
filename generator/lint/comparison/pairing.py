"""The parts of a schema before and after, in pairs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.protos.schema import (
    ProtoEnum,
    ProtoEnumValue,
    ProtoExtension,
    ProtoField,
    ProtoMessage,
    Schema,
    Syntax,
)


@dataclass(frozen=True, slots=True)
class MessagePair:
    """A message before and after."""

    change: SchemaChange
    old: ProtoMessage
    new: ProtoMessage

    @property
    def syntax(self) -> Syntax:
        """How it is to be written now."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class EnumPair:
    """An enum before and after."""

    change: SchemaChange
    old: ProtoEnum
    new: ProtoEnum

    @property
    def syntax(self) -> Syntax:
        """How it is to be written now."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class FieldPair:
    """A field before and after; or an extension, which is a field of another file's message."""

    change: SchemaChange
    owner: str
    """Full name of the message that it is a field of."""
    old: ProtoField
    new: ProtoField
    messages: MessagePair | None
    """The messages that it is declared in; None for an extension."""
    files: tuple[str, str]
    """Where it was and is declared."""

    @property
    def old_syntax(self) -> Syntax:
        """How it was written."""
        return self.change.before.syntax_of(self.files[0])

    @property
    def syntax(self) -> Syntax:
        """How it is to be written now."""
        return self.change.after.syntax_of(self.files[1])

    @property
    def extension(self) -> bool:
        """Whether another file added it to the message."""
        return self.messages is None

    @property
    def in_map_entry(self) -> bool:
        """Whether it is the key or the value of a map."""
        return self.messages is not None and self.messages.new.map_entry


def messages(change: SchemaChange) -> Iterator[MessagePair]:
    """The messages that are there on both sides."""
    for name, new in change.after.messages.items():
        if name in change.before.messages:
            yield MessagePair(change, change.before.messages[name], new)


def enums(change: SchemaChange) -> Iterator[EnumPair]:
    """The enums that are there on both sides."""
    for name, new in change.after.enums.items():
        if name in change.before.enums:
            yield EnumPair(change, change.before.enums[name], new)


def fields(change: SchemaChange) -> Iterator[FieldPair]:
    """The fields and the extensions that are there on both sides; what is in a map, if the map's number is the same."""
    for pair in messages(change):
        for one in fields_of_messages(pair):
            by_hand = written(one)
            if by_hand.old.number == by_hand.new.number:
                yield one
    before = extensions_by_number(change.before)
    for key, new in extensions_by_number(change.after).items():
        if key in before:
            old = before[key]
            yield FieldPair(change, new.extendee, old.field, new.field, None, (old.file, new.file))


def fields_of_messages(pair: MessagePair) -> Iterator[FieldPair]:
    """The fields of a message that are there on both sides."""
    before = {field.number: field for field in pair.old.fields}
    files = pair.old.file, pair.new.file
    for field in pair.new.fields:
        if field.number in before:
            yield FieldPair(pair.change, pair.new.full_name, before[field.number], field, pair, files)


class Written(NamedTuple):
    """A field before and after as somebody wrote it, and its message: of a map's key or value, the map."""

    owner: str
    old: ProtoField
    new: ProtoField


def written(pair: FieldPair) -> Written:
    """What somebody wrote of a field."""
    if pair.in_map_entry:
        owner = pair.owner.rpartition(".")[0]
        old, new = (
            _map_of(schema.messages.get(owner), pair.owner) for schema in (pair.change.before, pair.change.after)
        )
        if old and new:
            return Written(owner, old, new)
    return Written(pair.owner, pair.old, pair.new)


def _map_of(message: ProtoMessage | None, entry: str) -> ProtoField | None:
    return next((field for field in message.fields if field.type_name == entry), None) if message else None


def extensions_by_number(schema: Schema) -> dict[tuple[str, int], ProtoExtension]:
    """The extensions by the message that they extend and their number there."""
    return {(extension.extendee, extension.field.number): extension for extension in schema.extensions}


def gone_fields(change: SchemaChange) -> Iterator[tuple[MessagePair, ProtoField]]:
    """The fields whose numbers no field of their message has any more."""
    for pair in messages(change):
        left = {field.number for field in pair.new.fields}
        yield from ((pair, field) for field in pair.old.fields if field.number not in left)


def gone_values(change: SchemaChange) -> Iterator[tuple[EnumPair, int, tuple[str, ...]]]:
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
