"""Protobuf's encoding as far as no schema is needed: tags, varints, and where fields begin and end."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

VARINT, FIXED64, DELIMITED, GROUP_START, GROUP_END, FIXED32 = range(6)
"""Wire types."""
_MAX_VARINT = 10


class Field(NamedTuple):
    """A field, and where it stands among the bytes."""

    number: int
    wire_type: int
    content: int
    """Where its value begins; that of a delimited one is behind its length."""
    end: int
    """Where it would end if nothing were missing."""


def fields(data: bytes) -> Iterator[Field]:
    """The top-level fields, up to the first byte that cannot start one; of a group, its start and its end are two.

    The last one may end behind the end of the data, by the zeros that were stripped there.
    """
    position = 0
    while position < len(data) and data[position]:
        tag, position = varint(data, position)
        number, wire_type = tag >> 3, tag & 7
        if number == 0 or wire_type > FIXED32:
            return
        content, position = _extent(data, position, wire_type)
        yield Field(number, wire_type, content, position)


def _extent(data: bytes, position: int, wire_type: int) -> tuple[int, int]:
    """Where a value begins and ends whose tag ends at a position."""
    if wire_type == VARINT:
        return position, varint(data, position)[1]
    if wire_type == FIXED64:
        return position, position + 8
    if wire_type == FIXED32:
        return position, position + 4
    if wire_type == DELIMITED:
        length, content = varint(data, position)
        return content, content + length
    return position, position  # the fields of a group follow its tag as if they stood outside


def varint(data: bytes, position: int) -> tuple[int, int]:
    """The varint at a position, and the position behind it; bytes behind the data count as the zeros stripped."""
    value = 0
    for index in range(_MAX_VARINT):
        byte = data[position + index] if position + index < len(data) else 0
        value |= (byte & 0x7F) << (7 * index)
        if not byte & 0x80:
            return value, position + index + 1
    return value, position + _MAX_VARINT
