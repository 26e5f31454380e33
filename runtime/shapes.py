"""Payloads of a shape that was seen before: one `struct` call reads them, where protobuf is asked for field by field.

A board's datagrams look alike: the same fields in the same order, most of them numbers of a fixed size. Their *shape*
is what stays the same, tags and lengths; what varies are values, at known places. A shape is learned from a datagram
that protobuf has read, and kept where it reads the same there. Anything else is left to protobuf: payloads of which one
field is a part, has presence, is `sint32` or `sint64`, or is named as no attribute can be; varints of several bytes,
fields that are unknown or come twice.

Who may send can make the bridge learn shapes that nobody needs, in the place of others. Then it costs what protobuf
costs, and no more memory than `MOST` shapes a row.
"""

from __future__ import annotations

import struct
from collections import Counter, namedtuple
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from keyword import iskeyword
from typing import TYPE_CHECKING, Any, NamedTuple

from google.protobuf.descriptor import FieldDescriptor

from runtime.wire_format import FIXED32, FIXED64, VARINT, Field, fields, varint_size

if TYPE_CHECKING:
    from google.protobuf.descriptor import Descriptor
    from google.protobuf.message import Message as ProtoMessage

TRIES = 8
"""So many datagrams of one row and one length are learned from, whether anything can be learned or not."""
MOST = 64
"""So many shapes of one row are kept."""
_START = 3
"""So many bytes at the start are the same in all datagrams of a shape: of the envelope's tag and length, and of a tag
in the payload. They tell one row from another, and mostly one length from another."""


class _Value(NamedTuple):
    """How the value of a field is read."""

    name: str
    format: str
    """For `struct`; a varint's where it is a single byte."""
    wire_type: int


_FORMATS = {
    FieldDescriptor.TYPE_DOUBLE: ("d", FIXED64),
    FieldDescriptor.TYPE_FIXED64: ("Q", FIXED64),
    FieldDescriptor.TYPE_SFIXED64: ("q", FIXED64),
    FieldDescriptor.TYPE_FLOAT: ("f", FIXED32),
    FieldDescriptor.TYPE_FIXED32: ("I", FIXED32),
    FieldDescriptor.TYPE_SFIXED32: ("i", FIXED32),
    FieldDescriptor.TYPE_BOOL: ("?", VARINT),
    FieldDescriptor.TYPE_ENUM: ("B", VARINT),
    FieldDescriptor.TYPE_INT32: ("B", VARINT),
    FieldDescriptor.TYPE_INT64: ("B", VARINT),
    FieldDescriptor.TYPE_UINT32: ("B", VARINT),
    FieldDescriptor.TYPE_UINT64: ("B", VARINT),
}


class Shapes:
    """The shapes of the rows' datagrams, as far as they were learned. For one thread."""

    def __init__(self, payload_types: Mapping[str, Descriptor]) -> None:
        """``payload_types`` are those of the rows, by the name of the payload."""
        values = {name: _values(payload_type) for name, payload_type in payload_types.items()}
        self._values = {name: known for name, known in values.items() if known is not None}
        self._by_start: dict[bytes, list[_Shape]] = {}
        self._tries: Counter[tuple[str, int]] = Counter()
        self._kept: Counter[str] = Counter()

    def read(self, datagram: bytes) -> tuple[str, Any] | None:
        """The name of the payload, and its fields as attributes; None where protobuf has to read it."""
        if shapes := self._by_start.get(datagram[:_START]):
            bits = int.from_bytes(datagram, "little")
            for shape in shapes:
                if bits | shape.varying == shape.filled and len(datagram) == shape.size:
                    return shape.name, shape.payload(shape.unpack(datagram) + shape.absent)
        return None

    def learn(self, datagram: bytes, name: str, payload: ProtoMessage) -> None:
        """Learn where a datagram has the values that protobuf has found in it."""
        attempt = name, len(datagram)
        if name not in self._values or self._tries[attempt] >= TRIES or self._kept[name] >= MOST:
            return
        self._tries[attempt] += 1
        places = _places(datagram, self._values[name])
        if places is None:
            return
        shape = _Shape(name, datagram, places, payload)
        read = shape.payload(shape.unpack(datagram) + shape.absent)._asdict()
        # as texts, so that nan is nan, and neither -0.0 nor False is 0
        if all(repr(value) == repr(getattr(payload, field)) for field, value in read.items()):
            self._by_start.setdefault(datagram[:_START], []).append(shape)
            self._kept[name] += 1


class _Shape:
    """Datagrams that differ in values alone."""

    def __init__(self, name: str, datagram: bytes, places: Sequence[tuple[int, _Value]], payload: ProtoMessage) -> None:
        """``places`` tells where which value begins; fields that are not there have the value that ``payload`` says."""
        self.name = name
        self.size = len(datagram)
        layout, varying, end = "<", bytearray(len(datagram)), 0
        for place, value in places:
            layout += f"{place - end}x{value.format}"
            size = struct.calcsize(f"<{value.format}")
            # the highest bit of a varint's byte says whether another one follows
            varying[place : place + size] = b"\x7f" if value.wire_type == VARINT else b"\xff" * size
            end = place + size
        self.unpack = struct.Struct(f"{layout}{len(datagram) - end}x").unpack
        """The values that are there, of a datagram of this shape."""
        self.varying = int.from_bytes(varying, "little")
        """The bits of the values, the datagram taken for a number of little-endian bytes."""
        self.filled = int.from_bytes(datagram, "little") | self.varying
        """What every datagram of this shape is once those bits are set."""
        present = [value.name for _, value in places]
        absent = [field.name for field in payload.DESCRIPTOR.fields if field.name not in present]
        self.absent = tuple(getattr(payload, field) for field in absent)
        """The values of the fields that are not there."""
        names: Any = namedtuple("Payload", present + absent)  # type: ignore[misc]  # known when it is learned
        self.payload: Callable[[tuple[Any, ...]], Any] = partial(tuple.__new__, names)
        """The payload that has these values, as attributes: first those that are there."""


def _values(payload_type: Descriptor) -> dict[int, _Value] | None:
    """How a payload's fields are read, by their numbers; None where one of them is no plain number."""
    if not all(_is_plain(field) for field in payload_type.fields):
        return None
    return {field.number: _Value(field.name, *_FORMATS[field.type]) for field in payload_type.fields}


def _is_plain(field: FieldDescriptor) -> bool:
    """Whether a field is one number, always there, by a name that a tuple's field can have."""
    can_be_named = not field.name.startswith("_") and not iskeyword(field.name)
    return field.type in _FORMATS and not field.is_repeated and not field.has_presence and can_be_named


def _places(datagram: bytes, values: Mapping[int, _Value]) -> list[tuple[int, _Value]] | None:
    """Where the values of a datagram's payload begin.

    None where it holds more than that, a value that is longer, or a tag or length that is longer than it need be: of
    those there is no end.
    """
    whole = next(fields(datagram))
    begin = whole.content
    if whole.end != len(datagram) or begin != _tag_size(whole) + varint_size(whole.end - begin):
        return None
    places: dict[int, tuple[int, _Value]] = {}
    start = 0
    for field in fields(datagram[begin:]):
        value = values.get(field.number)
        is_long = field.wire_type == VARINT and field.end - field.content > 1
        if value is None or value.wire_type != field.wire_type or is_long or field.number in places:
            return None
        if field.content - start != _tag_size(field):
            return None
        places[field.number] = begin + field.content, value
        start = field.end
    return list(places.values())


def _tag_size(field: Field) -> int:
    return varint_size(field.number << 3)
