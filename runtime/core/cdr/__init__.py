"""ROS 2's serialized form of messages: plain CDR with XCDR version 1 and the four-byte encapsulation header.

The rules, from OMG DDS-XTypes 1.3, 7.4.1 (PLAIN_CDR):

- A primitive is aligned to its own size. Positions count from the first byte after the header.
- A string is a uint32 byte count, the bytes, and a closing NUL. The count includes the NUL.
- A sequence is a uint32 count and then its elements. An array or a nested message is only its elements or fields.
- A message without fields is one uint8, as in ROS 2's IDL (``structure_needs_at_least_one_member``).

A message that consists only of primitive fields, also inside nested messages, is read and written with one
`struct.Struct`. Any other message is read and written field by field.
"""

from __future__ import annotations

import struct
from typing import TypeVar

from roverlink.numerals import counted
from roverlink.runtime.core.cdr.encapsulation import LITTLE_ENDIAN, Codec
from roverlink.runtime.core.cdr.fixed import fixed_codec, leaves_of
from roverlink.runtime.core.cdr.misfit import UNWRITABLE, misfit, type_name
from roverlink.runtime.core.cdr.variable import variable_codec
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Message, cached_by_type

__all__ = ["LITTLE_ENDIAN", "decode", "encode", "type_name"]

M = TypeVar("M", bound=Message)

# The representation identifiers CDR_LE and CDR_BE (RTPS 2.2, 10.2). ROS 2 offers XCDR1 only.
# ROS 2 writers use their machine's byte order, and a reader has to accept both.
_BYTE_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}


def encode(message: Message) -> bytes:
    """Serialize a message to CDR, with the encapsulation header.

    Raises `ConversionError` if the value of a field does not fit its type; the error names the path of the field.
    """
    codec = _codec(type(message), "<")
    try:
        return codec.encode(message)
    except UNWRITABLE as error:
        raise misfit(message) or ConversionError(str(error)) from error


def decode(message_type: type[M], data: bytes, views: bool = False) -> M:
    """Parse a serialized message; bytes after its end are ignored.

    With ``views``, the value of a ``uint8[]`` field is a memoryview of ``data`` in place of a ``bytes`` object, so the
    pixels of an image are not copied. Raises `ConversionError` if the data is too short, is not plain CDR, or has a
    string that is not UTF-8.
    """
    # Padding may follow: rmw_fastrtps may append a slack byte, and DDS pads samples to whole words.
    order = _BYTE_ORDERS.get(bytes(data[:2]))
    if order is None or len(data) < len(LITTLE_ENDIAN):
        raise ConversionError(f"not plain CDR (header 00 01 or 00 00): it starts with {bytes(data[:4]).hex(' ')!r}")
    try:
        return _codec(message_type, order, views).decode(data)
    except struct.error as error:
        raise ConversionError(f"too short for {message_type.__msgtype__}: {counted(len(data), 'byte')}") from error
    except UnicodeDecodeError as error:
        raise ConversionError(f"a string of {message_type.__msgtype__} is not UTF-8") from error


@cached_by_type
def _codec(message_type: type[M], order: str, views: bool = False) -> Codec[M]:
    leaves = leaves_of(message_type)
    return variable_codec(message_type, order, views) if leaves is None else fixed_codec(message_type, order, leaves)
