"""Protobuf's wire format without a schema: tags, varints, and start and end of each field.

The rules, from "Encoding" on protobuf.dev:
- A tag is the varint ``field_number << 3 | wire_type``; field number 0 does not exist.
- A varint has 7 bits in each byte, the lowest bits first. The high bit of a byte says that another byte follows. A
  varint has at most 10 bytes.
- A length-delimited value is a varint with the length, and then as many bytes.
- A group is a start tag, its fields and an end tag.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

VARINT, FIXED64, DELIMITED, GROUP_START, GROUP_END, FIXED32 = range(6)
"""Wire types of protobuf; each has its number on the wire as value."""
_MAX_VARINT = 10  # bytes: 64 bits, 7 in each


class Field(NamedTuple):
    """Field of a serialized message: its number, its wire type and its position in the bytes."""

    number: int
    wire_type: int
    content: int
    """Index of the value's first byte; in a length-delimited field, this byte follows the length."""
    end: int
    """Index after the value; it may lie beyond the end of the data."""


def fields(data: bytes) -> Iterator[Field]:
    """Yield the top-level fields of a serialized message, up to the first byte that cannot start a field.

    A group gives two fields: its start tag and its end tag. The last field may end after the end of the data, because
    trailing zeros may have been stripped from it.
    """
    position = 0
    # A zero byte cannot start a field, so it ends the envelope: the rest is padding.
    while position < len(data) and data[position]:
        tag, position = varint(data, position)
        number, wire_type = tag >> 3, tag & 7
        # Wire types 6 and 7 do not exist, so this is no envelope.
        if number == 0 or wire_type > FIXED32:
            return
        content, position = _extent(data, position, wire_type)
        yield Field(number, wire_type, content, position)


def _extent(data: bytes, position: int, wire_type: int) -> tuple[int, int]:
    """Return the positions where the value of a field starts and ends; the field's tag ends at ``position``."""
    if wire_type == VARINT:
        return position, varint(data, position)[1]
    if wire_type == FIXED64:
        return position, position + 8
    if wire_type == FIXED32:
        return position, position + 4
    if wire_type == DELIMITED:
        length, content = varint(data, position)
        return content, content + length
    return position, position  # a group has no length: its fields follow as if they were outside


def encoded_varint(value: int) -> bytes:
    """Return a number from 0 as a varint."""
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*encoded, value])


def varint(data: bytes, position: int) -> tuple[int, int]:
    """Return the varint at a position, and the position after it. Bytes beyond the end of the data count as zeros."""
    value = 0
    for index in range(_MAX_VARINT):
        # Stripped zeros at the end count as present: the last byte of a varint may have been one of them.
        byte = data[position + index] if position + index < len(data) else 0
        value |= (byte & 0x7F) << (7 * index)
        if not byte & 0x80:
            return value, position + index + 1
    return value, position + _MAX_VARINT
