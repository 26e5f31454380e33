"""CDR codec of messages that consist only of primitive fields, also inside nested messages.

Such a message has a fixed size, so one `struct.Struct` packs the whole message.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from roverlink.runtime.core.cdr.encapsulation import BOOL, LITTLE_ENDIAN, Codec, check_flags
from roverlink.runtime.core.messages import Array, Message, Primitive, Sequence, Text, fields_of

M = TypeVar("M", bound=Message)


class Leaf(NamedTuple):
    """Primitive field inside a message at any depth, with its dotted path, such as ``orientation.x``."""

    path: str
    primitive: Primitive


def leaves_of(message_type: type[Message]) -> list[Leaf] | None:
    """Return the primitive fields of a message class in wire order.

    Returns None if the message or a message inside it has a string, a sequence, an array, or no fields.
    """
    leaves = list(_leaves(message_type))
    return None if None in leaves else [leaf for leaf in leaves if leaf is not None]


def _leaves(message_type: type[Message], prefix: str = "") -> Iterator[Leaf | None]:
    """Yield the primitive fields of a message class in wire order; None for each part that `leaves_of` excludes."""
    fields = fields_of(message_type)
    # A message without fields is written as a placeholder byte, which only the codec in `variable` writes.
    if not fields:
        yield None
    for field in fields:
        if isinstance(field.type, Primitive):
            yield Leaf(prefix + field.name, field.type)
        elif isinstance(field.type, (Text, Sequence, Array)):
            yield None
        else:
            yield from _leaves(field.type, f"{prefix}{field.name}.")


def layout(primitives: list[Primitive]) -> str:
    """Return the `struct` format, without byte order, for primitives that follow each other with CDR's padding.

    >>> layout([Primitive("bool", "?", 1), Primitive("float64", "d", 8)])
    '?7xd'
    """
    position, parts = 0, []
    for primitive in primitives:
        # XTypes 1.3, 7.4.1: alignment is that of the primitive, counted from the start of the body.
        # So 8 bytes for float64 and int64. XCDR version 2 would align these to 4: the two versions give different
        # bytes.
        padding = -position % primitive.size
        parts.append(f"{padding}x" if padding else "")
        parts.append(primitive.format)
        position += padding + primitive.size
    return "".join(parts)


def _struct(order: str, leaves: list[Leaf]) -> struct.Struct:
    # With an explicit byte order, `struct` adds no alignment of its own. So the four bytes of the header do not shift
    # the body, in which alignment is counted.
    return struct.Struct(order + "4s" + layout([leaf.primitive for leaf in leaves]))


def fixed_codec(message_type: type[M], order: str, leaves: list[Leaf]) -> Codec[M]:
    """Make the codec of a message class from its primitive fields; ``order`` is the byte order, as in `struct`."""
    packer = _struct(order, leaves)
    paths = [leaf.path for leaf in leaves]
    values_of = attrgetter(*paths) if len(paths) > 1 else _one(attrgetter(paths[0]))
    flags = [index for index, leaf in enumerate(leaves) if leaf.primitive.format == BOOL]
    build = _builder(message_type)

    def encode_fixed(message: M) -> bytes:
        values = values_of(message)
        check_flags(values[index] for index in flags)
        return packer.pack(LITTLE_ENDIAN, *values)

    def decode_fixed(data: bytes) -> M:
        # unpack_from ignores bytes after the end, which padding may add.
        values = iter(packer.unpack_from(data))
        next(values)
        message: M = build(values)
        return message

    return Codec(encode_fixed, decode_fixed)


def _one(getter: Callable[[Any], Any]) -> Callable[[Any], tuple[Any]]:
    return lambda message: (getter(message),)


def _builder(message_type: type[Message]) -> Callable[[Iterator[Any]], Any]:
    """Return a function that builds a message from an iterator over its primitive values in wire order."""
    parts: list[Callable[[Iterator[Any]], Any]] = [
        _builder(field.type) if isinstance(field.type, type) else next for field in fields_of(message_type)
    ]
    return lambda values: message_type(*[part(values) for part in parts])
