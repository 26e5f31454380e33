"""Pairs of an old and a new declaration: messages, enums and fields that exist before and after a change."""

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
    """A message as it was before a change, and as it is now."""

    change: SchemaChange
    old: ProtoMessage
    new: ProtoMessage

    @property
    def syntax(self) -> Syntax:
        """The syntax of the file that declares the message now."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class EnumPair:
    """An enum as it was before a change, and as it is now."""

    change: SchemaChange
    old: ProtoEnum
    new: ProtoEnum

    @property
    def syntax(self) -> Syntax:
        """The syntax of the file that declares the enum now."""
        return self.change.after.syntax_of(self.new.file)


@dataclass(frozen=True, slots=True)
class FieldPair:
    """A field or an extension as it was before a change, and as it is now."""

    change: SchemaChange
    owner: str
    """Full name of the message that contains the field."""
    old: ProtoField
    new: ProtoField
    messages: MessagePair | None
    """The message that declares the field, before and now; None for an extension."""
    files: tuple[str, str]
    """The file that declared the field before, and the file that declares it now."""

    @property
    def old_syntax(self) -> Syntax:
        """The syntax of the file that declared the field before."""
        return self.change.before.syntax_of(self.files[0])

    @property
    def syntax(self) -> Syntax:
        """The syntax of the file that declares the field now."""
        return self.change.after.syntax_of(self.files[1])

    @property
    def extension(self) -> bool:
        """True if the field is a protobuf extension, which another file may add to the message."""
        return self.messages is None

    @property
    def in_map_entry(self) -> bool:
        """True if the field is the key or the value of a map."""
        return self.messages is not None and self.messages.new.map_entry


def messages(change: SchemaChange) -> Iterator[MessagePair]:
    """Yield each message that exists before and after a change."""
    for name, new in change.after.messages.items():
        if name in change.before.messages:
            yield MessagePair(change, change.before.messages[name], new)


def enums(change: SchemaChange) -> Iterator[EnumPair]:
    """Yield each enum that exists before and after a change."""
    for name, new in change.after.enums.items():
        if name in change.before.enums:
            yield EnumPair(change, change.before.enums[name], new)


def fields(change: SchemaChange) -> Iterator[FieldPair]:
    """Yield each field and extension whose number exists before and after a change.

    The key and the value of a map are left out if the number of the map's field changed.
    """
    for pair in messages(change):
        for field_pair in fields_of_messages(pair):
            # An entry message has the name of its map (`ScalesEntry` of `scales`). So a pair of entries may belong to
            # maps with different numbers, and no receiver reads the bytes of one map as the other.
            by_hand = written(field_pair)
            if by_hand.old.number == by_hand.new.number:
                yield field_pair
    before = extensions_by_number(change.before)
    for key, new in extensions_by_number(change.after).items():
        if key in before:
            old = before[key]
            yield FieldPair(change, new.extendee, old.field, new.field, None, (old.file, new.file))


def fields_of_messages(pair: MessagePair) -> Iterator[FieldPair]:
    """Yield each field of a message whose number exists before and after a change."""
    before = {field.number: field for field in pair.old.fields}
    files = pair.old.file, pair.new.file
    for field in pair.new.fields:
        if field.number in before:
            yield FieldPair(pair.change, pair.new.full_name, before[field.number], field, pair, files)


class Written(NamedTuple):
    """Declaration of a field in the .proto file, before and after a change.

    For the key or the value of a map, this is the map field, because the .proto file declares no entry message.
    """

    owner: str
    old: ProtoField
    new: ProtoField


def written(pair: FieldPair) -> Written:
    """Return the field that the .proto file declares: the map field for a key or value of a map.

    The .proto file does not contain the message with the key and value, because protoc makes it. For any other field,
    the result is the field itself.
    """
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
    """Return the extensions of a schema by the full name of the extended message and the extension's number."""
    return {(extension.extendee, extension.field.number): extension for extension in schema.extensions}


def gone_fields(change: SchemaChange) -> Iterator[tuple[MessagePair, ProtoField]]:
    """Yield each old field whose number no field has now, with its message before and after the change."""
    for pair in messages(change):
        left = {field.number for field in pair.new.fields}
        yield from ((pair, field) for field in pair.old.fields if field.number not in left)


def gone_values(change: SchemaChange) -> Iterator[tuple[EnumPair, int, tuple[str, ...]]]:
    """Yield each old number of an enum that no value has now.

    Each item has the enum before and after the change, the number, and the old names of the number.
    """
    for pair in enums(change):
        left = values_by_number(pair.new)
        for number, values in values_by_number(pair.old).items():
            if number not in left:
                yield pair, number, tuple(value.name for value in values)


def values_by_number(enum: ProtoEnum) -> dict[int, list[ProtoEnumValue]]:
    """Return the values of an enum by number. A number can have several values with the option ``allow_alias``."""
    values: dict[int, list[ProtoEnumValue]] = {}
    for value in enum.values:
        values.setdefault(value.number, []).append(value)
    return values
