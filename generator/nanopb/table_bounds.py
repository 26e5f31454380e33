"""The bounds that the table gives: how long a text may be, and how many values a field may have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span, nearest, shown
from roverlink.generator.nanopb.option_rules import BOUNDS_IN_TWO_PLACES, UNFIT_BOUND
from roverlink.generator.nanopb.options import Values
from roverlink.generator.nanopb.options_file import OptionsLine, options_file_of
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import Bound, Row, Table

_HAVE_A_LENGTH = ("string", "bytes")


@dataclass(frozen=True, slots=True)
class TableBound:
    """A bound, with the place in the table where it is said."""

    bound: ir.FieldBound
    span: Span


def table_bounds(table: Table, schema: Schema, root: Path, findings: list[Diagnostic]) -> list[TableBound]:
    """The bounds that rows give, by message and field; what does not fit the field is added to the findings.

    ``root`` is the folder of the .proto files: a file that has a .options file beside it has its bounds there.
    """
    found: dict[tuple[str, str], TableBound] = {}
    for row in (row for row in table.rows if row.proto in schema.messages):
        for path, bound in row.bounds.items():
            span = row.at(f"bounds.{path}")
            try:
                one = TableBound(_resolved(row, path, bound, schema), span)
            except LookupError as error:
                findings.append(UNFIT_BOUND.at(span, *error.args))
                continue
            key = (one.bound.message, one.bound.field)
            before = found.setdefault(key, one)
            if before.bound != one.bound:
                message = f"{'.'.join(key)} has another bound in another row"
                findings.append(UNFIT_BOUND.at(span, message, "give both the same", [(before.span, "there")]))
    _report_files(list(found.values()), root, table.proto.root, findings)
    return list(found.values())


def _resolved(row: Row, path: str, bound: Bound, schema: Schema) -> ir.FieldBound:
    """The bound of the field that a path leads to. Raises `LookupError`, with a message and a cure, where none fits."""
    message, field = _field(row, path.split("."), schema)
    if bound.length is not None and field.type not in _HAVE_A_LENGTH:
        raise LookupError(f"{path} is no text and no bytes, so it has no length")
    if bound.count is not None and not field.repeated:
        raise LookupError(f"{path} is not repeated, so it has no count")
    if bound.length is None and bound.count is None:
        raise LookupError(f"{path} is given no bound", "write `length`, `count`, or both")
    return ir.FieldBound(message.file, message.full_name, field.name, field.type == "bytes", bound.length, bound.count)


def _field(row: Row, path: list[str], schema: Schema) -> tuple[ProtoMessage, ProtoField]:
    *outer, last = path
    message = schema.messages[row.proto]
    for name in outer:
        field = _named(message, name)
        if field.type_name not in schema.messages:
            raise LookupError(f"{name} is no message, so that no field in it can be named")
        message = schema.messages[field.type_name]
    return message, _named(message, last)


def _named(message: ProtoMessage, name: str) -> ProtoField:
    fields = {field.name: field for field in message.fields}
    if name not in fields:
        raise LookupError(f"{message.full_name} has no field {name!r}", nearest(name, fields))
    return fields[name]


def _report_files(bounds: list[TableBound], root: Path, shown_root: str, findings: list[Diagnostic]) -> None:
    """Nanopb reads one .options file for each .proto file, so bounds of one file must stand in one place."""
    for one in bounds:
        beside = options_file_of(one.bound.file)
        if (root / beside).is_file():
            message = f"{one.bound.message}.{one.bound.field} is bounded here, and {shown(shown_root, beside)} is there"
            help = "nanopb reads one .options file for a .proto file: say all bounds in one of the two places"
            findings.append(BOUNDS_IN_TWO_PLACES.at(one.span, message, help))


def as_options(bound: ir.FieldBound) -> Values:
    """What nanopb calls a bound."""
    options = {"max_size" if bound.is_bytes else "max_length": bound.length, "max_count": bound.count}
    return {name: value for name, value in options.items() if value is not None}


def as_lines(bounds: list[TableBound]) -> Mapping[str, list[OptionsLine]]:
    """The bounds as lines of the .options file of each .proto file."""
    lines: dict[str, list[OptionsLine]] = {}
    for one in bounds:
        name = f"{one.bound.message}.{one.bound.field}"
        lines.setdefault(one.bound.file, []).append(OptionsLine(name, name.__eq__, as_options(one.bound), one.span))
    return lines
