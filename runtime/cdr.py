"""ROS 2's serialized form: plain XCDR1 with the four-byte encapsulation header.

The rules, from OMG DDS-XTypes 1.3, 7.4.1 (PLAIN_CDR): a primitive is aligned to its own size, counted from the first
byte after the header; a string is a uint32 byte count that includes the closing NUL, the bytes, and the NUL; a
sequence is a uint32 count and its elements; an array and a nested message are their parts and nothing else. A message
without fields carries one uint8, as ROS 2's IDL has it (``structure_needs_at_least_one_member``).

A message whose fields all have a fixed size is one `struct.Struct`; any other is written part by part.
"""

from __future__ import annotations

import reprlib
import struct
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, Generic, NamedTuple, TypeVar

from runtime.errors import ConversionError
from runtime.messages import UINT8, Array, Field, FieldType, Message, Primitive, Sequence, Text, fields_of, once_a_type

M = TypeVar("M", bound=Message)

LITTLE_ENDIAN = b"\x00\x01\x00\x00"
"""The encapsulation header of what we write: PLAIN_CDR, little endian, no options."""

_BYTE_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}
_PLACEHOLDER = Field("structure_needs_at_least_one_member", UINT8)
_COUNT = Primitive("uint32", "I", 4)
_BOOL = "?"
_MISFITS = (struct.error, OverflowError, TypeError, ValueError, AttributeError)
"""What writing a value that does not fit its type raises."""


def encode(message: Message) -> bytes:
    """The serialized form of a message, header included.

    Raises `ConversionError`, with the path of the field, where a value does not fit its type.
    """
    codec = _codec(type(message), "<")
    try:
        return codec.encode(message)
    except _MISFITS as error:
        raise _misfit(message) or ConversionError(str(error)) from error


def decode(message_type: type[M], data: bytes) -> M:
    """The message that a serialized form holds; bytes after its end are ignored.

    Raises `ConversionError` where the data is too short, is no plain CDR, or holds a string that is not UTF-8.
    """
    order = _BYTE_ORDERS.get(bytes(data[:2]))
    if order is None or len(data) < len(LITTLE_ENDIAN):
        raise ConversionError(f"not plain CDR: it starts with {bytes(data[:4]).hex(' ')!r}")
    try:
        return _codec(message_type, order).decode(data)
    except struct.error as error:
        raise ConversionError(f"too short for {message_type.__msgtype__}: {len(data)} bytes") from error
    except UnicodeDecodeError as error:
        raise ConversionError(f"a string of {message_type.__msgtype__} is not UTF-8") from error


@dataclass(frozen=True)
class _Codec(Generic[M]):
    encode: Callable[[M], bytes]
    decode: Callable[[bytes], M]


@once_a_type
def _codec(message_type: type[M], order: str) -> _Codec[M]:
    leaves = list(_fixed_leaves(message_type))
    if None not in leaves:
        return _fixed_codec(message_type, order, [leaf for leaf in leaves if leaf is not None])
    return _variable_codec(message_type, order)


# --- messages of fixed size -------------------------------------------------------------------------------------


class _Leaf(NamedTuple):
    path: str
    primitive: Primitive


def _fixed_leaves(message_type: type[Message], prefix: str = "") -> Iterator[_Leaf | None]:
    """Every primitive of a message in wire order; None for a part that has no fixed size."""
    fields = fields_of(message_type)
    if not fields:
        yield None
    for field in fields:
        if isinstance(field.type, Primitive):
            yield _Leaf(prefix + field.name, field.type)
        elif isinstance(field.type, (Text, Sequence, Array)):
            yield None
        else:
            yield from _fixed_leaves(field.type, f"{prefix}{field.name}.")


def layout(primitives: list[Primitive]) -> str:
    """The `struct` format, without byte order, of primitives that follow each other, with CDR's padding.

    >>> layout([Primitive("bool", "?", 1), Primitive("float64", "d", 8)])
    '?7xd'
    """
    position, parts = 0, []
    for primitive in primitives:
        padding = -position % primitive.size
        parts.append(f"{padding}x" if padding else "")
        parts.append(primitive.format)
        position += padding + primitive.size
    return "".join(parts)


def fixed_layout(message_type: type[Message]) -> struct.Struct:
    """The layout of a message of fixed size: pack it with `LITTLE_ENDIAN` and the values in wire order.

    Raises `TypeError` for a message that has a part of variable size.
    """
    leaves = list(_fixed_leaves(message_type))
    if None in leaves:
        raise TypeError(f"{message_type.__msgtype__} has no fixed size")
    return _fixed_struct("<", [leaf for leaf in leaves if leaf is not None])


