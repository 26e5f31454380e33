"""Messages of which a part is the same every time: that part is serialized once."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from roverlink.runtime.core.cdr.encapsulation import LITTLE_ENDIAN
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Text, fields_of
from roverlink.runtime.core.messages import Sequence as RosSequence


@dataclass(frozen=True, slots=True)
class Template:
    """Pack `layout` with the varying values in wire order, and before, between and behind them the `constants`."""

    layout: struct.Struct
    constants: tuple[bytes, ...]


class _Stretch(NamedTuple):
    """The bytes of a primitive, of an array of them, or of anything that does not vary."""

    start: int
    end: int
    format: str
    """Of what varies; empty for what does not."""


def template(serialized: bytes, message: Message, varying: Sequence[str]) -> Template:
    """The template of a message, but for the fields at the paths in ``varying`` and all that is below them.

    Raises `TypeError` where such a field has no fixed size.
    """
    stretches = list(_Walk(varying).message(message, 0, ""))
    format, constants, end, fixed = "<", [], -len(LITTLE_ENDIAN), True
    for start, stop, code in stretches:
        if not code:
            fixed = True
            continue
        if gap := start - end:
            format += f"{gap}s" if fixed else f"{gap}x"
            constants += [serialized[end + 4 : start + 4]] if fixed else []
        format, end, fixed = format + code, stop, False
    if rest := serialized[end + 4 :]:
        format, constants = f"{format}{len(rest)}s", [*constants, rest]
    return Template(struct.Struct(format), tuple(constants))


class _Walk:
    """Walks a message in wire order."""

    def __init__(self, varying: Sequence[str]) -> None:
        self._varying = varying

    def message(self, message: Message, position: int, prefix: str) -> Iterator[_Stretch]:
        """The stretches of a message that starts at a position of the body."""
        for field in fields_of(type(message)):
            path = f"{prefix}{field.name}"
            for stretch in self._value(field.type, getattr(message, field.name), position, path):
                yield stretch
                position = stretch.end

    def _value(self, type: FieldType, value: Any, position: int, path: str) -> Iterator[_Stretch]:
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
        """A string or a sequence, whose count comes first; or an array of what is no primitive."""
        if not isinstance(type, Array):
            start = position + -position % 4
            size = len(value.encode()) + 1 if isinstance(value, str) else 0
            yield _Stretch(start, position := start + 4 + size, "")
        if isinstance(type, (RosSequence, Array)):
            for element in value:
                for stretch in self._value(type.element, element, position, path):
                    yield stretch
                    position = stretch.end
