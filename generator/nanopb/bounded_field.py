"""Largest encoded size of a field in bytes, as nanopb computes it, or the reason why the size has no limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator.nanopb.bounds import Bounds, FieldBounds
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

# The size of a field is its tag (a varint of number << 3) and its value, both at their longest:
# - An integer takes seven bits in each byte. int32 and int64 may be negative, and then take ten bytes; unsigned and
#   ZigZag ones only as many as their bits need.
# - A string, bytes and a message have a length in front, which is a varint itself.
# - A repeated field takes its largest count of values. Members of a oneof share a union, so only the largest one
#   counts.
_NEGATIVE = 10  # int32, int64 and enums extend a negative number to 64 bits: ten bytes of seven bits (encoding guide)
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
    """A field for which nanopb generates C code, with the options of nanopb that apply to it."""

    field: ProtoField
    given: FieldBounds
    in_union: bool
    """True if nanopb stores the field in a C union with the other members of its oneof."""

    @property
    def type(self) -> str:
        """The type that nanopb uses for the field: the option ``type_override``, or else the declared type."""
        return self.given.type_override or self.field.type

    @property
    def inner(self) -> str:
        """Full name of the message that is the field's type; empty if the type is no message."""
        return self.field.type_name if self.type == "message" else ""

    @property
    def repeated(self) -> bool:
        """True if nanopb treats the field as repeated: by an option, or by its declaration."""
        return (self.given.label_override or self.field.label) == "repeated"

    @property
    def capacity(self) -> int | None:
        """The number of bytes in the C array for a string or `bytes` field; None if it has no limit.

        The zero byte at the end of a string is counted.
        """
        if self.field.type == "string" and self.given.max_length is not None:
            return self.given.max_length + 1
        return self.given.max_size

    def size(self, schema: Schema, known: Mapping[str, int]) -> int:
        """Return the largest encoded size of the field in bytes, including its tag.

        `gap` must be empty for the field. ``known`` has the largest encoded size of each message that the field may
        contain, by full name.
        """
        one = varint_size(self.field.number << 3) + self._value_size(schema, known)
        if not self.repeated or self.in_union:
            return one
        # nanopb counts a tag for each element, packed or not. Packed is never longer, except with a single element.
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
        # nanopb computes a string's length prefix with the zero byte, although the zero byte is not sent.
        return varint_size(length) + length - (1 if self.type == "string" else 0)

    def gap(self, schema: Schema, bounds: Bounds) -> str:
        """Return the reason why the encoded size of the field has no limit; empty if it has one.

        If the field contains a message, the fields of that message are not checked. In some of these cases nanopb
        rejects the file. In most, the user's callback functions encode the field, and their output has an unknown size.
        """
        return next(self._gaps(schema, bounds), "")

    def _gaps(self, schema: Schema, bounds: Bounds) -> Iterator[str]:
        types, bounded = (self.type, self.field.type), self.capacity is not None
        if self.given.type not in _STATIC:
            yield f"its nanopb type is {self.given.type}, which has no buffer of fixed size"
        if self.repeated and self.given.max_count is None:
            held = schema.messages.get(self.field.type_name)
            yield f"it is {'a map' if held and held.map_entry else 'repeated'}, without `max_count`"
        elif self.given.fixed_count and self.given.max_count is None:
            yield "it has `fixed_count` without `max_count`"
        if "string" in types and not bounded:
            yield "it is a string without `max_size` or `max_length`"
        if "bytes" in types and not bounded:
            yield "it has the type bytes, without `max_size`"
        if self.type == "group":
            yield "it is a group, which nanopb does not support"
        if self.type == "message" and self.inner not in schema.messages:
            yield "`type_override` says message, but the field has no message type"
        if self.type == "enum" and self.field.type_name not in schema.enums:
            yield "`type_override` says enum, but the field has no enum type"
        if self.inner and bounds.of_message(self.inner).skipped:
            yield f"nanopb leaves the message {self.inner!r} out"


def fields_of(message: ProtoMessage, bounds: Bounds) -> Iterator[BoundedField]:
    """Yield the fields of a message for which nanopb generates C code; ignored fields are left out."""
    separate = bounds.of_message(message.full_name).separate
    for field in message.fields:
        given = bounds.of_field(message.full_name, field.name)
        if not given.ignored:
            yield BoundedField(field, given, bool(field.oneof) and field.oneof not in separate)


def varint_size(number: int) -> int:
    """Return the number of bytes that a number needs as a varint, which has seven bits in each byte."""
    return max(1, -(-number.bit_length() // 7))
