"""Protobuf's wire format without a schema: tags, varints, and the extent of each field.

The rules, from "Encoding" on protobuf.dev:
- A tag is the varint ``field_number << 3 | wire_type``; field number 0 does not exist.
- A varint has 7 bits a byte, the lowest first; the high bit says that another byte follows; 10 bytes at most.
- A delimited value is a varint length and so many bytes.
- A group is a start tag, its fields and an end tag.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

VARINT, FIXED64, DELIMITED, GROUP_START, GROUP_END, FIXED32 = range(6)
"""Wire types, by number."""
_MAX_VARINT = 10  # bytes: 64 bits, 7 in each


class Field(NamedTuple):
    """Field and its position in the bytes."""

    number: int
    wire_type: int
    content: int
    """Index of the value's first byte; for a delimited field, after its length."""
    end: int
    """Index after the value, even if the data ends before."""


def fields(data: bytes) -> Iterator[Field]:
    """Yield the top-level fields, up to the first byte that cannot start one.

    A group gives two fields, its start and its end. The last field may end after the data; the missing bytes are zeros
    that were stripped.
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
    """Return start and end of the value whose tag ends at ``position``."""
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


def varint(data: bytes, position: int) -> tuple[int, int]:
    """Return the varint at a position and the position after it; bytes after the data count as stripped zeros."""
    value = 0
    for index in range(_MAX_VARINT):
        # Stripped zeros at the end count as present: the last byte of a varint may have been one of them.
        byte = data[position + index] if position + index < len(data) else 0
        value |= (byte & 0x7F) << (7 * index)
        if not byte & 0x80:
            return value, position + index + 1
    return value, position + _MAX_VARINT
