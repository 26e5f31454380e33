"""Overrides that the rows contain for the generated ROS messages: names of messages and fields, and ignored fields."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.resolve.conversion_rules import DISAGREEING_ROWS
from roverlink.generator.table import Row, Table


@dataclass(slots=True)
class Shape:
    """Name, field names and ignored fields that a row sets for the ROS message of its payload."""

    ros: str
    fields: Mapping[str, str] = dataclasses.field(default_factory=dict)
    ignore: tuple[str, ...] = ()
    row: Row | None = None

    def at(self, group: str, path: str, otherwise: Span) -> Span:
        """Return the place of a path under ``fields`` or ``ignore`` in the row; ``otherwise`` if it is not there."""
        return self.row.spans.get(f"{group}.{path}", otherwise) if self.row else otherwise


def shapes_of(table: Table, findings: list[Diagnostic]) -> dict[str, Shape]:
    """Return the shape of the ROS message for each row's proto message, by the proto message's full name.

    Rows with the same proto message must have the same settings for it; a difference is reported.
    """
    shapes: dict[str, Shape] = {}
    for row in table.rows:
        if row.standard:
            continue
        shape = Shape(row.ros, row.renames, row.ignore, row)
        first = shapes.setdefault(row.proto, shape)
        if (first.ros, first.fields, first.ignore) != (shape.ros, shape.fields, shape.ignore):
            message = f"another row has other settings for {row.proto!r}, which becomes only one ROS message"
            also = [(first.row.span, f"the row {first.row.name!r}")] if first.row else []
            help = "give both rows the same `ros`, `fields` and `ignore`"
            findings.append(DISAGREEING_ROWS.at(row.at("proto"), message, help, also))
    return shapes
