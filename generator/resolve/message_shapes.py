"""Settings of rows for their generated ROS messages: the message's name, renamed fields, and ignored fields."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.resolve.conversion_rules import RowsDisagreeOnAMessage
from roverlink.generator.table import Row, Table


@dataclass(slots=True)
class Shape:
    """Name, renamed fields and ignored fields of a generated ROS message, as a row sets them for its payload.

    A message that is only nested in other messages has no row. Then ``ros`` is the default name, and nothing else is
    set.
    """

    ros: str
    fields: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Names of the renamed ROS fields, by the path of the proto field."""
    ignore: tuple[str, ...] = ()
    row: Row | None = None

    def at(self, group: str, path: str, otherwise: Span) -> Span:
        """Return the place in mapping.yaml of a path that the row lists under the key ``group``, `fields` or `ignore`.

        The result is ``otherwise`` if the row does not list the path.
        """
        return self.row.spans.get(f"{group}.{path}", otherwise) if self.row else otherwise


def shapes_of(table: Table, findings: list[Diagnostic]) -> dict[str, Shape]:
    """Return the settings for the generated ROS message of each row, by the full name of the row's proto message.

    Rows with the same proto message must have the same settings; a difference is reported. Rows with a standard message
    are left out.
    """
    shapes: dict[str, Shape] = {}
    for row in table.rows:
        if row.standard:
            continue
        shape = Shape(row.ros, row.renames, row.ignore, row)
        first = shapes.setdefault(row.proto, shape)
        if (first.ros, first.fields, first.ignore) != (shape.ros, shape.fields, shape.ignore):
            message = f"another row has other settings for {row.proto!r}, but it becomes only one ROS message"
            also = [(first.row.span, f"the row {first.row.name!r}")] if first.row else []
            help = "give both rows the same `ros`, `fields` and `ignore`"
            findings.append(RowsDisagreeOnAMessage.at(row.at("proto"), message, help, also))
    return shapes
