"""Pairs of old and new parts of a schema."""

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
        """The syntax of the new file."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class EnumPair:
    """An enum before and after."""

    change: SchemaChange
    old: ProtoEnum
    new: ProtoEnum

    @property
    def syntax(self) -> Syntax:
        """The syntax of the new file."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class FieldPair:
    """A field or an extension before and after."""

    change: SchemaChange
    owner: str
    """Full name of the message that has the field."""
    old: ProtoField
    new: ProtoField
    messages: MessagePair | None
    """The messages that declare the field; None for an extension."""
    files: tuple[str, str]
    """The old and the new file."""

    @property
    def old_syntax(self) -> Syntax:
        """The syntax of the old file."""
        return self.change.before.syntax_of(self.files[0])

    @property
    def syntax(self) -> Syntax:
        """The syntax of the new file."""
        return self.change.after.syntax_of(self.files[1])

    @property
    def extension(self) -> bool:
        """True for an extension, which another file may add to the message."""
        return self.messages is None

    @property
    def in_map_entry(self) -> bool:
        """True for the key or the value of a map."""
        return self.messages is not None and self.messages.new.map_entry


def messages(change: SchemaChange) -> Iterator[MessagePair]:
    """Yield the messages that exist on both sides."""
    for name, new in change.after.messages.items():
        if name in change.before.messages:
            yield MessagePair(change, change.before.messages[name], new)


def enums(change: SchemaChange) -> Iterator[EnumPair]:
    """Yield the enums that exist on both sides."""
    for name, new in change.after.enums.items():
        if name in change.before.enums:
            yield EnumPair(change, change.before.enums[name], new)


def fields(change: SchemaChange) -> Iterator[FieldPair]:
    """Yield the fields and extensions that exist on both sides.

    The key and the value of a map are only compared if the map has the same number.
    """
    for pair in messages(change):
        for one in fields_of_messages(pair):
            # Entries are found by the map's name (`ScalesEntry` of `scales`), so an entry may pair maps with different
            # numbers. Bytes of those never meet.
            by_hand = written(one)
            if by_hand.old.number == by_hand.new.number:
                yield one
    before = extensions_by_number(change.before)
    for key, new in extensions_by_number(change.after).items():
        if key in before:
            old = before[key]
            yield FieldPair(change, new.extendee, old.field, new.field, None, (old.file, new.file))


def fields_of_messages(pair: MessagePair) -> Iterator[FieldPair]:
    """Yield the fields of a message that exist on both sides."""
    before = {field.number: field for field in pair.old.fields}
    files = pair.old.file, pair.new.file
    for field in pair.new.fields:
        if field.number in before:
            yield FieldPair(pair.change, pair.new.full_name, before[field.number], field, pair, files)


class Written(NamedTuple):
    """A field before and after as written in the file, with its message. For a map's key or value, this is the map."""

    owner: str
    old: ProtoField
    new: ProtoField


def written(pair: FieldPair) -> Written:
    """Return the declaration in the file: for the key or value of a map, this is the map's."""
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
    """Return the extensions by extended message and number."""
    return {(extension.extendee, extension.field.number): extension for extension in schema.extensions}


def gone_fields(change: SchemaChange) -> Iterator[tuple[MessagePair, ProtoField]]:
    """Yield the old fields whose numbers are unused now."""
    for pair in messages(change):
        left = {field.number for field in pair.new.fields}
        yield from ((pair, field) for field in pair.old.fields if field.number not in left)


def gone_values(change: SchemaChange) -> Iterator[tuple[EnumPair, int, tuple[str, ...]]]:
    """Yield the old numbers of enums that are unused now, with their names."""
    for pair in enums(change):
        left = values_by_number(pair.new)
        for number, values in values_by_number(pair.old).items():
            if number not in left:
                yield pair, number, tuple(value.name for value in values)


def values_by_number(enum: ProtoEnum) -> dict[int, list[ProtoEnumValue]]:
    """Return the values of an enum by number. With ``allow_alias``, a number has several names."""
    values: dict[int, list[ProtoEnumValue]] = {}
    for value in enum.values:
        values.setdefault(value.number, []).append(value)
    return values