def _fixed_struct(order: str, leaves: list[_Leaf]) -> struct.Struct:
    return struct.Struct(order + "4s" + layout([leaf.primitive for leaf in leaves]))


def _fixed_codec(message_type: type[M], order: str, leaves: list[_Leaf]) -> _Codec[M]:
    packer = _fixed_struct(order, leaves)
    paths = [leaf.path for leaf in leaves]
    values_of = attrgetter(*paths) if len(paths) > 1 else _one(attrgetter(paths[0]))
    flags = [index for index, leaf in enumerate(leaves) if leaf.primitive.format == _BOOL]
    build = _builder(message_type)

    def encode_fixed(message: M) -> bytes:
        values = values_of(message)
        _check_flags(values[index] for index in flags)
        return packer.pack(LITTLE_ENDIAN, *values)

    def decode_fixed(data: bytes) -> M:
        values = iter(packer.unpack_from(data))
        next(values)
        message: M = build(values)
        return message

    return _Codec(encode_fixed, decode_fixed)


def _check_flags(values: Iterable[Any]) -> None:
    """Refuse what `struct` would take for a bool: it asks any object whether it is true."""
    for value in values:
        if value not in (True, False):
            raise TypeError("neither true nor false")


def _one(getter: Callable[[Any], Any]) -> Callable[[Any], tuple[Any]]:
    return lambda message: (getter(message),)


def _builder(message_type: type[Message]) -> Callable[[Iterator[Any]], Any]:
    """A function that makes a message of fixed size from its values in wire order."""
    parts: list[Callable[[Iterator[Any]], Any]] = [
        _builder(field.type) if isinstance(field.type, type) else next for field in fields_of(message_type)
    ]
    return lambda values: message_type(*[part(values) for part in parts])


# --- messages of variable size ----------------------------------------------------------------------------------


class _Reader:
    """A place in serialized data; positions are counted from the first byte after the header."""

    __slots__ = ("body", "position")

    def __init__(self, data: bytes) -> None:
        self.body = memoryview(data)[len(LITTLE_ENDIAN) :]
        self.position = 0

    def unpack(self, format: str, alignment: int) -> tuple[Any, ...]:
        start = self.position + -self.position % alignment
        values = struct.unpack_from(format, self.body, start)
        self.position = start + struct.calcsize(format)
        return values

    def take(self, count: int) -> bytes:
        if count > len(self.body) - self.position:
            raise struct.error(f"{count} bytes wanted, {len(self.body) - self.position} left")
        taken = bytes(self.body[self.position : self.position + count])
        self.position += count
        return taken


_Write = Callable[[bytearray, Any], None]
_Read = Callable[[_Reader], Any]


class _Part(NamedTuple):
    write: _Write
    read: _Read


def _variable_codec(message_type: type[M], order: str) -> _Codec[M]:
    part = _message_part(message_type, order)

    def encode_variable(message: M) -> bytes:
        body = bytearray()
        part.write(body, message)
        return LITTLE_ENDIAN + bytes(body)

    def decode_variable(data: bytes) -> M:
        message: M = part.read(_Reader(data))
        return message

    return _Codec(encode_variable, decode_variable)


def _message_part(message_type: type[Message], order: str) -> _Part:
    fields = fields_of(message_type)
    if not fields:
        return _placeholder_part(message_type, order)
    names = [field.name for field in fields]
    parts = [_part(field.type, order) for field in fields]

    def write(body: bytearray, message: Message) -> None:
        for name, part in zip(names, parts):
            part.write(body, getattr(message, name))

    return _Part(write, lambda reader: message_type(*[part.read(reader) for part in parts]))


def _placeholder_part(message_type: type[Message], order: str) -> _Part:
    placeholder = _part(_PLACEHOLDER.type, order)

    def read(reader: _Reader) -> Message:
        placeholder.read(reader)
        return message_type()

    return _Part(lambda body, _: placeholder.write(body, 0), read)


def _part(field_type: FieldType, order: str) -> _Part:
    if isinstance(field_type, Primitive):
        return _primitive_part(field_type, order)
    if isinstance(field_type, Text):
        return _text_part(field_type, order)
    if isinstance(field_type, Sequence):
        return _sequence_part(field_type, order)
    if isinstance(field_type, Array):
        return _array_part(field_type, order)
    return _message_part(field_type, order)


def _write_aligned(body: bytearray, alignment: int, data: bytes) -> None:
    body += b"\0" * (-len(body) % alignment)
    body += data


