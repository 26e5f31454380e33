"""The bytes of a protobuf message, a line a field: what stands where in a datagram."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from google.protobuf.descriptor import FieldDescriptor

_VARINT, _FIXED64, _DELIMITED, _FIXED32 = 0, 1, 2, 5


class WireLine(NamedTuple):
    """A few bytes, and what they mean."""

    depth: int
    """In how many messages they stand."""
    bytes: str
    """In hexadecimal."""
    meaning: str


def wire_lines(data: bytes, message: Any, depth: int = 0) -> Iterator[WireLine]:
    """A line for each field; of a message, one for its beginning, and those of its fields deeper.

    ``message`` is the descriptor.
    """
    position = 0
    while position < len(data):
        start = position
        tag, position = _varint(data, position)
        field, kind = message.fields_by_number[tag >> 3], tag & 7
        name = f"{field.name} = {field.number}"
        if kind == _DELIMITED:
            length, begin = _varint(data, position)
            position = begin + length
            content = data[begin:position]
            if field.message_type is not None:
                yield WireLine(
                    depth, data[start:begin].hex(" "), f"{name}, {field.message_type.name} of {length} bytes"
                )
                yield from wire_lines(content, field.message_type, depth + 1)
            else:
                yield WireLine(depth, data[start:position].hex(" "), f"{name}: {_delimited(content, field)}")
        else:
            value, position = _value(data, position, kind, field)
            yield WireLine(depth, data[start:position].hex(" "), f"{name}: {value}")


def _varint(data: bytes, position: int) -> tuple[int, int]:
    """A number of seven bits a byte, and where the next thing starts."""
    value = shift = 0
    while True:
        byte = data[position]
        value |= (byte & 0x7F) << shift
        position, shift = position + 1, shift + 7
        if byte < 0x80:
            return value, position


def _value(data: bytes, position: int, kind: int, field: FieldDescriptor) -> tuple[str, int]:
    """A value of a fixed size or of a varint, as text, and where the next thing starts."""
    if kind == _VARINT:
        raw, end = _varint(data, position)
        return _of_varint(raw, field), end
    size = 8 if kind == _FIXED64 else 4
    return str(_fixed(data[position : position + size], field)), position + size


def _fixed(data: bytes, field: FieldDescriptor) -> Any:
    formats = {
        field.TYPE_DOUBLE: "<d",
        field.TYPE_FLOAT: "<f",
        field.TYPE_FIXED64: "<Q",
        field.TYPE_SFIXED64: "<q",
        field.TYPE_FIXED32: "<I",
        field.TYPE_SFIXED32: "<i",
    }
    (value,) = struct.unpack(formats[field.type], data)
    return float(f"{value:.7g}") if field.type == field.TYPE_FLOAT else value


def _of_varint(raw: int, field: FieldDescriptor) -> str:
    if field.type == field.TYPE_BOOL:
        return "true" if raw else "false"
    if field.type in (field.TYPE_SINT32, field.TYPE_SINT64):
        return str(raw >> 1 ^ -(raw & 1))
    value = raw - (1 << 64) if raw >> 63 and field.type not in (field.TYPE_UINT32, field.TYPE_UINT64) else raw
    known = field.enum_type.values_by_number.get(value) if field.enum_type is not None else None
    return f"{value} ({known.name})" if known else str(value)


def _delimited(content: bytes, field: FieldDescriptor) -> str:
    """A text, bytes, or a packed list of numbers."""
    if field.type == field.TYPE_STRING:
        return repr(content.decode("utf-8", errors="replace"))
    if field.type == field.TYPE_BYTES:
        return f"{len(content)} bytes"
    values, position = [], 0
    kinds = {field.TYPE_DOUBLE: _FIXED64, field.TYPE_FIXED64: _FIXED64, field.TYPE_SFIXED64: _FIXED64}
    kinds |= {field.TYPE_FLOAT: _FIXED32, field.TYPE_FIXED32: _FIXED32, field.TYPE_SFIXED32: _FIXED32}
    while position < len(content):
        value, position = _value(content, position, kinds.get(field.type, _VARINT), field)
        values.append(value)
    return f"[{', '.join(values)}]"
