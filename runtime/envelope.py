"""The envelope on the wire: what trailing zeros mean, and which payload numbers are in it.

Boards differ in what they do with trailing zeros: some send the envelope as the protobuf library writes it, some strip
the zero bytes at its end, some pad it with zeros up to the size of their buffer. All three mean the same envelope.
Two facts of the encoding make restoring exact: a field never starts with a zero byte (field number 0 does not exist),
so zeros where a field would start are padding; and a field's last tag byte is never zero, so what was stripped always
belongs to the last field, whose own length says how much is missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

_VARINT, _FIXED64, _DELIMITED, _GROUP_START, _GROUP_END, _FIXED32 = range(6)
_MAX_VARINT = 10


class _Field(NamedTuple):
    """A top-level field: its number, its wire type, and where it would end if nothing were missing."""

    number: int
    wire_type: int
    end: int


def restore(datagram: bytes) -> bytes:
    """The envelope as it was before its trailing zeros were stripped, or before it was padded with zeros.

    Linear in the size of the datagram, and the identity for every valid envelope. What is no envelope at all is
    returned as far as it can be read; parsing it then fails.
    """
    end = 0
    for field in _fields(datagram):
        end = field.end
    if end > len(datagram):
        # A length that no datagram can carry is not restored but left for the parser to refuse.
        return datagram + bytes(end - len(datagram)) if end <= _LARGEST_DATAGRAM else datagram
    return datagram if datagram[end:].strip(b"\0") else datagram[:end]


_LARGEST_DATAGRAM = 65_507  # of UDP over IPv4


def strip_trailing_zeros(datagram: bytes) -> bytes:
    """The shortest datagram that `restore` brings back to this one."""
    return datagram.rstrip(b"\0")


def payload_numbers(datagram: bytes) -> list[int]:
    """The numbers of the length-delimited fields of an envelope, known to this program or not."""
    return [field.number for field in _fields(datagram) if field.wire_type == _DELIMITED]


def _fields(data: bytes) -> Iterator[_Field]:
    """The top-level fields, up to the first byte that cannot start one.

    The last one may end behind the end of the data, by the zeros that were stripped.
    """
    position = 0
    while position < len(data) and data[position]:
        tag, position = _varint(data, position)
        number, wire_type = tag >> 3, tag & 7
        if number == 0 or wire_type > _FIXED32:
            return
        position = _end(data, position, wire_type)
        yield _Field(number, wire_type, position)


def _end(data: bytes, position: int, wire_type: int) -> int:
    if wire_type == _VARINT:
        return _varint(data, position)[1]
    if wire_type == _FIXED64:
        return position + 8
    if wire_type == _FIXED32:
        return position + 4
    if wire_type == _DELIMITED:
        length, position = _varint(data, position)
        return position + length
    return position  # the fields of a group follow its tag as if they stood outside


def _varint(data: bytes, position: int) -> tuple[int, int]:
    """The varint at a position, and the position behind it; bytes behind the data count as the zeros stripped."""
    value = 0
    for index in range(_MAX_VARINT):
        byte = data[position + index] if position + index < len(data) else 0
        value |= (byte & 0x7F) << (7 * index)
        if not byte & 0x80:
            return value, position + index + 1
    return value, position + _MAX_VARINT
