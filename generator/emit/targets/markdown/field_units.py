"""Units of payload fields.

A unit comes from the table, which gives it for a standard message, or from brackets at the end of a comment: ``[V]``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from roverlink.generator import ir
from roverlink.generator.ir.interfaces import Expression, Parts, Path, Rotation, Taken
from roverlink.generator.resolve.units import UnitError, parse

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
