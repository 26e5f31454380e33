"""Size limits under `bounds` in mapping.yaml: the length of a string or `bytes`, or the count of a repeated field."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span, shown
from roverlink.generator.nanopb.option_rules import BoundsInTwoPlaces, UnfitBound
from roverlink.generator.nanopb.options import Values
from roverlink.generator.nanopb.options_file import OptionsLine, options_file_of
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import Bound, Row, Table
from roverlink.suggestions import nearest

_HAVE_A_LENGTH = ("string", "bytes")
_SIGNATURE_BYTES = 15  # key id (1), timestamp (6) and MAC (8); runtime/core/signing.py


def table_bounds(table: Table, schema: Schema, root: Path, findings: list[Diagnostic]) -> dict[ir.FieldBound, Span]:
    """Return the size limits that the rows set under `bounds`, with their places in mapping.yaml.

    A limit that does not fit its field is reported. ``root`` is the folder of the .proto files. If a .options file is
    beside the .proto file, the limit must be there, and a limit in the table is reported.
    """
    found: dict[tuple[str, str], tuple[ir.FieldBound, Span]] = {}
    for row in (row for row in table.rows if row.proto in schema.messages):
        for path, bound in row.bounds.items():
            span = row.at(f"bounds.{path}")
            try:
                resolved = _resolved(row, path, bound, schema)
            except LookupError as error:
                findings.append(UnfitBound.at(span, *error.args))
                continue
            key = (resolved.message, resolved.field)
            before, place = found.setdefault(key, (resolved, span))
            if before != resolved:
                message = f"'{'.'.join(key)}' has a different bound in another row"
                also = [(place, "the other bound is here")]
                findings.append(UnfitBound.at(span, message, "write the same bound in both rows", also))
    bounds = dict([*found.values(), *_of_signature(table, schema, root)])
    _report_files(bounds, root, table.proto.root, findings)
    return bounds


def _of_signature(table: Table, schema: Schema, root: Path) -> Iterator[tuple[ir.FieldBound, Span]]:
    """Yield the size of the envelope's signature, if the table declares one, and if no .options file can set it."""
    envelope, signing = schema.messages.get(table.envelope.message), table.signing
    if signing is not None and envelope is not None and not (root / options_file_of(envelope.file)).is_file():
        bound = ir.FieldBound(envelope.file, envelope.full_name, signing.name, True, _SIGNATURE_BYTES, None)
        yield bound, signing.at("number")


def _resolved(row: Row, path: str, bound: Bound, schema: Schema) -> ir.FieldBound:
    """Return the size limit for the field at a path in a row's payload.

    Raises `LookupError`, with a message and a help text, if the limit does not fit the field.
    """
    message, field = _field(row, path.split("."), schema)
    if bound.length is not None and field.type not in _HAVE_A_LENGTH:
        raise LookupError(f"the field {path!r} is not a string or bytes, so it has no `length`", "remove `length`")
    if bound.count is not None and not field.repeated:
        raise LookupError(f"the field {path!r} is not repeated, so it has no `count`", "remove `count`")
    if bound.length is None and bound.count is None:
        raise LookupError(f"the bound of the field {path!r} is empty", "write `length`, `count`, or both")
    return ir.FieldBound(message.file, message.full_name, field.name, field.type == "bytes", bound.length, bound.count)


def _field(row: Row, path: list[str], schema: Schema) -> tuple[ProtoMessage, ProtoField]:
    *outer, last = path
    message = schema.messages[row.proto]
    for name in outer:
        field = _named(message, name)
        if field.type_name not in schema.messages:
            raise LookupError(f"the field {name!r} is not a message, so it has no fields", "end the path at this field")
        message = schema.messages[field.type_name]
    return message, _named(message, last)


def _named(message: ProtoMessage, name: str) -> ProtoField:
    fields = {field.name: field for field in message.fields}
    if name not in fields:
        raise LookupError(f"{message.full_name!r} has no field {name!r}", nearest(name, fields, ""))
    return fields[name]


def _report_files(
    bounds: Mapping[ir.FieldBound, Span], root: Path, shown_root: str, findings: list[Diagnostic]
) -> None:
    """Report each size limit for a field whose .proto file has a .options file beside it.

    nanopb reads only one .options file for each .proto file.
    """
    for bound, span in bounds.items():
        beside = options_file_of(bound.file)
        if (root / beside).is_file():
            field = f"'{bound.message}.{bound.field}'"
            message = f"{field} has a bound in the table, but {shown(shown_root, beside)} exists"
            help = "nanopb reads one .options file for a .proto file: write all bounds in one of the two places"
            findings.append(BoundsInTwoPlaces.at(span, message, help))


def as_options(bound: ir.FieldBound) -> Values:
    """Return the options of nanopb that set a size limit: a string's length 20 gives ``{"max_length": 20}``."""
    options = {"max_size" if bound.is_bytes else "max_length": bound.length, "max_count": bound.count}
    return {name: value for name, value in options.items() if value is not None}


def as_lines(bounds: Mapping[ir.FieldBound, Span]) -> Mapping[str, list[OptionsLine]]:
    """Return the size limits as lines of .options files, by the path of the .proto file that declares the field."""
    lines: dict[str, list[OptionsLine]] = {}
    for bound, span in bounds.items():
        name = f"{bound.message}.{bound.field}"
        lines.setdefault(bound.file, []).append(OptionsLine(name, name.__eq__, as_options(bound), span))
    return lines
