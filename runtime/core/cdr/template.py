"""Templates of messages: the constant fields are serialized once, and only the varying fields are packed each time."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from roverlink.runtime.core.cdr.encapsulation import LITTLE_ENDIAN
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Text, fields_of
from roverlink.runtime.core.messages import Sequence as RosSequence


# A sensor_msgs/Imu has 324 bytes, of which a board usually reports the stamp and six numbers. The rest is constant: the
# frame's name, the covariances, the orientation. Serialized once, it is copied as it is:
#
#     constant | stamp | constant | angular velocity | constant | linear acceleration | constant
#
# The places of the varying fields depend on the length of the constant strings before them, so they are computed from
# the message itself and not from its type.
@dataclass(frozen=True, slots=True)
class Template:
    """Precomputed form of a message whose constant fields are serialized already.

    To get a serialized message, pack `layout` with the `constants` and the varying values, in the order in which they
    stand in the message. The first constant begins with the encapsulation header.
    """

    layout: struct.Struct
    constants: tuple[bytes, ...]


class _Stretch(NamedTuple):
    """Byte range of one part of a message: a primitive, an array of primitives, a string, or a sequence's count.

    Positions count from after the encapsulation header.
    """

    start: int
    end: int
    format: str
    """`struct` format of a varying part; empty for a constant part."""


def template(serialized: bytes, message: Message, varying: Sequence[str]) -> Template:
    """Build the template of a message from its serialized form; the fields at the dotted paths in ``varying`` vary.

    If a path leads to a nested message, all fields of the nested message vary. Raises `TypeError` if a varying field
    has no fixed size.
    """
    stretches = list(_Walk(varying).message(message, 0, ""))
    format, constants, end, fixed = "<", [], -len(LITTLE_ENDIAN), True
    for start, stop, code in stretches:
        if not code:
            fixed = True
            continue
        # A gap of constants is packed as a byte string; between two varying fields it can only be padding.
        if gap := start - end:
            format += f"{gap}s" if fixed else f"{gap}x"
            constants += [serialized[end + 4 : start + 4]] if fixed else []
        format, end, fixed = format + code, stop, False
    if rest := serialized[end + 4 :]:
        format, constants = f"{format}{len(rest)}s", [*constants, rest]
    return Template(struct.Struct(format), tuple(constants))


class _Walk:
    """Walk through the fields of a message that computes the byte range of each field in the serialized message."""

    def __init__(self, varying: Sequence[str]) -> None:
        self._varying = varying

    def message(self, message: Message, position: int, prefix: str) -> Iterator[_Stretch]:
        """Yield the byte range of each field of a message that starts at a position of the CDR body.

        ``prefix`` is the path of the message inside another message, with a dot at its end.
        """
        for field in fields_of(type(message)):
            path = f"{prefix}{field.name}"
            for stretch in self._value(field.type, getattr(message, field.name), position, path):
                yield stretch
                position = stretch.end

    def _value(self, type: FieldType, value: Any, position: int, path: str) -> Iterator[_Stretch]:
        # A path varies with everything below it: the whole vector for `angular_velocity`.
        varies = any(path == other or path.startswith(f"{other}.") for other in self._varying)
        if isinstance(type, Primitive):
            start = position + -position % type.size
            yield _Stretch(start, start + type.size, type.format if varies else "")
        elif isinstance(type, Array) and isinstance(type.element, Primitive):
            start = position + -position % type.element.size
            code = f"{type.length}{type.element.format}" if varies else ""
            yield _Stretch(start, start + type.length * type.element.size, code)
        elif isinstance(type, (Text, RosSequence, Array)):
            if varies:
                raise TypeError(f"{path} has no fixed size")
            yield from self._counted(type, value, position, path)
        else:
            yield from self.message(value, position, f"{path}.")

    def _counted(self, type: FieldType, value: Any, position: int, path: str) -> Iterator[_Stretch]:
        """Yield the byte ranges of a string, or of a sequence or array whose elements are not all of fixed size.

        A string or a sequence begins with a count, an array does not.
        """
        if not isinstance(type, Array):
            start = position + -position % 4
            size = len(value.encode()) + 1 if isinstance(value, str) else 0
            yield _Stretch(start, position := start + 4 + size, "")
        if isinstance(type, (RosSequence, Array)):
            for element in value:
                for stretch in self._value(type.element, element, position, path):
                    yield stretch
                    position = stretch.end
