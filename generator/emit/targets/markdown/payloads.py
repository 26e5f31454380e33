"""Tables in docs/messages.md of proto messages and enums: types with links, units, and fields of the .msg files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.ir.interfaces import Expression, Parts, Path, Rotation, Taken
from roverlink.generator.ir.msg_types import msg_type
from roverlink.generator.resolve.units import UnitError, parse


@dataclass(frozen=True, slots=True)
class Field:
    """Line of a message's table: a field, or a oneof, which has no number."""

    number: int | None
    name: str
    type: str
    unit: str
    ros: str
    """Fields of the .msg file to which the proto field is converted."""
    meaning: str


@dataclass(frozen=True, slots=True)
class Payload:
    """Section of docs/messages.md for a proto message."""

    name: str
    comment: str
    ros: str
    """Name of the ROS message; empty if the proto message has none."""
    fields: tuple[Field, ...]
    reserved: str
    """Reserved numbers as text; empty if there are none."""


@dataclass(frozen=True, slots=True)
class Value:
    """Line of an enum's table: an enum value."""

    number: int
    name: str
    constants: tuple[str, ...]
    """Names of the .msg constants that stand for the value, except a name that is equal to the value's own name."""
    meaning: str


class Payloads:
    """Messages and enums that the envelope can contain, as the page shows them."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self._messages = {message.name: message for message in bridge.wire_messages}
        self._enums = {enum.name for enum in bridge.wire_enums}
        routed = [route.conversion for route in reversed(bridge.routes) if route.conversion]
        self._conversions = {conversion.proto: conversion for conversion in (*bridge.nested, *routed)}
        self._rows = {route.proto: route for route in reversed(bridge.routes)}
        self._units = Units(bridge)
        self._constants: dict[tuple[str, int], dict[str, None]] = {}
        for constant in (constant for message in bridge.messages for constant in message.constants):
            self._constants.setdefault((constant.enum, constant.value), {})[constant.name] = None

    def comment(self, proto: str) -> str:
        """Return the comment of a proto message."""
        return self._messages[proto].comment

    def of(self, proto: str) -> Payload:
        """Return the section of the page for a proto message."""
        message = self._messages[proto]
        conversion = self._conversions.get(proto)
        ranges = [str(first) if first == last else f"{first} to {last}" for first, last in message.reserved]
        fields = (*self._fields(message, conversion), *_oneofs(message, conversion))
        return Payload(proto, message.comment, conversion.ros if conversion else "", fields, ", ".join(ranges))

    def values(self, enum: ir.WireEnum) -> tuple[Value, ...]:
        """Return the lines of an enum's table, one for each value."""
        return tuple(
            Value(value.number, value.name, self._renamed(enum, value), cell(value.comment)) for value in enum.values
        )

    def _renamed(self, enum: ir.WireEnum, value: ir.WireValue) -> tuple[str, ...]:
        return tuple(name for name in self._constants.get((enum.name, value.number), ()) if name != value.name)

    def anchor(self, proto: str) -> str:
        """Return the anchor, for links, of the section that shows a message or enum; ``proto`` is its full name."""
        return self.anchor_of_row(self._rows[proto]) if proto in self._rows else _anchor(proto)

    @staticmethod
    def anchor_of_row(route: ir.Route) -> str:
        """Return the anchor of a row's section: ``13-imu_info`` for the heading ``13: imu_info``."""
        return _anchor(f"{route.number}: {route.name}")

    def _fields(self, message: ir.WireMessage, conversion: ir.Conversion | None) -> Iterator[Field]:
        taken = _taken(conversion)
        for field in message.fields:
            meaning, unit = self._units.split(message.name, field)
            ros = ", ".join(taken.get(field.name, ()))
            yield Field(field.number, field.name, self._type(field), unit, ros, cell(meaning))

    def _type(self, field: ir.WireField) -> str:
        held = self._messages.get(field.type)
        if held is not None and held.map_entry:
            key, value = (self._linked(field.type) for field in held.fields)
            return f"map of {key} to {value}"
        type = self._linked(field.type)
        return " ".join(filter(None, (field.label, type, f"in oneof `{field.oneof}`" if field.oneof else "")))

    def _linked(self, type: str) -> str:
        known = type in self._messages or type in self._enums
        if not known or type.startswith("google.protobuf."):
            return f"`{type}`"
        return f"[`{type}`](#{self.anchor(type)})"


