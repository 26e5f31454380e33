"""A tree of .proto files without a mapping.yaml, as a table that says nothing but where the envelope is.

Its rows are the members of the envelope, so that the rules for numbers and names see them as they see a table's.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from dataclasses import dataclass

from generator import ir
from generator.findings import FindingsError, Rule, Severity, Span
from generator.protos import ProtoField, ProtoMessage, Schema
from generator.table import EnvelopeSettings, Outputs, ProtoSettings, Row, Table

NO_ENVELOPE_MESSAGE = Rule("STA104", "no-envelope-message", Severity.FATAL)


@dataclass(frozen=True, slots=True)
class EnvelopeName:
    """Which message carries the payloads, as the command line says it."""

    file: str
    """Relative to the tree; empty for none."""
    message: str


def table_of_tree(envelope: EnvelopeName) -> Table:
    """A table without rows; `with_members` gives it those of the envelope."""
    here = Span(envelope.file or ".")
    return Table(
        file=envelope.file,
        whole=False,
        numbers=frozenset(),
        proto=ProtoSettings(here, {}, "", ()),
        envelope=EnvelopeSettings(here, {}, envelope.file, envelope.message, "", "proto"),
        package="",
        package_span=here,
        maintainer="",
        peers=(),
        rows=(),
        retired=(),
        enums=(),
        outputs=Outputs(here, {}, (), ()),
        lint=(),
    )


def with_members(table: Table, schema: Schema, *, known: bool = False) -> Table:
    """The table of a tree with a row for each member of its envelope; any other table as it is.

    Raises `FindingsError` where there is no such envelope, unless it is ``known`` from elsewhere.
    """
    if table.proto.root or not table.envelope.message:
        return table
    envelope = schema.messages.get(table.envelope.message)
    if envelope is None and known:
        return table
    if envelope is None:
        message = f"no message {table.envelope.message} is declared in a file that compiles"
        raise FindingsError([NO_ENVELOPE_MESSAGE.at(table.envelope.span, message, "say --message")])
    oneof = _largest_oneof(envelope)
    members = [field for field in envelope.fields if field.oneof == oneof]
    return dataclasses.replace(
        table,
        envelope=dataclasses.replace(table.envelope, oneof=oneof, span=envelope.span),
        numbers=frozenset(field.number for field in members),
        rows=tuple(_row(field) for field in members),
    )


def _largest_oneof(envelope: ProtoMessage) -> str:
    """The oneof with the most members; empty where there is none, and then every field is a payload."""
    counted = Counter(field.oneof for field in envelope.fields if field.oneof)
    return counted.most_common(1)[0][0] if counted else ""


def _row(field: ProtoField) -> Row:
    spans = {"number": field.at("number"), "name": field.at("name"), "proto": field.at("type")}
    return Row(
        span=field.span,
        spans=spans,
        number=field.number,
        name=field.name,
        proto=field.wire_type,
        ros=field.wire_type.rpartition(".")[2],
        topic="",
        direction="",
        qos=ir.Qos(),
        bounds={},
        fields={},
        ignore=(),
        forward=(),
        lint=(),
    )