def _primitive_part(primitive: Primitive, order: str) -> _Part:
    packer, size = struct.Struct(order + primitive.format), primitive.size

    def write(body: bytearray, value: Any) -> None:
        if primitive.format == _BOOL:
            _check_flags((value,))
        _write_aligned(body, size, packer.pack(value))

    return _Part(write, lambda reader: reader.unpack(packer.format, size)[0])


def _text_part(text: Text, order: str) -> _Part:
    count = _part(_COUNT, order)

    def write(body: bytearray, value: str) -> None:
        data = value.encode()
        _check_text(data, text.bound)
        count.write(body, len(data) + 1)
        body += data + b"\0"

    def read(reader: _Reader) -> str:
        size: int = count.read(reader)
        return reader.take(size)[:-1].decode()

    return _Part(write, read)


def _check_text(data: bytes, bound: int | None) -> None:
    if b"\0" in data:
        raise struct.error("a ROS string cannot hold a NUL character")
    if bound is not None and len(data) > bound:
        raise struct.error(f"{len(data)} bytes, where string<={bound} holds {bound}")


def _sequence_part(sequence: Sequence, order: str) -> _Part:
    count, elements = _part(_COUNT, order), _elements_part(sequence.element, order)

    def write(body: bytearray, values: Any) -> None:
        if sequence.bound is not None and len(values) > sequence.bound:
            raise struct.error(f"{len(values)} elements, where the sequence holds at most {sequence.bound}")
        count.write(body, len(values))
        elements.write(body, values)

    return _Part(write, lambda reader: elements.read(reader, count.read(reader)))


def _array_part(array: Array, order: str) -> _Part:
    elements = _elements_part(array.element, order)

    def write(body: bytearray, values: Any) -> None:
        if len(values) != array.length:
            raise struct.error(f"{len(values)} elements, where the array holds exactly {array.length}")
        elements.write(body, values)

    return _Part(write, lambda reader: elements.read(reader, array.length))


class _Elements(NamedTuple):
    write: _Write
    read: Callable[[_Reader, int], Any]


def _elements_part(element: FieldType, order: str) -> _Elements:
    if element == UINT8:
        return _Elements(_write_bytes, lambda reader, count: reader.take(count))
    if isinstance(element, Primitive):
        return _primitive_elements(element, order)
    part = _part(element, order)

    def write(body: bytearray, values: list[Any]) -> None:
        for value in values:
            part.write(body, value)

    return _Elements(write, lambda reader, count: [part.read(reader) for _ in range(count)])


def _write_bytes(body: bytearray, values: bytes) -> None:
    body += values


def _primitive_elements(primitive: Primitive, order: str) -> _Elements:
    def write(body: bytearray, values: list[Any]) -> None:
        if primitive.format == _BOOL:
            _check_flags(values)
        if values:  # an empty run has no first element to align
            packed = struct.pack(f"{order}{len(values)}{primitive.format}", *values)
            _write_aligned(body, primitive.size, packed)

    def read(reader: _Reader, count: int) -> list[Any]:
        if not count:
            return []
        return list(reader.unpack(f"{order}{count}{primitive.format}", primitive.size))

    return _Elements(write, read)


# --- which value did not fit ------------------------------------------------------------------------------------


def _misfit(message: Message, prefix: str = "") -> ConversionError | None:
    """The error of the first field whose value cannot be written, found by writing them one at a time."""
    for field in fields_of(type(message)):
        found = _value_misfit(field.type, getattr(message, field.name), prefix + field.name)
        if found is not None:
            return found
    return None


def _value_misfit(field_type: FieldType, value: Any, path: str) -> ConversionError | None:
    if isinstance(field_type, type) and isinstance(value, field_type):
        return _misfit(value, f"{path}.")
    if isinstance(field_type, (Sequence, Array)) and isinstance(value, list):
        for index, element in enumerate(value):
            found = _value_misfit(field_type.element, element, f"{path}[{index}]")
            if found is not None:
                return found
    try:
        _part(field_type, "<").write(bytearray(), value)
    except _MISFITS as error:
        return ConversionError(f"{reprlib.repr(value)} does not fit {type_name(field_type)} ({error})", path)
    return None


def type_name(field_type: FieldType) -> str:
    """A field's type as a .msg file spells it: ``float32``, ``uint8[<=4]``, ``comms/msg/BoundingBox``."""
    if isinstance(field_type, Primitive):
        return field_type.name
    if isinstance(field_type, Text):
        return "string" if field_type.bound is None else f"string<={field_type.bound}"
    if isinstance(field_type, Sequence):
        bound = "" if field_type.bound is None else f"<={field_type.bound}"
        return f"{type_name(field_type.element)}[{bound}]"
    if isinstance(field_type, Array):
        return f"{type_name(field_type.element)}[{field_type.length}]"
    return field_type.__msgtype__
