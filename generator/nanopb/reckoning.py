"""What a field adds to the size of its message."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from generator.nanopb.bounds import Bounds, FieldBounds
from generator.protos import ProtoField, ProtoMessage, Schema

_NEGATIVE = 10  # bytes of a negative number as a varint, of whatever type
_FIXED = {
    "int32": _NEGATIVE,
    "int64": _NEGATIVE,
    "fixed64": 8,
    "sfixed64": 8,
    "double": 8,
    "fixed32": 4,
    "sfixed32": 4,
    "float": 4,
    "bool": 1,
}
_BITS = {"uint32": 32, "sint32": 32, "uint64": 64, "sint64": 64}


@dataclass(frozen=True, slots=True)
class BoundedField:
    """A field that nanopb does not leave out, with the options that hold for it."""

    field: ProtoField
    given: FieldBounds
    in_union: bool
    """Whether it shares its place with the other members of its oneof."""

    @property
    def type(self) -> str:
        """The type that nanopb takes it for."""
        return self.given.type_override or self.field.type

    @property
    def inner(self) -> str:
        """Full name of the message in it; empty for none."""
        return self.field.type_name if self.type == "message" else ""

    @property
    def repeated(self) -> bool:
        """Whether nanopb takes it for repeated."""
        return (self.given.label_override or self.field.label) == "repeated"

    @property
    def capacity(self) -> int | None:
        """The bytes that C has for a string or for `bytes`, the zero byte of a string among them."""
        if self.field.type == "string" and self.given.max_length is not None:
            return self.given.max_length + 1
        return self.given.max_size

    def size(self, schema: Schema, known: Mapping[str, int]) -> int:
        """Its largest size; ``known`` has those of messages."""
        one = varint_size(self.field.number << 3) + self._value_size(schema, known)
        if not self.repeated or self.in_union:
            return one
        # nanopb counts a tag for each element, packed or not. Packed is never longer, except for a single one.
        count = self.given.max_count or 0
        return one * count + (1 if count == 1 else 0)

    def _value_size(self, schema: Schema, known: Mapping[str, int]) -> int:
        if self.type in _FIXED:
            return _FIXED[self.type]
        if self.type in _BITS:
            return varint_size((1 << (self.given.int_size or _BITS[self.type])) - 1)
        if self.type == "enum":
            numbers = [value.number for value in schema.enums[self.field.type_name].values]
            return _NEGATIVE if min(numbers) < 0 else varint_size(max(numbers))
        length = known[self.inner] if self.inner else (self.capacity or 0)
        # The zero byte of a string is not sent, though nanopb counts it in the length that it leaves room for.
        return varint_size(length) + length - (1 if self.type == "string" else 0)


def fields_of(message: ProtoMessage, bounds: Bounds) -> Iterator[BoundedField]:
    """The fields of a message that nanopb does not leave out."""
    separate = bounds.of_message(message.full_name).separate
    for field in message.fields:
        given = bounds.of_field(message.full_name, field.name)
        if not given.ignored:
            yield BoundedField(field, given, bool(field.oneof) and field.oneof not in separate)


def message_size(message: ProtoMessage, schema: Schema, bounds: Bounds, known: Mapping[str, int]) -> int:
    """The largest size of a message of which every field has a bound."""
    total = 0
    largest: dict[str, int] = {}
    for field in fields_of(message, bounds):
        size = field.size(schema, known)
        if field.in_union:
            largest[field.field.oneof] = max(largest.get(field.field.oneof, 0), size)
        else:
            total += size
    return total + sum(largest.values())


def varint_size(number: int) -> int:
    """Bytes of a number, seven bits in each."""
    return max(1, -(-number.bit_length() // 7))
