"""CDR codec of messages with a string, a sequence or an array: the fields are written and read one after the other.

It also writes messages without fields.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from roverlink.numerals import counted
from roverlink.runtime.core.cdr.encapsulation import BOOL, LITTLE_ENDIAN, Codec, check_flags
from roverlink.runtime.core.messages import (
    UINT8,
    Array,
    Field,
    FieldType,
    Message,
    Primitive,
    Sequence,
    Text,
    fields_of,
)

M = TypeVar("M", bound=Message)

# ROS 2's IDL gives a message without fields this member, since IDL has no empty structs.
_PLACEHOLDER = Field("structure_needs_at_least_one_member", UINT8)
_COUNT = Primitive("uint32", "I", 4)


class _Reader:
    """Serialized message with the position of the next byte to read, counted from after the encapsulation header."""

    __slots__ = ("body", "position", "views")

    def __init__(self, data: bytes, views: bool) -> None:
        self.body = memoryview(data)[len(LITTLE_ENDIAN) :]
        self.position = 0
        self.views = views

    def unpack(self, format: str, alignment: int) -> tuple[Any, ...]:
        start = self.position + -self.position % alignment
        values = struct.unpack_from(format, self.body, start)
        self.position = start + struct.calcsize(format)
        return values

    def take(self, count: int) -> bytes:
        return bytes(self.view(count))

    def view(self, count: int) -> memoryview:
        # A corrupt length must not allocate gigabytes: check it against the data that is left.
        if count > len(self.body) - self.position:
            raise struct.error(f"{counted(count, 'byte')} wanted, {len(self.body) - self.position} left")
        view = self.body[self.position : self.position + count]
        self.position += count
        return view

    def octets(self, count: int) -> bytes | memoryview:
        return self.view(count) if self.views else self.take(count)


_Write = Callable[[bytearray, Any], None]
_Read = Callable[[_Reader], Any]


class Part(NamedTuple):
    """Functions for one field type: `write` appends a value to a CDR body, `read` reads a value from a `_Reader`."""

    write: _Write
    read: _Read


def variable_codec(message_type: type[M], order: str, views: bool = False) -> Codec[M]:
    """Make the codec of any message class; ``order`` is the byte order, ``<`` or ``>`` as in `struct`.

    With ``views``, a decoded ``uint8[]`` is a memoryview of the data.
    """
    part = _message_part(message_type, order)

    def encode_variable(message: M) -> bytes:
        body = bytearray()
        part.write(body, message)
        return LITTLE_ENDIAN + bytes(body)

    def decode_variable(data: bytes) -> M:
        message: M = part.read(_Reader(data, views))
        return message

    return Codec(encode_variable, decode_variable)


def _message_part(message_type: type[Message], order: str) -> Part:
    fields = fields_of(message_type)
    if not fields:
        return _placeholder_part(message_type, order)
    names = [field.name for field in fields]
    parts = [part_of(field.type, order) for field in fields]

    def write(body: bytearray, message: Message) -> None:
        for name, part in zip(names, parts):
            part.write(body, getattr(message, name))

    return Part(write, lambda reader: message_type(*[part.read(reader) for part in parts]))


def _placeholder_part(message_type: type[Message], order: str) -> Part:
    placeholder = part_of(_PLACEHOLDER.type, order)

    def read(reader: _Reader) -> Message:
        placeholder.read(reader)
        return message_type()

    return Part(lambda body, _: placeholder.write(body, 0), read)


def part_of(field_type: FieldType, order: str) -> Part:
    """Return the functions that write and read a value of a field type; ``order`` is the byte order, as in `struct`."""
    if isinstance(field_type, Primitive):
        return _primitive_part(field_type, order)
    if isinstance(field_type, Text):
        return _text_part(field_type, order)
    if isinstance(field_type, Sequence):
        return _sequence_part(field_type, order)
    if isinstance(field_type, Array):
        return _array_part(field_type, order)
    return _message_part(field_type, order)


# Positions count from the end of the header, and a body starts empty, so its length is the position.
def _write_aligned(body: bytearray, alignment: int, data: bytes) -> None:
    body += b"\0" * (-len(body) % alignment)
    body += data


def _primitive_part(primitive: Primitive, order: str) -> Part:
    packer, size = struct.Struct(order + primitive.format), primitive.size

    def write(body: bytearray, value: Any) -> None:
        if primitive.format == BOOL:
            check_flags((value,))
        _write_aligned(body, size, packer.pack(value))

    return Part(write, lambda reader: reader.unpack(packer.format, size)[0])


def _text_part(text: Text, order: str) -> Part:
    count = part_of(_COUNT, order)

    def write(body: bytearray, value: str) -> None:
        data = value.encode()
        _check_text(data, text.bound)
        count.write(body, len(data) + 1)
        body += data + b"\0"

    def read(reader: _Reader) -> str:
        size: int = count.read(reader)
        # The count includes the NUL. An empty string is a count of 1 and the NUL.
        return reader.take(size)[:-1].decode()

    return Part(write, read)


def _check_text(data: bytes, bound: int | None) -> None:
    # The reader takes the first NUL for the end of the string.
    if b"\0" in data:
        raise struct.error("it holds a NUL character, which a ROS string cannot carry")
    if bound is not None and len(data) > bound:
        raise struct.error(f"its size of {counted(len(data), 'byte')} is more than string<={bound} allows")


def _sequence_part(sequence: Sequence, order: str) -> Part:
    count, elements = part_of(_COUNT, order), _elements_part(sequence.element, order)

    def write(body: bytearray, values: Any) -> None:
        if sequence.bound is not None and len(values) > sequence.bound:
            raise struct.error(f"its {len(values)} elements are more than the bound of {sequence.bound}")
        count.write(body, len(values))
        elements.write(body, values)

    return Part(write, lambda reader: elements.read(reader, count.read(reader)))


def _array_part(array: Array, order: str) -> Part:
    elements = _elements_part(array.element, order)

    def write(body: bytearray, values: Any) -> None:
        if len(values) != array.length:
            raise struct.error(f"it has {counted(len(values), 'element')} instead of {array.length}")
        elements.write(body, values)

    return Part(write, lambda reader: elements.read(reader, array.length))


class _Elements(NamedTuple):
    write: _Write
    read: Callable[[_Reader, int], Any]


def _elements_part(element: FieldType, order: str) -> _Elements:
    # `uint8[]` is what images and bytes use; one copy instead of one call for each byte.
    if element == UINT8:
        return _Elements(_write_bytes, lambda reader, count: reader.octets(count))
    if isinstance(element, Primitive):
        return _primitive_elements(element, order)
    part = part_of(element, order)

    def write(body: bytearray, values: list[Any]) -> None:
        for value in values:
            part.write(body, value)

    return _Elements(write, lambda reader, count: [part.read(reader) for _ in range(count)])


def _write_bytes(body: bytearray, values: bytes) -> None:
    body += values


def _primitive_elements(primitive: Primitive, order: str) -> _Elements:
    def write(body: bytearray, values: list[Any]) -> None:
        if primitive.format == BOOL:
            check_flags(values)
        if values:  # an empty sequence has no element, so nothing to align
            packed = struct.pack(f"{order}{len(values)}{primitive.format}", *values)
            _write_aligned(body, primitive.size, packed)

    def read(reader: _Reader, count: int) -> list[Any]:
        if not count:
            return []
        return list(reader.unpack(f"{order}{count}{primitive.format}", primitive.size))

    return _Elements(write, read)
