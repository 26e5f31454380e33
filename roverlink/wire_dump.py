"""Explanation of the bytes of a serialized protobuf message, with one line for each field."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from roverlink.numerals import counted
from roverlink.runtime.core.wire_format import (
    DELIMITED,
    FIXED32,
    FIXED64,
    GROUP_END,
    GROUP_START,
    VARINT,
    fields,
    varint,
)

if TYPE_CHECKING:
    from google.protobuf.descriptor import FieldDescriptor


class WireLine(NamedTuple):
    """One line of the explanation: the bytes of a field, and their meaning."""

    depth: int
    """Nesting depth of the field: 0 in the outermost message, 1 in a message inside it."""
    bytes: str
    """Bytes in hexadecimal, such as ``0d 00 00 c0 3f``."""
    meaning: str
    """Name, number and value of the field, such as ``accel_x = 1: 1.5``."""


def wire_lines(data: bytes, message: Any, depth: int = 0) -> Iterator[WireLine]:
    """Yield a line for each field of the serialized message ``data``.

    A nested message has one line for its start, and one line for each of its fields. ``message`` is the descriptor of
    the message, and ``depth`` the nesting depth of its fields (see `WireLine`).
    """
    start = 0
    groups: list[Any] = []  # open groups; their fields follow as top-level fields of the reader
    for number, kind, content, end in fields(data):
        here = data[start:end].hex(" ")
        if kind == GROUP_END:
            yield WireLine(depth + len(groups) - 1, here, f"end of {groups.pop().name}")
        else:
            field = (groups[-1].message_type if groups else message).fields_by_number[number]
            below, name = depth + len(groups), f"{field.name} = {number}"
            if kind == GROUP_START:
                yield WireLine(below, here, f"{name}, {field.message_type.name} as a group")
                groups.append(field)
            elif kind == DELIMITED and field.message_type is not None:
                size = f"{field.message_type.name} of {counted(end - content, 'byte')}"
                yield WireLine(below, data[start:content].hex(" "), f"{name}, {size}")
                yield from wire_lines(data[content:end], field.message_type, below + 1)
            else:
                yield WireLine(below, here, f"{name}: {_content(data[content:end], kind, field)}")
        start = end


def _content(content: bytes, kind: int, field: FieldDescriptor) -> str:
    return _delimited(content, field) if kind == DELIMITED else _value(content, 0, kind, field)[0]


def _value(data: bytes, position: int, kind: int, field: FieldDescriptor) -> tuple[str, int]:
    """Return the text for the varint or the value of fixed size at ``position``, and the position after the value."""
    if kind == VARINT:
        raw, end = varint(data, position)
        return _of_varint(raw, field), end
    size = 8 if kind == FIXED64 else 4
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
    # A float has about seven significant digits; as a double, 0.1 would be shown as 0.10000000149011612.
    return float(f"{value:.7g}") if field.type == field.TYPE_FLOAT else value


def _of_varint(raw: int, field: FieldDescriptor) -> str:
    if field.type == field.TYPE_BOOL:
        return "true" if raw else "false"
    if field.type in (field.TYPE_SINT32, field.TYPE_SINT64):
        # ZigZag encoding of sint32 and sint64.
        return str(raw >> 1 ^ -(raw & 1))
    # A negative int32 or int64 is a varint of its 64-bit two's complement.
    value = raw - (1 << 64) if raw >> 63 and field.type not in (field.TYPE_UINT32, field.TYPE_UINT64) else raw
    known = field.enum_type.values_by_number.get(value) if field.enum_type is not None else None
    return f"{value} ({known.name})" if known else str(value)


def _delimited(content: bytes, field: FieldDescriptor) -> str:
    """Return the text for a length-delimited value: a string, bytes, or a packed list of numbers."""
    if field.type == field.TYPE_STRING:
        return repr(content.decode("utf-8", errors="replace"))
    if field.type == field.TYPE_BYTES:
        return counted(len(content), "byte")
    values, position = [], 0
    kinds = {field.TYPE_DOUBLE: FIXED64, field.TYPE_FIXED64: FIXED64, field.TYPE_SFIXED64: FIXED64}
    kinds |= {field.TYPE_FLOAT: FIXED32, field.TYPE_FIXED32: FIXED32, field.TYPE_SFIXED32: FIXED32}
    while position < len(content):
        value, position = _value(content, position, kinds.get(field.type, VARINT), field)
        values.append(value)
    return f"[{', '.join(values)}]"
