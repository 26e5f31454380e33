"""Example datagrams: an envelope with plausible values, encoded by protobuf and explained field by field."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass

from roverlink.generator import ir
from roverlink.generator.example_payloads import EXAMPLE_S, payload_at
from roverlink.numerals import counted

_BYTES_A_LINE = 16


@dataclass(frozen=True, slots=True)
class Line:
    """Line of an example: some bytes of the datagram in hexadecimal, and their meaning."""

    hex: str
    meaning: str = ""


@dataclass(frozen=True, slots=True)
class Example:
    """Example datagram of a row, with its sizes in bytes and one line for each field."""

    payload_size: int
    datagram_size: int
    lines: tuple[Line, ...]

    @property
    def width(self) -> int:
        """Number of characters in the longest line of hexadecimal bytes."""
        return max((len(line.hex) for line in self.lines), default=0)


class Examples:
    """Maker of an example datagram for each row. It needs no generated code: it uses the descriptors in the IR."""

    def __init__(self, bridge: ir.Bridge) -> None:
        pool = DescriptorPool()
        for file in FileDescriptorSet.FromString(bridge.descriptors).file:
            pool.Add(file)
        self._envelope: Any = GetMessageClass(pool.FindMessageTypeByName(bridge.envelope.message))

    def of(self, route: ir.Route) -> Example:
        """Return the example datagram of a row."""
        envelope = self._envelope()
        payload = getattr(envelope, route.name)
        payload.CopyFrom(payload_at(type(payload), EXAMPLE_S))
        payload.SetInParent()
        return Example(len(_encoded(payload)), len(_encoded(envelope)), tuple(_lines(envelope, 0)))


def _encoded(message: Message) -> bytes:
    """Encode a message; required fields may be missing, which `SerializeToString` would refuse."""
    return message.SerializePartialToString(deterministic=True)


def _lines(message: Message, depth: int) -> Iterator[Line]:
    """Yield a line for each field of a message, sorted by field number, with the lines of nested messages below.

    If a nested message has the same type and bytes as an earlier one, the line only refers to that one.
    """
    earlier: dict[tuple[str, bytes], str] = {}
    for field, held in message.ListFields():
        if field.message_type is None:
            yield from _wrapped(_alone(message, field, held), f"{'  ' * depth}{field.name}: {_text(field, held)}")
            continue
        for value in held if field.is_repeated else [held]:
            inner = _encoded(value)
            data = _alone(message, field, [value] if field.is_repeated else value)
            key = (field.message_type.full_name, inner)
            if inner and key in earlier:
                yield from _wrapped(data, f"{'  ' * depth}{field.name}: as {earlier[key]}")
                continue
            earlier.setdefault(key, field.name)
            yield from _taken_apart(field, value, data, depth)


def _taken_apart(field: FieldDescriptor, value: Message, data: bytes, depth: int) -> Iterator[Line]:
    size = value.ByteSize()
    around = len(data) - size
    start = around // 2 if field.type == field.TYPE_GROUP else around  # a group also has a tag at its end
    yield Line(data[:start].hex(" "), f"{'  ' * depth}{field.name}: {value.DESCRIPTOR.name}, {counted(size, 'byte')}")
    yield from _lines(value, depth + 1)
    if start < around:
        yield Line(data[start + size :].hex(" "), f"{'  ' * depth}end of {field.name}")


def _alone(message: Message, field: FieldDescriptor, held: Any) -> bytes:
    """Return the bytes of one field: encode a message of the same type in which only this field is set."""
    one = type(message)()
    if field.is_repeated:
        getattr(one, field.name).extend(held)
    elif field.message_type is not None:
        getattr(one, field.name).CopyFrom(held)
        getattr(one, field.name).SetInParent()
    else:
        setattr(one, field.name, held)
    return _encoded(one)


def _wrapped(data: bytes, meaning: str) -> Iterator[Line]:
    yield Line(data[:_BYTES_A_LINE].hex(" "), meaning)
    for start in range(_BYTES_A_LINE, len(data), _BYTES_A_LINE):
        yield Line(data[start : start + _BYTES_A_LINE].hex(" "))


def _text(field: FieldDescriptor, held: Any) -> str:
    if field.is_repeated:
        values: Iterable[Any] = held
        return f"[{', '.join(_value(field, value) for value in values)}]"
    return _value(field, held)


def _value(field: FieldDescriptor, value: Any) -> str:
    if field.enum_type is not None:
        return field.enum_type.values_by_number[value].name
    if field.type == field.TYPE_BYTES:
        return counted(len(value), "byte")
    if field.type == field.TYPE_FLOAT:
        return f"{value:.7g}"  # a 32-bit float has about 7 decimal digits
    return json.dumps(value)
