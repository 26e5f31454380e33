"""ROS 2's serialized form: plain XCDR1 with the four-byte encapsulation header.

The rules, from OMG DDS-XTypes 1.3, 7.4.1 (PLAIN_CDR): a primitive is aligned to its own size, counted from the first
byte after the header; a string is a uint32 byte count that includes the closing NUL, the bytes, and the NUL; a
sequence is a uint32 count and its elements; an array and a nested message are their parts and nothing else. A message
without fields carries one uint8, as ROS 2's IDL has it (``structure_needs_at_least_one_member``).

A message whose fields all have a fixed size is one `struct.Struct`; any other is written part by part.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import TypeVar

from roverlink.runtime.core.cdr.encapsulation import LITTLE_ENDIAN, Codec
from roverlink.runtime.core.cdr.fixed import fixed_codec, fixed_layout, layout, leaves_of
from roverlink.runtime.core.cdr.misfit import UNWRITABLE, misfit, type_name
from roverlink.runtime.core.cdr.template import Template
from roverlink.runtime.core.cdr.template import template as template_of
from roverlink.runtime.core.cdr.variable import variable_codec
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Message, once_a_type

__all__ = ["LITTLE_ENDIAN", "decode", "encode", "fixed_layout", "layout", "template", "type_name"]

M = TypeVar("M", bound=Message)

_BYTE_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}


def encode(message: Message) -> bytes:
    """The serialized form of a message, header included.

    Raises `ConversionError`, with the path of the field, where a value does not fit its type.
    """
    codec = _codec(type(message), "<")
    try:
        return codec.encode(message)
    except UNWRITABLE as error:
        raise misfit(message) or ConversionError(str(error)) from error


def template(message: Message, varying: Sequence[str]) -> Template:
    """What stays the same in a message where only the fields at some paths vary, and how the others are laid out."""
    return template_of(encode(message), message, varying)


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


@once_a_type
def _codec(message_type: type[M], order: str) -> Codec[M]:
    leaves = leaves_of(message_type)
    return variable_codec(message_type, order) if leaves is None else fixed_codec(message_type, order, leaves)