def cell(text: str) -> str:
    """Return a text in the form that a cell of a Markdown table needs: on one line, with special characters escaped."""
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")


def _anchor(heading: str) -> str:
    """Return the anchor that GitHub and Python-Markdown give to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _taken(conversion: ir.Conversion | None) -> dict[str, list[str]]:
    """Return the fields of the .msg file for each field of a proto message.

    A .msg field that comes from inside a nested message is listed for the field with the nested message.
    """
    taken: dict[str, list[str]] = {}
    for field in conversion.fields if conversion else ():
        inner = f" from `{'.'.join(field.proto_path)}`" if len(field.proto_path) > 1 else ""
        ros = f"`{msg_type(field.ros.type)} {field.ros.name}`{inner}"
        taken.setdefault(field.proto_path[0], []).append(ros)
    return taken


def _oneofs(message: ir.WireMessage, conversion: ir.Conversion | None) -> Iterator[Field]:
    """Yield a line for each oneof of a message, with the .msg field that tells which member is set."""
    taken = _taken(conversion)
    for name in dict.fromkeys(field.oneof for field in message.fields if field.oneof):
        yield Field(None, name, "oneof", "", ", ".join(taken.get(name, ())), "")


_BRACKETS = re.compile(r"\s*\[(?P<unit>[^\[\]]{1,20})\](?P<stop>\.?)$")


class Units:
    """Lookup of the unit of each field in a bridge's payloads."""

    def __init__(self, bridge: ir.Bridge) -> None:
        types = {(message.name, field.name): field.type for message in bridge.wire_messages for field in message.fields}
        self._of_table: dict[tuple[str, str], str] = {}
        for standard in (standard for route in bridge.routes for standard in route.standard_topics):
            for path, unit in _units(standard):
                message = standard.proto
                for name in path[:-1]:
                    message = types[message, name]
                self._of_table[message, path[-1]] = unit

    def split(self, message: str, field: ir.WireField) -> tuple[str, str]:
        """Return the comment of a field without the unit, and the unit.

        A unit in the table overrides a unit in the comment.
        """
        comment, unit = _stated(field.comment)
        return comment, self._of_table.get((message, field.name), unit)


def _stated(comment: str) -> tuple[str, str]:
    """Return a comment without the unit in brackets at its end, and the unit; the unit is empty if there is none.

    ``Voltage [V].`` becomes ``Voltage.`` and ``V``.
    """
    found = _BRACKETS.search(comment)
    if found is None:
        return comment, ""
    try:
        parse(found["unit"])
    except UnitError:
        return comment, ""
    return f"{comment[: found.start()]}{found['stop']}", found["unit"]


def _units(standard: ir.StandardTopic) -> Iterator[tuple[Path, str]]:
    """Yield path and unit of each payload field whose unit the table gives: ``{from: temperature, unit: degC}``."""
    for target in standard.fields:
        for taken in _taken_fields(target.value):
            if taken.scaling.unit:
                yield taken.source.path, taken.scaling.unit


def _taken_fields(value: Expression) -> Iterator[Taken]:
    if isinstance(value, Parts):
        for part in value.fields:
            yield from _taken_fields(part.value)
    elif isinstance(value, Rotation):
        for angle in (value.roll, value.pitch, value.yaw):
            yield from _taken_fields(angle)
    elif isinstance(value, Taken):
        yield value
