"""The largest size of a field in its message, or the reason why it has none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator.nanopb.bounds import Bounds, FieldBounds
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

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
_STATIC = frozenset({"FT_DEFAULT", "FT_STATIC", "FT_INLINE"})
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

    def gap(self, schema: Schema, bounds: Bounds) -> str:
        """Say why the field has no largest size, be there a message in it or not; empty where it has one.

        nanopb refuses a file for some of these; for most it leaves a field to functions that the user writes, and then
        nobody knows how much those encode.
        """
        return next(self._gaps(schema, bounds), "")

    def _gaps(self, schema: Schema, bounds: Bounds) -> Iterator[str]:
        types, bounded = (self.type, self.field.type), self.capacity is not None
        if self.given.type not in _STATIC:
            yield f"its type is {self.given.type}"
        if self.repeated and self.given.max_count is None:
            held = schema.messages.get(self.field.type_name)
            yield f"{'a map' if held and held.map_entry else 'repeated'} without max_count"
        elif self.given.fixed_count and self.given.max_count is None:
            yield "fixed_count without max_count"
        if "string" in types and not bounded:
            yield "a string without max_size or max_length"
        if "bytes" in types and not bounded:
            yield "bytes without max_size"
        if self.type == "group":
            yield "a group, which nanopb does not support"
        if self.type == "message" and self.inner not in schema.messages:
            yield "type_override names a message, and it has none"
        if self.type == "enum" and self.field.type_name not in schema.enums:
            yield "type_override names an enum, and it has none"
        if self.inner and bounds.of_message(self.inner).skipped:
            yield f"nanopb leaves {self.inner} out"


def fields_of(message: ProtoMessage, bounds: Bounds) -> Iterator[BoundedField]:
    """The fields of a message that nanopb does not leave out."""
    separate = bounds.of_message(message.full_name).separate
    for field in message.fields:
        given = bounds.of_field(message.full_name, field.name)
        if not given.ignored:
            yield BoundedField(field, given, bool(field.oneof) and field.oneof not in separate)


def varint_size(number: int) -> int:
    """Bytes of a number, seven bits in each."""
    return max(1, -(-number.bit_length() // 7))
